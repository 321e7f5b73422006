#pragma once
/// Points in nested groups, each with its box, so that one test of a box can decide all of its points.

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
    std::uint32_t right = 0;           ///< index of the second half; the first is the next node; 0 = a leaf
  };

  /// Halves at the median of the longest side, down to kLeafPoints. Deterministic.
  explicit PointTree(std::span<const Vec3> points_m);

  std::vector<Node> nodes;           ///< root first; empty without points
  std::vector<std::uint32_t> order;  ///< indices of the points, contiguous per node
};

}  // namespace luxrig
