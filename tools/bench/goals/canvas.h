#pragma once
/// Scenes to paint on, and the rows of the suite `goals`.

#include "core/goals/goal_points.h"
#include "tools/bench/bench.h"
#include "tools/bench/measured.h"

namespace luxrig {

inline constexpr double kGoalCell_m = 0.1;

struct GoalColumns {
  std::size_t triangles = 0, patches = 0, groups = 0;
  std::optional<double> cpu_s, peak_gib;
  std::string note;  ///< without commas
};

/// Without an error.
[[nodiscard]] BenchRow goal_row(const std::string& name, const std::string& method, double seconds,
                                std::optional<double> target_seconds, const GoalColumns& columns);

[[nodiscard]] bool wanted_goal_case(const BenchOptions& options, const std::string& name);

/// A scene, ready to paint on.
struct Canvas {
  Scene scene;
  RayScene rays;
  SurfacePatches surface;
  CallSeconds took;  ///< patches and groups, without the RayScene
  double peak_gib = 0;
};

/// None if the cells cannot be; stderr says why.
[[nodiscard]] std::optional<Canvas> make_canvas(Scene scene, double cell_m, const BenchOptions& options);
[[nodiscard]] GoalColumns columns_of(const Canvas& canvas);

/// error: of the area of all patches. Both sides of the triangles count.
[[nodiscard]] BenchRow patches_row(const std::string& name, const Canvas& canvas, double cell_m,
                                   std::optional<double> target_seconds);

/// The flat of the file apartment.glb, if there is a data folder: three selective fills on the floor of its rooms, and a
/// bucket on one side of a thin wall. error: share of places in it that are not painted as they should be.
void add_apartment(const BenchOptions& options, std::vector<BenchRow>& rows);

}  // namespace luxrig
