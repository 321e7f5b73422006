#pragma once
/// Reflected light of one luminaire as its place varies: looked at in few places, known in all.
///
/// Direct light has sharp edges and costs a shadow ray per receiver; reflected light is smooth and costs thousands. So
/// the second is worked out at nodes once, and elsewhere it is that of the plane through those about the place
/// (interpolation_nodes.h): microseconds, with its slope.

#include <vector>

#include "core/transport/candidates/candidate_transport.h"
#include "core/transport/candidates/interpolation_nodes.h"

namespace luxrig {

class ReflectedField {
 public:
  /// scene, rays   the same geometry; rays must outlive it
  /// luminaire     hung with its own rotation, here and later. No shape, no sky
  /// places        among which nodes are chosen, evenly spread, `most_nodes` at most
  /// options       as for candidate_transport(), whose errors these are
  [[nodiscard]] static Result<ReflectedField> make(const Scene& scene, const RayScene& rays,
                                                   std::span<const Receiver> receivers, const Emitter& luminaire,
                                                   std::span<const Vec3> places_world_m, std::size_t most_nodes,
                                                   const CandidateOptions& options);

  /// Adds reflected lux per unit emittance and, when asked for, its slopes (receivers × 3 first columns). From any
  /// thread. False, and nothing added, where no node can be seen.
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
