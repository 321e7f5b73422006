#pragma once
/// Objects of the highlight suite, made ready at first use, and its rows: all have the same columns.

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/highlight/surface/relief_study.h"
#include "tools/bench/bench.h"
#include "tools/bench/measured.h"

namespace luxrig {

class HighlightObject {
 public:
  HighlightObject(std::string name, Scene scene, const BenchOptions& options)
      : name_(std::move(name)), scene_(std::move(scene)), options_(&options) {}
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  /// With `options_of_study`. A refusal ends the program: these objects have relief.
  [[nodiscard]] const ReliefStudy& study();

 private:
  std::string name_;
  Scene scene_;
  const BenchOptions* options_;
  std::unique_ptr<ReliefStudy> study_;
};

[[nodiscard]] ReliefStudyOptions options_of_study(const BenchOptions& options);

/// The generated objects, and those of five files in the data folder.
/// missing   names of files that are absent or cannot be read, with the reason
[[nodiscard]] std::vector<HighlightObject> highlight_objects(const BenchOptions& options,
                                                             std::vector<std::string>& missing);

/// Whether `--only` selects a case.
[[nodiscard]] bool highlight_wanted(const BenchOptions& options, const std::string& case_name);

/// Effect of lights, by rays: beams of 1 lx.
struct ShownRelief {
  std::size_t lights = 0;
  double transitions = 0;  ///< share of the interest points with a shadow transition
  double local_contrast_lx = 0;
  double coverage = 0;  ///< share of the feature clusters with a shadow transition
};
[[nodiscard]] ShownRelief shown_relief(const ReliefStudy& study, std::span<const Vec3> directions, int threads);

/// What is seen of an object. All but `objective` and the normals is measured in a path-traced picture.
struct SeenRow {
  double objective = std::nan("");      ///< SeenScore::objective
  double contrast = std::nan("");       ///< of lightness L* near the relief, exposed and clipped
  double contrast_rank = std::nan("");  ///< among the random placements, 1 = above all of them
  double lit = std::nan("");            ///< share of the relief that is not in shadow
  double lit_rank = std::nan("");
  double clipped = std::nan("");  ///< share of the object that is burnt or crushed
  /// Mean error of normals read from pictures, one per lamp (normals_read.h); and among the random placements.
  double normals_deg = std::nan(""), normals_rank = std::nan("");
};

struct HighlightRow {
  std::string case_name, method;
  double error = 0;
  CallSeconds took = {};
  std::optional<double> target_error = {}, target_seconds = {};
  std::optional<std::uint64_t> rays = {};
  std::optional<ShownRelief> shown = {};
  std::string note = {};  ///< without commas
  std::optional<SeenRow> seen = {};
};
[[nodiscard]] BenchRow bench_row_of(const HighlightRow& row);

/// Writes the generated objects as OBJ, in metres. A file that cannot be written is reported on stderr.
[[nodiscard]] std::vector<BenchRow> export_highlight_objects(const std::filesystem::path& folder);

/// About the origin, its bounding box's diagonal 1 m.
[[nodiscard]] Scene scaled_to_one_metre(Scene scene);

/// Parts of the suite.
void add_edge_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows);
void add_light_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows);
void add_number_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows);
void add_stable_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows);
void add_seen_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows);
void add_aim_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows);
void add_mounted_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows);
void add_mounted_number_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows);
void add_curvature_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows);
void add_cluster_rows(const BenchOptions& options, std::vector<BenchRow>& rows);

}  // namespace luxrig
