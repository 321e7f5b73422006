#include "tools/bench/cache/side_exchange.h"

#include <Eigen/LU>
#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "core/transport/bsdf.h"
#include "tools/bench/cache/cache_method.h"
#include "tools/bench/cache/light_view.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kExchangeSamples = 0x6c696e6b73;  // separates these random numbers from others
/// Reflections are left out once the rest is below this share of the first.
constexpr double kNegligibleShare = 1e-5;
constexpr int kMaxExchanges = 400;

/// Pieces of each group, by rising sum of area, to draw places from.
struct GroupPlaces {
  std::vector<std::vector<std::uint32_t>> pieces;
  std::vector<std::vector<double>> area_up_to_m2;

  GroupPlaces(const SurfaceSides& sides) : pieces(sides.groups()), area_up_to_m2(sides.groups()) {
    for (std::uint32_t i = 0; i < sides.pieces().size(); ++i) {
      const SurfacePiece& piece = sides.pieces()[i];
      const std::size_t group = sides.group_of_side(piece.side);
      auto& sums = area_up_to_m2[group];
      pieces[group].push_back(i);
      sums.push_back((sums.empty() ? 0 : sums.back()) + static_cast<double>(piece.area_m2));
    }
  }
  [[nodiscard]] std::uint32_t at(std::size_t group, double u) const {
    const auto& sums = area_up_to_m2[group];
    const auto found = std::upper_bound(sums.begin(), sums.end(), u * sums.back());
    return pieces[group][std::min(static_cast<std::size_t>(found - sums.begin()), sums.size() - 1)];
  }
};

struct Row {
  std::vector<std::pair<std::uint32_t, float>> shares;  ///< by group
  std::uint64_t rays = 0;
};

}  // namespace

SideExchange::SideExchange(const Scene& scene, const RayScene& rays, const SurfaceSides& sides, std::vector<bool> seen,
                           bool only_needed, int reflections, int rays_per_group, int channels, std::uint64_t seed,
                           int threads, const std::stop_token& stop)
    : reflections_(reflections) {
  const GroupPlaces places(sides);
  row_of_group_.assign(sides.groups(), SurfaceSides::kNone);
  if (!only_needed) seen.assign(sides.groups(), true);
  const auto take = [&](std::uint32_t group) {
    if (row_of_group_[group] != SurfaceSides::kNone) return;
    row_of_group_[group] = static_cast<std::uint32_t>(group_of_row_.size());
    group_of_row_.push_back(group);
  };
  for (std::uint32_t group = 0; group < sides.groups(); ++group)
    if (seen[group]) take(group);

  // In waves: the groups seen by one wave are the next wave. Groups seen only at the last reflection need no row of
  // links.
  std::vector<Row> rows;
  for (int wave = 1; rows.size() < group_of_row_.size() && (reflections == 0 || wave < reflections); ++wave) {
    const std::size_t begin = rows.size(), end = group_of_row_.size();
    rows.resize(end);
    parallel_for(end - begin, threads, [&](std::size_t i) {
      if (stop.stop_requested()) return;
      Row& row = rows[begin + i];
      const std::uint32_t group = group_of_row_[begin + i];
      const SobolSequence samples(mixed(mixed(seed, kExchangeSamples), group));
      std::vector<std::uint32_t> met;
      for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(rays_per_group); ++s) {
        const auto [u, v, w, unused] = samples.set(s, 0);
        const SurfacePiece& from = sides.pieces()[places.at(group, w)];
        const Vec3 normal = from.normal_world.cast<double>().normalized();
        ++row.rays;
        const auto hit = rays.nearest(from.position_world_m, cosine_direction(normal, u, v), normal);
        if (!hit) continue;
        const std::uint32_t side = sides.side_at(hit->position_world_m, hit->normal_world, row.rays);
        if (side != SurfaceSides::kNone) met.push_back(sides.group_of_side(side));
      }
      std::sort(met.begin(), met.end());
      for (std::size_t a = 0; a < met.size();) {
        std::size_t b = a;
        while (b < met.size() && met[b] == met[a]) ++b;
        row.shares.emplace_back(met[a], static_cast<float>(b - a) / static_cast<float>(rays_per_group));
        a = b;
      }
    });
    if (stop.stop_requested()) return;
    for (std::size_t i = begin; i < end; ++i)
      for (const auto& [group, share] : rows[i].shares) take(group);
  }
  rows.resize(group_of_row_.size());
  first_link_.push_back(0);
  for (const Row& row : rows) {
    cast_ += row.rays;
    for (const auto& [group, share] : row.shares) {
      seen_row_.push_back(row_of_group_[group]);
      share_.push_back(share);
    }
    first_link_.push_back(share_.size());
  }

  std::vector<Vec3> reflected(sides.groups(), Vec3::Zero());
  for (const SurfacePiece& piece : sides.pieces())
    reflected[sides.group_of_side(piece.side)] +=
        static_cast<double>(piece.area_m2) *
        diffuse_equivalent_rgb(scene.materials[scene.material_of_triangle[piece.triangle]]);
  for (int c = 0; c < channels; ++c) {
    Eigen::VectorXd& reflectance = reflectance_.emplace_back(static_cast<Eigen::Index>(group_of_row_.size()));
    for (std::size_t i = 0; i < group_of_row_.size(); ++i)
      reflectance[static_cast<Eigen::Index>(i)] =
          reflected[group_of_row_[i]][c] / sides.area_of_group_m2(group_of_row_[i]);
  }
}

Eigen::VectorXd SideExchange::later(const Eigen::VectorXd& first, int channel) const {
  const Eigen::VectorXd& reflectance = reflectance_[static_cast<std::size_t>(channel)];
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(first.size()), last = first, next(first.size());
  const double negligible = kNegligibleShare * first.lpNorm<1>();
  const int most = reflections_ > 0 ? reflections_ - 1 : kMaxExchanges;
  for (int reflection = 0; reflection < most; ++reflection) {
    for (Eigen::Index row = 0; row < first.size(); ++row) {
      double lux = 0;
      for (std::size_t l = first_link_[static_cast<std::size_t>(row)];
           l < first_link_[static_cast<std::size_t>(row) + 1]; ++l)
        lux += static_cast<double>(share_[l]) * last[seen_row_[l]];
      next[row] = reflectance[row] * lux;
    }
    sum += next;
    std::swap(last, next);
    if (reflections_ == 0 && last.lpNorm<1>() <= negligible) break;
  }
  return sum;
}

Eigen::MatrixXf SideExchange::reads_of_later(const Eigen::MatrixXf& reads, int channel) const {
  const auto n = static_cast<Eigen::Index>(rows());
  const Eigen::VectorXd& reflectance = reflectance_[static_cast<std::size_t>(channel)];
  if (reflections_ > 0) {
    Eigen::MatrixXf all = Eigen::MatrixXf::Zero(reads.rows(), n), last = reads;
    for (int reflection = 1; reflection < reflections_; ++reflection) {
      Eigen::MatrixXf next = Eigen::MatrixXf::Zero(reads.rows(), n);
      for (Eigen::Index row = 0; row < n; ++row)
        for (std::size_t l = first_link_[static_cast<std::size_t>(row)];
             l < first_link_[static_cast<std::size_t>(row) + 1]; ++l)
          next.col(seen_row_[l]) += static_cast<float>(reflectance[row]) * share_[l] * last.col(row);
      all += next;
      last = std::move(next);
    }
    return all;
  }
  // reads (A + A² + …) = reads ((I - A)⁻¹ - I): the transposed system, solved for all receivers.
  Eigen::MatrixXf transposed = Eigen::MatrixXf::Identity(n, n);
  for (Eigen::Index row = 0; row < n; ++row)
    for (std::size_t l = first_link_[static_cast<std::size_t>(row)]; l < first_link_[static_cast<std::size_t>(row) + 1];
         ++l)
      transposed(seen_row_[l], row) -= static_cast<float>(reflectance[row]) * share_[l];
  const Eigen::MatrixXf solved = transposed.partialPivLu().solve(reads.transpose());
  return solved.transpose() - reads;
}

std::size_t SideExchange::bytes() const {
  return (row_of_group_.size() + group_of_row_.size() + seen_row_.size()) * 4 + share_.size() * sizeof(float) +
         first_link_.size() * sizeof(std::size_t) + reflectance_.size() * rows() * sizeof(double);
}

}  // namespace luxrig
