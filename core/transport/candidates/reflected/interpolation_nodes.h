#pragma once
/// Chooses nodes among very many places, and interpolates the others from them.
///
/// Reflected light varies smoothly with the place of a lamp unless a wall intervenes. So only a few evenly spread
/// places are evaluated. Elsewhere the value is that of the best plane through the values of surrounding visible nodes
/// (moving least squares; P. Lancaster and K. Salkauskas, 1981). Since many nodes contribute, the noise of one matters
/// less.

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/scene/ray_scene.h"
#include "core/transport/candidates/reflected/weighted_rows.h"

namespace luxrig {

class InterpolationNodes {
 public:
  InterpolationNodes() = default;  ///< none

  /// One node in each grid cube with a usable position: the one nearest to the cube's centre.
  /// usable   per position
  InterpolationNodes(std::span<const Vec3> positions_world_m, std::span<const std::uint8_t> usable, double step_m);

  /// Step of the finest grid with at most `max_nodes` nodes, to a fifth, but not finer than needed to make every
  /// position a node; 0 if `max_nodes` is 0.
  [[nodiscard]] static double step_for(std::span<const Vec3> positions_world_m, std::span<const std::uint8_t> usable,
                                       std::size_t max_nodes);

  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] double step_m() const { return step_m_; }
  /// Index of the position that is node n.
  [[nodiscard]] std::uint32_t position(std::size_t n) const { return nodes_[n]; }

  /// Nodes (as rows) and their weights, which sum to 1. Empty if too few are visible, or only on one side.
  /// offset_world_m   of lamps from their positions
  /// without          a node to leave out
  /// slopes_per_m     optional: slope of the plane along x, y and z, as a weight for each node of shares
  void shares(const RayScene& scene, const Vec3& position_world_m, const Vec3& offset_world_m,
              std::vector<WeightedRow>& shares, std::uint64_t& rays, std::uint32_t without = ~0u,
              std::vector<Vec3>* slopes_per_m = nullptr) const;

  /// Where no plane fits: the distance-weighted mean of the surrounding visible nodes. Empty if there are none, for
  /// example behind a wall.
  void mean_shares(const RayScene& scene, const Vec3& position_world_m, std::vector<WeightedRow>& shares) const;

 private:
  std::vector<std::uint32_t> nodes_;
  std::vector<Vec3> node_world_m_;
  std::unordered_map<std::uint64_t, std::uint32_t> node_in_cube_;
  Vec3 start_world_m_ = Vec3::Zero();
  double step_m_ = 0;
};

}  // namespace luxrig
