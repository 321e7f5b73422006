#pragma once
/// Reflected light of one luminaire as a function of its place: traced at few places, interpolated at all others.
///
/// Direct light has sharp edges and costs one shadow ray per receiver; reflected light is smooth and costs thousands.
/// So reflected light is computed once at nodes; elsewhere it is the plane through the nodes around the place
/// (interpolation_nodes.h): microseconds, with its slope.

#include <vector>

#include "core/transport/candidates/candidate_transport.h"
#include "core/transport/candidates/reflected/interpolation_nodes.h"

namespace luxrig {

class ReflectedField {
 public:
  /// scene, rays   the same geometry; rays must outlive it
  /// luminaire     hung with this rotation, which add() also assumes. No shape, no sky
  /// places        to choose nodes from, evenly spread, `max_nodes` at most
  /// options       as for candidate_transport(); they set the errors here
  [[nodiscard]] static Result<ReflectedField> make(const Scene& scene, const RayScene& rays,
                                                   std::span<const Receiver> receivers, const Emitter& luminaire,
                                                   std::span<const Vec3> places_world_m, std::size_t max_nodes,
                                                   const CandidateOptions& options);

  /// Adds reflected lux per unit emittance and, if wanted, its slopes (receivers × first 3 columns). From any thread.
  /// False, and nothing added, if no node is visible.
  bool add(const Vec3& place_world_m, Eigen::VectorXd& lux, Eigen::MatrixXd* slopes) const;

  [[nodiscard]] std::size_t nodes() const { return nodes_.size(); }
  [[nodiscard]] const CandidateStatistics& statistics() const { return statistics_; }

 private:
  ReflectedField() = default;

  const RayScene* rays_ = nullptr;
  InterpolationNodes nodes_;
  std::size_t receivers_ = 0;
  std::size_t stride_ = 0;  ///< floats per node
  std::vector<float> lux_;
  CandidateStatistics statistics_;
};

}  // namespace luxrig
