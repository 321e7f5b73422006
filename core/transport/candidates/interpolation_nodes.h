#pragma once
/// Some of very many places, and how the others follow from them.
///
/// Reflected light varies smoothly with the place of a lamp as long as no wall comes between. So a few places, spread
/// evenly, are looked at; at the others the value is that of the plane through the values about them that fits best
/// (moving least squares; P. Lancaster and K. Salkauskas, 1981), among the nodes that can be seen from there. Since
/// many nodes take part, the noise of one matters less.

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/scene/ray_scene.h"
#include "core/transport/candidates/weighted_rows.h"

namespace luxrig {

class InterpolationNodes {
 public:
  InterpolationNodes() = default;  ///< none

  /// One node in each cube of a grid that has a usable position: the one nearest to its middle.
  /// usable   per position
  InterpolationNodes(std::span<const Vec3> positions_world_m, std::span<const std::uint8_t> usable, double step_m);

  /// The finest grid's step that does not give more than `most_nodes`, to a fifth, but none finer than lets every
  /// position be a node; 0 if `most_nodes` is.
  [[nodiscard]] static double step_for(std::span<const Vec3> positions_world_m, std::span<const std::uint8_t> usable,
                                       std::size_t most_nodes);

  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] double step_m() const { return step_m_; }
  /// Index of the position that is node n.
  [[nodiscard]] std::uint32_t position(std::size_t n) const { return nodes_[n]; }

  /// Nodes (as rows) and their weights, which add up to 1. Empty where too few can be seen, or only on one side.
  /// offset_world_m   what lamps hang off their positions
  /// without          a node that is not to take part
  /// slopes_per_m     when asked for: how the plane rises along x, y and z, as a weight for each node of shares
  void shares(const RayScene& scene, const Vec3& position_world_m, const Vec3& offset_world_m,
              std::vector<WeightedRow>& shares, std::uint64_t& rays, std::uint32_t without = ~0u,
              std::vector<Vec3>* slopes_per_m = nullptr) const;

  /// For where no plane can be laid: the mean of the nodes about it that can be seen, the nearer the more. Empty where
  /// there is none: behind a wall, say.
  void mean_shares(const RayScene& scene, const Vec3& position_world_m, std::vector<WeightedRow>& shares) const;

 private:
  std::vector<std::uint32_t> nodes_;
  std::vector<Vec3> node_world_m_;
  std::unordered_map<std::uint64_t, std::uint32_t> node_in_cube_;
  Vec3 start_world_m_ = Vec3::Zero();
  double step_m_ = 0;
};

}  // namespace luxrig
