#include "core/highlight/surface/feature_clusters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <numeric>

namespace luxrig {
namespace {

constexpr std::size_t kNeighbours = 13;  // including the point itself
constexpr std::size_t kFeatureLeaf = 10;

struct PointCloud {
  std::span<const OrientedPoint> points;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i].position_world_m[static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

struct Link {
  double squared_m2;
  std::uint32_t a, b;
  auto operator<=>(const Link&) const = default;
};

/// Possible links of each point; each pair at least once, first from the lower index.
std::vector<Link> links_between(std::span<const OrientedPoint> points, double link_m) {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointCloud>, PointCloud, 3,
                                                   std::uint32_t>;
  const PointCloud cloud{points};
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kFeatureLeaf));
  tree.buildIndex();
  std::vector<Link> links;
  std::array<std::uint32_t, kNeighbours> near{};
  std::array<double, kNeighbours> squared_m2{};
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::size_t found =
        tree.knnSearch(points[i].position_world_m.data(), kNeighbours, near.data(), squared_m2.data());
    for (std::size_t k = 0; k < found; ++k)
      if (near[k] != i && squared_m2[k] <= link_m * link_m)
        links.push_back({squared_m2[k], std::min(i, near[k]), std::max(i, near[k])});
  }
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return links;
}

class JoinedClusters {
 public:
  explicit JoinedClusters(std::span<const OrientedPoint> points) : parent_(points.size()), normals_(points.size()) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    for (std::size_t i = 0; i < points.size(); ++i) normals_[i] = points[i].normal;
  }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join_if_alike(std::uint32_t i, std::uint32_t j, double min_cosine) {
    const std::uint32_t a = root(i), b = root(j);
    if (a == b) return;
    const Vec3 &p = normals_[a], &q = normals_[b];
    if (!(p.dot(q) >= min_cosine * p.norm() * q.norm()) || p.isZero(0) || q.isZero(0)) return;
    // The lower index stays as root; path halving keeps the trees shallow.
    parent_[std::max(a, b)] = std::min(a, b);
    normals_[std::min(a, b)] = p + q;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<Vec3> normals_;  ///< sums, at roots
};

}  // namespace

Result<FeatureClusters> cluster_features(std::span<const OrientedPoint> points, const FeatureOptions& options) {
  if (!(options.link_m > 0) || !std::isfinite(options.link_m))
    return refusal(fmt::format("neighbours within a feature cannot be {} m apart", options.link_m));
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].position_world_m.allFinite() || !points[i].normal.allFinite())
      return refusal(fmt::format("interest point {} is not finite", i));
  FeatureClusters result;
  if (points.empty()) return result;
  JoinedClusters joined(points);
  const double min_cosine = std::cos(options.largest_angle_rad);
  for (const Link& link : links_between(points, options.link_m)) joined.join_if_alike(link.a, link.b, min_cosine);
  constexpr std::uint32_t kUnnumbered = ~0u;
  std::vector<std::uint32_t> number(points.size(), kUnnumbered);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    std::uint32_t& mine = number[joined.root(i)];
    if (mine == kUnnumbered) {
      mine = static_cast<std::uint32_t>(result.sizes.size());
      result.sizes.push_back(0);
    }
    ++result.sizes[mine];
    result.cluster_of_point.push_back(mine);
  }
  return result;
}

}  // namespace luxrig
