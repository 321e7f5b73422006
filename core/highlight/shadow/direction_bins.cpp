#include "core/highlight/shadow/direction_bins.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::size_t kPointsPerVote = 64;
constexpr int kFinestSide = 1024;

/// Ring (from 1) of a cell in a polar cap. twice: 2 · number of the cell, counted from 0 at the pole, + 1.
std::int64_t ring_in_cap(std::int64_t twice) {
  auto root = static_cast<std::int64_t>(std::sqrt(static_cast<double>(twice)));
  while (root * root > twice) --root;
  while ((root + 1) * (root + 1) <= twice) ++root;
  return (1 + root) / 2;
}

}  // namespace

DirectionBins::DirectionBins(int side) : side_(side) {
  LUXRIG_CHECK(side >= 1 && side <= kFinestSide, "side {}", side);
}

std::uint32_t DirectionBins::bin_of(const Vec3& direction) const {
  const double length = direction.norm();
  LUXRIG_CHECK(length > 0 && std::isfinite(length), "direction of length {}", length);
  const double z = std::clamp(direction.z() / length, -1.0, 1.0), n = side_;
  double quarter = std::atan2(direction.y(), direction.x()) / (kPi / 2);  // of the way round: 0 … 4
  if (quarter < 0) quarter += 4;
  if (quarter >= 4) quarter -= 4;
  const std::int64_t side = side_;
  if (std::abs(z) <= 2.0 / 3) {
    const double along = n * (0.5 + quarter), up = n * z * 0.75;
    const auto rising = static_cast<std::int64_t>(std::floor(along - up));
    const auto falling = static_cast<std::int64_t>(std::floor(along + up));
    const std::int64_t ring = side + 1 + rising - falling;  // 1 … 2 side + 1
    std::int64_t place = (rising + falling - side + (ring % 2 == 0 ? 1 : 0) + 1) / 2;
    place = (place % (4 * side) + 4 * side) % (4 * side);
    return static_cast<std::uint32_t>(2 * side * (side - 1) + (ring - 1) * 4 * side + place);
  }
  // 1 - |z| without the cancellation near the poles.
  const double across2 = (direction.x() * direction.x() + direction.y() * direction.y()) / (length * length);
  const double from_pole = n * std::sqrt(3 * across2 / (1 + std::abs(z))), within = quarter - std::floor(quarter);
  const auto rising = static_cast<std::int64_t>(std::floor(within * from_pole));
  const auto falling = static_cast<std::int64_t>(std::floor((1 - within) * from_pole));
  const std::int64_t ring = std::min(rising + falling + 1, side);
  const std::int64_t place = static_cast<std::int64_t>(std::floor(quarter * static_cast<double>(ring))) % (4 * ring);
  return static_cast<std::uint32_t>(z > 0 ? 2 * ring * (ring - 1) + place
                                          : 12 * side * side - 2 * ring * (ring + 1) + place);
}

Vec3 DirectionBins::direction_of(std::uint32_t bin) const {
  LUXRIG_CHECK(bin < count(), "bin {} of {}", bin, count());
  const std::int64_t side = side_, cap = 2 * side * (side - 1), all = count();
  const double n = side_;
  double z = 0, phi = 0;
  if (bin < cap) {
    const std::int64_t ring = ring_in_cap(1 + 2 * static_cast<std::int64_t>(bin));
    const auto r = static_cast<double>(ring);
    z = 1 - r * r / (3 * n * n);
    phi = (static_cast<double>(bin - 2 * ring * (ring - 1)) + 0.5) * kPi / (2 * r);
  } else if (bin < all - cap) {
    const std::int64_t place = bin - cap, ring = place / (4 * side) + side;
    z = (2 * n - static_cast<double>(ring)) * 2 / (3 * n);
    phi = (static_cast<double>(place % (4 * side)) + ((ring + side) % 2 != 0 ? 0 : 0.5)) * kPi / (2 * n);
  } else {
    const std::int64_t left = all - bin, ring = ring_in_cap(2 * left - 1);
    const auto r = static_cast<double>(ring);
    z = -1 + r * r / (3 * n * n);
    phi = (static_cast<double>(4 * ring - (left - 2 * ring * (ring - 1))) + 0.5) * kPi / (2 * r);
  }
  const double across = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
  return {across * std::cos(phi), across * std::sin(phi), z};
}

std::uint64_t DirectionHistogram::total() const {
  return std::accumulate(votes.begin(), votes.end(), std::uint64_t{0});
}

DirectionHistogram vote_directions(const ShadowEdges& edges, std::span<const OrientedPoint> points,
                                   const DirectionBins& bins, int threads) {
  LUXRIG_CHECK(edges.begin.size() == points.size() + 1, "edges of {} points, {} points", edges.begin.size() - 1,
               points.size());
  DirectionHistogram histogram{bins, std::vector<std::uint32_t>(bins.count(), 0),
                               std::vector<Vec3>(bins.count(), Vec3::Zero())};
  struct Vote {
    std::uint32_t bin;
    Vec3f direction;
  };
  std::vector<std::vector<Vote>> parts((points.size() + kPointsPerVote - 1) / kPointsPerVote);
  parallel_for(parts.size(), threads, [&](std::size_t p) {
    for (std::size_t i = p * kPointsPerVote; i < std::min(points.size(), (p + 1) * kPointsPerVote); ++i) {
      if (edges.of(i).empty()) continue;
      const ScanFrame frame(points[i].normal);
      for (const ShadowEdge& edge : edges.of(i)) {
        const Vec3f direction = frame.direction(edge.azimuth, edge.elevation);
        parts[p].push_back({bins.bin_of(direction.cast<double>()), direction});
      }
    }
  });
  for (const auto& part : parts) {
    for (const Vote& vote : part) {
      ++histogram.votes[vote.bin];
      histogram.mean_direction[vote.bin] += vote.direction.cast<double>();
    }
  }
  for (Vec3& direction : histogram.mean_direction)
    if (!direction.isZero(0)) direction.normalize();
  return histogram;
}

double histogram_error(const DirectionHistogram& a, const DirectionHistogram& b) {
  LUXRIG_CHECK(a.votes.size() == b.votes.size(), "{} and {} bins", a.votes.size(), b.votes.size());
  double off = 0, all = 0;
  for (std::size_t i = 0; i < a.votes.size(); ++i) {
    off += std::abs(static_cast<double>(a.votes[i]) - static_cast<double>(b.votes[i]));
    all += static_cast<double>(b.votes[i]);
  }
  return all > 0 ? off / all : off > 0 ? 1 : 0;
}

}  // namespace luxrig
