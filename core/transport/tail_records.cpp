#include "core/transport/tail_records.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/transport/sobol.h"

namespace luxrig {
namespace {

std::size_t bucket_of(const std::array<std::int64_t, 3>& cell, std::size_t buckets) {
  std::uint64_t h = 0;
  for (const std::int64_t c : cell) h = mixed(h, static_cast<std::uint64_t>(c));
  return h % buckets;
}

}  // namespace

void TailRecords::append(std::span<const Place> places, std::size_t replicates, std::size_t columns) {
  places_.insert(places_.end(), places.begin(), places.end());
  columns_ = columns;
  values_.resize(replicates);
  for (auto& values : values_) values.resize(places_.size() * columns, 0.0f);
  if (places_.empty()) return;
  Eigen::AlignedBox3d box;
  for (const Place& place : places_) box.extend(place.position_world_m);
  origin_world_m_ = box.min();
  // Records lie on surfaces: about the spacing they would have spread over the box's six sides.
  const Vec3 size = box.sizes();
  const double area_m2 = 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  cell_m_ = std::max(1.5 * std::sqrt(area_m2 / static_cast<double>(places_.size())), 1e-6 * (1e-300 + size.norm()));
  const std::size_t buckets = 2 * places_.size() + 1;
  bucket_begin_.assign(buckets + 1, 0);
  for (const Place& place : places_) ++bucket_begin_[bucket_of(cell_of(place.position_world_m), buckets) + 1];
  for (std::size_t b = 0; b < buckets; ++b) bucket_begin_[b + 1] += bucket_begin_[b];
  order_.resize(places_.size());
  std::vector<std::uint32_t> next(bucket_begin_.begin(), bucket_begin_.end() - 1);
  for (std::uint32_t i = 0; i < places_.size(); ++i)
    order_[next[bucket_of(cell_of(places_[i].position_world_m), buckets)]++] = i;
}

std::array<std::int64_t, 3> TailRecords::cell_of(const Vec3& position_world_m) const {
  std::array<std::int64_t, 3> cell{};
  for (int axis = 0; axis < 3; ++axis)
    cell[static_cast<std::size_t>(axis)] =
        static_cast<std::int64_t>(std::floor((position_world_m[axis] - origin_world_m_[axis]) / cell_m_));
  return cell;
}

std::span<const std::uint32_t> TailRecords::in_cell(const std::array<std::int64_t, 3>& cell) const {
  const std::size_t b = bucket_of(cell, bucket_begin_.size() - 1);
  return {order_.data() + bucket_begin_[b], bucket_begin_[b + 1] - bucket_begin_[b]};
}

std::optional<TailRecords::Found> TailRecords::nearest(const Vec3& position_world_m, const Vec3& normal_world) const {
  if (places_.empty()) return std::nullopt;
  constexpr double kAlike = 0.9;  // cos 25°
  const double off_plane_m = 0.3 * cell_m_;
  double best_m2 = cell_m_ * cell_m_;
  std::optional<std::uint32_t> best;
  const auto look_in = [&](const std::array<std::int64_t, 3>& cell) {
    for (const std::uint32_t i : in_cell(cell)) {
      const Place& place = places_[i];
      const Vec3 apart_m = place.position_world_m - position_world_m;
      const double distance_m2 = apart_m.squaredNorm();
      if (distance_m2 > best_m2 || (distance_m2 == best_m2 && best && *best <= i)) continue;
      if (place.normal_world.dot(normal_world) < kAlike || std::abs(apart_m.dot(normal_world)) > off_plane_m) continue;
      best_m2 = distance_m2;
      best = i;
    }
  };
  const auto cell = cell_of(position_world_m);
  look_in(cell);
  // Neighbouring cells only as far as the best so far reaches.
  const Vec3 within_m = position_world_m - origin_world_m_;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if (dx == 0 && dy == 0 && dz == 0) continue;
        const std::array<int, 3> step{dx, dy, dz};
        double gap_m2 = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double low_m = static_cast<double>(cell[axis]) * cell_m_;
          const double x_m = within_m[static_cast<Eigen::Index>(axis)] - low_m;
          const double gap_m = step[axis] < 0 ? x_m : step[axis] > 0 ? cell_m_ - x_m : 0;
          gap_m2 += gap_m * gap_m;
        }
        if (gap_m2 >= best_m2) continue;
        look_in({cell[0] + dx, cell[1] + dy, cell[2] + dz});
      }
  if (!best) return std::nullopt;
  return Found{*best, std::sqrt(best_m2)};
}

}  // namespace luxrig
