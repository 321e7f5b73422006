#include "core/transport/candidates/reflected/interpolation_nodes.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <unordered_set>

namespace luxrig {
namespace {

/// Nodes count up to this many steps away, with falling weight.
constexpr double kReach = 1.8;
constexpr std::int64_t kReachCubes = 2;
/// Least extent of nodes that defines a slope, as a share of the reach (squared): below it the plane is taken as flat.
constexpr double kRidge = 1e-3;
/// Largest noise of the combined nodes, as a share of that of one (squared): above it the place is outside its nodes.
constexpr double kMaxNoise = 0.6;
constexpr std::size_t kMinNodes = 4;
/// Reach of means where no plane fits, in steps.
constexpr double kMeanReach = 3;
constexpr double kFiner = 0.8;
constexpr double kMaxCubesPerSide = 1 << 20;

using Cube = Eigen::Matrix<std::int64_t, 3, 1>;

Cube cube_of(const Vec3& at_m, const Vec3& start_m, double step_m) {
  return ((at_m - start_m) / step_m).array().floor().cast<std::int64_t>();
}

std::uint64_t key_of(const Cube& cube) {
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k) key = key << 21 | (static_cast<std::uint64_t>(cube[k] + 1) & 0x1fffff);
  return key;
}

Eigen::AlignedBox3d box_of(std::span<const Vec3> positions_m, std::span<const std::uint8_t> usable) {
  Eigen::AlignedBox3d box;
  for (std::size_t p = 0; p < positions_m.size(); ++p)
    if (usable[p]) box.extend(positions_m[p]);
  return box;
}

}  // namespace

InterpolationNodes::InterpolationNodes(std::span<const Vec3> positions_world_m, std::span<const std::uint8_t> usable,
                                       double step_m)
    : step_m_(step_m) {
  const Eigen::AlignedBox3d box = box_of(positions_world_m, usable);
  if (box.isEmpty() || !(step_m > 0)) return;
  start_world_m_ = box.min();
  const auto off_middle_m2 = [&](std::uint32_t p) {
    const Vec3 middle_m =
        start_world_m_ +
        step_m_ * (cube_of(positions_world_m[p], start_world_m_, step_m_).cast<double>() + Vec3::Constant(0.5));
    return (positions_world_m[p] - middle_m).squaredNorm();
  };
  for (std::uint32_t p = 0; p < positions_world_m.size(); ++p) {
    if (!usable[p]) continue;
    const auto [slot, made] = node_in_cube_.try_emplace(key_of(cube_of(positions_world_m[p], start_world_m_, step_m_)),
                                                        static_cast<std::uint32_t>(nodes_.size()));
    if (made)
      nodes_.push_back(p);
    else if (off_middle_m2(p) < off_middle_m2(nodes_[slot->second]))
      nodes_[slot->second] = p;
  }
  for (const std::uint32_t p : nodes_) node_world_m_.push_back(positions_world_m[p]);
}

double InterpolationNodes::step_for(std::span<const Vec3> positions_world_m, std::span<const std::uint8_t> usable,
                                    std::size_t max_nodes) {
  const Eigen::AlignedBox3d box = box_of(positions_world_m, usable);
  if (box.isEmpty() || max_nodes == 0) return 0;
  const double size_m = box.sizes().maxCoeff();
  if (!(size_m > 0)) return 0;
  const auto all = static_cast<std::size_t>(std::count_if(usable.begin(), usable.end(), [](auto u) { return u != 0; }));
  double fits_m = 0;
  std::unordered_set<std::uint64_t> cubes;
  for (double step_m = 1.01 * size_m; step_m * kMaxCubesPerSide > size_m; step_m *= kFiner) {
    cubes.clear();
    for (std::size_t p = 0; p < positions_world_m.size() && cubes.size() <= max_nodes; ++p)
      if (usable[p]) cubes.insert(key_of(cube_of(positions_world_m[p], box.min(), step_m)));
    if (cubes.size() > max_nodes) break;
    fits_m = step_m;
    if (cubes.size() == all) break;  // any finer, and no place would have a neighbour within reach
  }
  return fits_m;
}

void InterpolationNodes::shares(const RayScene& scene, const Vec3& position_world_m, const Vec3& offset_world_m,
                                std::vector<WeightedRow>& shares, std::uint64_t& rays, std::uint32_t without,
                                std::vector<Vec3>* slopes_per_m) const {
  shares.clear();
  if (nodes_.empty()) return;
  const Cube cube = cube_of(position_world_m, start_world_m_, step_m_);
  const double reach_m = kReach * step_m_;
  Eigen::Matrix4d moments = Eigen::Matrix4d::Zero();
  std::vector<Eigen::Vector4d> bases;
  for (std::int64_t z = -kReachCubes; z <= kReachCubes; ++z)
    for (std::int64_t y = -kReachCubes; y <= kReachCubes; ++y)
      for (std::int64_t x = -kReachCubes; x <= kReachCubes; ++x) {
        const auto found = node_in_cube_.find(key_of(cube + Cube(x, y, z)));
        if (found == node_in_cube_.end() || found->second == without) continue;
        const Vec3& node_m = node_world_m_[found->second];
        const Vec3 off = (node_m - position_world_m) / reach_m;
        const double near = 1 - off.squaredNorm();
        if (!(near > 0)) continue;
        if (node_m != position_world_m) {
          ++rays;
          if (scene.occluded(position_world_m + offset_world_m, Vec3::Zero(), node_m + offset_world_m)) continue;
        }
        const double weight = near * near;
        const Eigen::Vector4d basis(1, off.x(), off.y(), off.z());
        moments += weight * basis * basis.transpose();
        shares.push_back({found->second, static_cast<float>(weight)});
        bases.push_back(basis);
      }
  if (shares.size() < kMinNodes) return shares.clear();
  for (int k = 1; k < 4; ++k) moments(k, k) += kRidge * moments(0, 0);
  const Eigen::LDLT<Eigen::Matrix4d> factor(moments);
  const Eigen::Vector4d first = factor.solve(Eigen::Vector4d::UnitX());
  if (slopes_per_m) {
    const Eigen::Matrix<double, 4, 3> rises = factor.solve(Eigen::Matrix4d::Identity().rightCols<3>()) / reach_m;
    slopes_per_m->resize(shares.size());
    for (std::size_t i = 0; i < shares.size(); ++i)
      (*slopes_per_m)[i] = static_cast<double>(shares[i].weight) * rises.transpose() * bases[i];
  }
  double noise = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i].weight *= static_cast<float>(first.dot(bases[i]));
    noise += static_cast<double>(shares[i].weight) * static_cast<double>(shares[i].weight);
  }
  // Without the ridge the weights sum to 1; with it, nearly.
  float sum = 0;
  for (const WeightedRow& share : shares) sum += share.weight;
  if (!(sum > 0.5f) || !(noise < kMaxNoise)) return shares.clear();
  for (WeightedRow& share : shares) share.weight /= sum;
}

void InterpolationNodes::mean_shares(const RayScene& scene, const Vec3& position_world_m,
                                     std::vector<WeightedRow>& shares) const {
  shares.clear();
  const double reach_m2 = std::pow(kMeanReach * step_m_, 2);
  float sum = 0;
  for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
    const double distance_m2 = (node_world_m_[n] - position_world_m).squaredNorm();
    if (!(distance_m2 < reach_m2)) continue;
    if (distance_m2 > 0 && scene.occluded(position_world_m, Vec3::Zero(), node_world_m_[n])) continue;
    const auto weight = static_cast<float>(std::pow(1 - distance_m2 / reach_m2, 4));
    shares.push_back({n, weight});
    sum += weight;
  }
  for (WeightedRow& share : shares) share.weight /= sum;
}

}  // namespace luxrig
