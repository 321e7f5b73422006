#pragma once
/// Points in groups of groups, each with its box: what is true of a box need not be asked of its points.

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

struct PointTree {
  static constexpr std::uint32_t kLeafPoints = 8;

  struct Node {
    Vec3 low_m, high_m;
    std::uint32_t begin = 0, end = 0;  ///< into order
    std::uint32_t right = 0;           ///< index of the second half; the first is the next node; 0: a leaf
  };

  /// Halves at the median of the longest side, down to kLeafPoints. The same for the same points.
  explicit PointTree(std::span<const Vec3> points_m);

  std::vector<Node> nodes;           ///< root first; empty without points
  std::vector<std::uint32_t> order;  ///< indices of the points, each node's together
};

}  // namespace luxrig
