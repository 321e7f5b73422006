#pragma once
/// Light painted on a rig's surfaces: the place that a person points at, and what follows from strokes.

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/goals/goal_points.h"
#include "core/tasks/session.h"

namespace luxrig {

/// The place on the surface that is nearest to this one. Which side of it is meant: the one that `from` sees, else the
/// only one that a lamp, a camera or a point of the rig sees. A fault (Cause::invalid) if there is no surface within 1 m,
/// or if it is not clear which side is meant.
[[nodiscard]] Result<SurfacePlace> place_on_surface(const Session& session, const Vec3& near_world_m,
                                                    const std::optional<Vec3>& from_world_m);

/// Paints a session's surface goals. Surfaces are diced once for each size of patches.
class SurfacePainter {
 public:
  explicit SurfacePainter(const Session& session, int threads = 0) : session_(&session), threads_(threads) {}

  struct Painted {
    const SurfacePatches* surface = nullptr;
    std::unique_ptr<Painting> painting;

    [[nodiscard]] double area_m2() const;
    /// Lowest and highest; none = nothing is painted.
    [[nodiscard]] std::optional<std::pair<double, double>> lux_range() const;
  };
  /// A fault if its patches would be too many.
  [[nodiscard]] Result<Painted> paint(const SurfaceGoalSpec& goal, std::span<const Stroke> strokes);

 private:
  const Session* session_;
  int threads_;
  std::map<double, SurfacePatches> surfaces_;  ///< by size of patches
};

/// The points of a painted goal, as they will be read for the rig.
[[nodiscard]] std::vector<Point> points_of(const SurfaceGoalSpec& goal, const SurfacePainter::Painted& painted);

}  // namespace luxrig
