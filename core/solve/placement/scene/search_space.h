#pragma once
/// Everything a search for lights in a scene needs, made once: the movable light, and candidates with their columns.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/run.h"
#include "core/solve/least_squares/columns_view.h"
#include "core/solve/placement/movable_light.h"
#include "core/solve/placement/scene/scene_light.h"

namespace luxrig {

struct SearchSpaceOptions : Run {
  /// Directions to try at each place for an aimed light; empty = hung with the luminaire's rotation.
  std::vector<Vec3> aims_world;
  bool indirect = false;
  /// For reflected light: places where it is sampled, cells of the surfaces (candidate_transport.h), and its wanted
  /// relative error there.
  std::size_t max_nodes = 4'000;
  std::size_t surface_cells = 1'500;
  double reflected_error = 0.1;
  std::function<bool(const Vec3&)> may_hang;  ///< for places that are not candidates; empty = anywhere
};

class SearchSpace {
 public:
  /// scene, rays   the same geometry; both must outlive it
  /// luminaire     with size: candidates are points, without reflected light
  /// places        to try
  /// Cause::invalid as candidate_transport(); Cause::cancelled when stopped.
  [[nodiscard]] static Result<SearchSpace> make(const Scene& scene, const RayScene& rays,
                                                std::span<const Receiver> receivers, const Emitter& luminaire,
                                                std::span<const Vec3> places_world_m,
                                                const SearchSpaceOptions& options);

  [[nodiscard]] const SceneLight& light() const { return *light_; }
  /// Lux per unit emittance, one column per pose. Reflected light below a thousandth of a column's maximum is left out.
  [[nodiscard]] const ColumnsView& columns() const { return view_; }
  [[nodiscard]] std::span<const LightPose> poses() const { return poses_; }
  [[nodiscard]] bool lights_anything() const { return !row_.empty(); }

 private:
  SearchSpace() = default;

  std::unique_ptr<IncrementalTransport> transport_;
  std::unique_ptr<ReflectedField> reflected_;
  std::unique_ptr<SceneLight> light_;
  std::vector<LightPose> poses_;
  std::vector<std::uint64_t> begin_;
  std::vector<std::uint32_t> row_;
  std::vector<float> lux_;
  ColumnsView view_;
};

/// Directions spread evenly over the sphere, straight down first (a spherical Fibonacci lattice: González 2010).
[[nodiscard]] std::vector<Vec3> aims_over_sphere(std::size_t count);

}  // namespace luxrig
