#include "tools/bench/highlight/rows.h"

#include <fmt/format.h>

#include <cmath>

#include "core/check.h"
#include "core/highlight/shadow/relief_contrast.h"
#include "core/scene/mesh/mesh_file.h"
#include "tools/bench/rooms/relief_targets.h"
#include "tools/bench/row_progress.h"

namespace luxrig {
namespace {

struct ObjectFile {
  const char* name;
  const char* file;
  double metres_per_unit;
};
/// The files of skull and cat have no unit: taken as two metres tall. No measurement depends on it.
constexpr ObjectFile kObjectFiles[] = {{"venus", "venus-bust.glb", 1},
                                       {"skull", "skull.obj", 1},
                                       {"teapot", "teapot.glb", 0.001},
                                       {"cat", "egyptian-cat.glb", 1},
                                       {"chess", "chess-board.glb", 0.001}};
constexpr std::size_t kStudyPoints = 3000, kQuickStudyPoints = 300;

}  // namespace

ReliefStudyOptions options_of_study(const BenchOptions& options) {
  ReliefStudyOptions study;
  study.interest.max_points = options.quick ? kQuickStudyPoints : kStudyPoints;
  study.threads = options.threads;
  return study;
}

const ReliefStudy& HighlightObject::study() {
  if (!study_) {
    auto made = study_relief(scene_, options_of_study(*options_));
    LUXRIG_CHECK(made, "{}: {}", name_, made.error().detail);
    study_ = std::make_unique<ReliefStudy>(std::move(*made));
  }
  return *study_;
}

std::vector<HighlightObject> highlight_objects(const BenchOptions& options, std::vector<std::string>& missing) {
  std::vector<HighlightObject> objects;
  objects.emplace_back("relief", make_carved_relief(options.quick ? 0.015 : 0.005), options);
  objects.emplace_back("terrain", options.quick ? make_terrain(100, 60) : make_terrain(), options);
  if (!options.quick) {
    objects.emplace_back("head", make_head(), options);
    objects.emplace_back("helmet", make_helmet(), options);
    objects.emplace_back("inscription", make_inscription(), options);
  }
  if (options.data_folder.empty()) return objects;
  for (const ObjectFile& file : kObjectFiles) {
    auto scene = load_mesh({options.data_folder / file.file, file.metres_per_unit, UpAxis::y});
    if (scene)
      objects.emplace_back(file.name, std::move(*scene), options);
    else
      missing.push_back(scene.error().front().text());
  }
  return objects;
}

bool highlight_wanted(const BenchOptions& options, const std::string& case_name) {
  return case_name.rfind(options.only, 0) == 0;
}

Scene scaled_to_one_metre(Scene scene) {
  Eigen::AlignedBox3d box_m;
  for (const auto& triangle : scene.triangles)
    for (const std::uint32_t v : triangle) box_m.extend(scene.vertices_m[v].cast<double>());
  const double scale = 1 / box_m.diagonal().norm();
  for (Vec3f& v : scene.vertices_m) v = (scale * (v.cast<double>() - box_m.center())).cast<float>();
  scene.origin_world_m.setZero();
  return scene;
}

ShownRelief shown_relief(const ReliefStudy& study, std::span<const Vec3> directions, int threads) {
  std::vector<DistantBeam> beams;
  for (const Vec3& direction : directions) beams.push_back({direction, 1});
  const auto measured = [&](std::span<const std::uint32_t> interest) {
    return relief_contrast(study.surface, study.rays, interest, beams, 0, threads);
  };
  const ReliefContrast all = measured(study.interest);
  std::vector<std::vector<std::uint32_t>> clusters(study.features.sizes.size());
  for (std::size_t i = 0; i < study.interest.size(); ++i)
    clusters[study.features.cluster_of_point[i]].push_back(study.interest[i]);
  double covered = 0;
  for (const auto& cluster : clusters) covered += measured(cluster).points_with_transition > 0 ? 1 : 0;
  return {directions.size(), all.points_with_transition, all.local_contrast_lx,
          covered / static_cast<double>(std::max<std::size_t>(1, clusters.size()))};
}

BenchRow bench_row_of(const HighlightRow& row) {
  const auto shown = [&](double value) {
    return row.shown && std::isfinite(value) ? fmt::format("{:.4f}", value) : "";
  };
  const auto seen = [&](double SeenRow::*value) {
    return row.seen && std::isfinite((*row.seen).*value) ? fmt::format("{:.4g}", (*row.seen).*value) : "";
  };
  const ShownRelief relief = row.shown.value_or(ShownRelief{});
  BenchRow made{row.case_name,
                row.method,
                row.error,
                row.took.wall,
                row.target_error,
                row.target_seconds,
                {{"cpu_seconds", fmt::format("{:.4g}", row.took.cpu)},
                 {"lights", row.shown ? fmt::format("{}", relief.lights) : ""},
                 {"rays", row.rays ? fmt::format("{}", *row.rays) : ""},
                 {"transitions", shown(relief.transitions)},
                 {"local_contrast", shown(relief.local_contrast_lx)},
                 {"coverage", shown(relief.coverage)},
                 {"seen", seen(&SeenRow::objective)},
                 {"contrast", seen(&SeenRow::contrast)},
                 {"contrast_rank", seen(&SeenRow::contrast_rank)},
                 {"lit", seen(&SeenRow::lit)},
                 {"lit_rank", seen(&SeenRow::lit_rank)},
                 {"clipped", seen(&SeenRow::clipped)},
                 {"normals_deg", seen(&SeenRow::normals_deg)},
                 {"normals_rank", seen(&SeenRow::normals_rank)},
                 {"note", row.note}}};
  say_row_made(made);
  return made;
}

}  // namespace luxrig
