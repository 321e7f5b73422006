#include "core/transport/candidates/point_tree.h"

#include <algorithm>
#include <numeric>

namespace luxrig {
namespace {

std::uint32_t split(PointTree& tree, std::span<const Vec3> points_m, std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(tree.nodes.size());
  PointTree::Node node;
  node.begin = begin, node.end = end;
  node.low_m = node.high_m = points_m[tree.order[begin]];
  for (std::uint32_t i = begin; i < end; ++i) {
    node.low_m = node.low_m.cwiseMin(points_m[tree.order[i]]);
    node.high_m = node.high_m.cwiseMax(points_m[tree.order[i]]);
  }
  tree.nodes.push_back(node);
  if (end - begin <= PointTree::kLeafPoints) return index;
  Eigen::Index axis = 0;
  (node.high_m - node.low_m).maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto first = tree.order.begin();
  std::nth_element(first + begin, first + middle, first + end, [&](std::uint32_t a, std::uint32_t b) {
    return points_m[a][axis] != points_m[b][axis] ? points_m[a][axis] < points_m[b][axis] : a < b;
  });
  split(tree, points_m, begin, middle);
  tree.nodes[index].right = split(tree, points_m, middle, end);
  return index;
}

}  // namespace

PointTree::PointTree(std::span<const Vec3> points_m) : order(points_m.size()) {
  std::iota(order.begin(), order.end(), 0u);
  if (!points_m.empty()) split(*this, points_m, 0, static_cast<std::uint32_t>(points_m.size()));
}

}  // namespace luxrig
