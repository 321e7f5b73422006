#include "core/transport/paths/irradiance_records.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace luxrig {
namespace {

/// Mean number of records in a record's cell above which cells are narrowed. With records spread over all surfaces of a
/// venue it is 3 to 4.
constexpr double kMaxCrowded = 8;

}  // namespace

void IrradianceRecords::append(std::span<const Vertex> places, std::size_t columns) {
  places_.insert(places_.end(), places.begin(), places.end());
  columns_ = columns;
  values_.resize(places_.size() * columns, 0.0f);
  told_.assign(places_.size() * columns, 0.0f);
  sums_.assign(places_.size(), {});
  lit_.clear();
  if (!places_.empty()) build_grid();
}

void IrradianceRecords::sum_up(std::size_t record, std::span<const double> levels) {
  // Shorter gaps cost more to skip than to add.
  constexpr std::uint32_t kShortestGap = 16;
  const auto emitters = static_cast<std::uint32_t>(levels.size());
  const float* const from = told(record).data();
  Sums& sums = sums_[record];
  sums = {Vec3::Zero(), static_cast<std::uint32_t>(lit_.size()), 0};
  for (std::uint32_t e = 0; e < emitters; ++e) {
    const Vec3 lux_rgb(from[e], from[emitters + e], from[2 * emitters + e]);
    if ((lux_rgb.array() == 0).all()) continue;
    sums.lux_rgb += levels[e] * lux_rgb;
    if (lit_.size() > sums.begin && e < lit_.back().end + kShortestGap) {
      lit_.back().end = e + 1;
    } else {
      lit_.push_back({e, e + 1});
    }
  }
  sums.end = static_cast<std::uint32_t>(lit_.size());
}

void IrradianceRecords::build_grid() {
  Eigen::AlignedBox3d box;
  for (const Vertex& place : places_) box.extend(place.position_world_m);
  origin_world_m_ = box.min();
  // Records are on surfaces: the approximate spacing if they were spread over the box's six sides.
  const Vec3 size = box.sizes();
  const double area_m2 = 2 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  const auto min_cell_m = static_cast<float>(1e-6 * size.norm() + 1e-15);  // its square is not 0 in float
  cell_m_ = std::max(static_cast<float>(1.5 * std::sqrt(area_m2 / static_cast<double>(places_.size()))), min_cell_m);
  std::size_t buckets = 16;
  while (buckets < 2 * places_.size()) buckets *= 2;
  std::vector<std::uint32_t> bucket_of_record(places_.size());
  const auto spread = [&] {
    row_cells_ = static_cast<std::uint32_t>(cell_of(size.cast<float>())[0]) + 1;
    layer_cells_ = row_cells_ * (static_cast<std::uint32_t>(cell_of(size.cast<float>())[1]) + 1);
    bucket_begin_.assign(buckets + 1, 0);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Vec3f position_m = (places_[i].position_world_m - origin_world_m_).cast<float>();
      bucket_of_record[i] = static_cast<std::uint32_t>(bucket_of(cell_of(position_m)));
      ++bucket_begin_[bucket_of_record[i] + 1];
    }
    double squares = 0;
    for (const std::uint32_t count : bucket_begin_) squares += static_cast<double>(count) * count;
    return squares / static_cast<double>(places_.size());
  };
  // A few distant records, seen through a door, must not put the whole room with the others into one cell.
  while (spread() > kMaxCrowded && cell_m_ > 2 * min_cell_m) cell_m_ *= 0.5f;
  for (std::size_t b = 0; b < buckets; ++b) bucket_begin_[b + 1] += bucket_begin_[b];
  packed_.resize(places_.size());
  std::vector<std::uint32_t> next(bucket_begin_.begin(), bucket_begin_.end() - 1);
  for (std::uint32_t i = 0; i < places_.size(); ++i)
    packed_[next[bucket_of_record[i]]++] = {(places_[i].position_world_m - origin_world_m_).cast<float>(),
                                            places_[i].normal_world.cast<float>(), i};
}

IrradianceRecords::Cell IrradianceRecords::cell_of(const Vec3f& position_m) const {
  Cell cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // A place far from all records has none nearby; the bound keeps the conversion defined.
    const float at = std::floor(position_m[static_cast<Eigen::Index>(axis)] / cell_m_);
    cell[axis] = static_cast<std::int32_t>(std::clamp(at, -1e9f, 1e9f));
  }
  return cell;
}

std::size_t IrradianceRecords::bucket_of(const Cell& cell) const {
  // Row by row, so that neighbours are contiguous; cells beyond the table share its buckets.
  const std::uint32_t at = static_cast<std::uint32_t>(cell[0]) + static_cast<std::uint32_t>(cell[1]) * row_cells_ +
                           static_cast<std::uint32_t>(cell[2]) * layer_cells_;
  return at & (static_cast<std::uint32_t>(bucket_begin_.size()) - 2);
}

void IrradianceRecords::find_beside(std::uint32_t record, std::vector<std::uint32_t>& beside) const {
  constexpr float kAlike = 0.95f;  // cos 18°
  beside.clear();
  const Vec3f position_m = (places_[record].position_world_m - origin_world_m_).cast<float>();
  const Vec3f normal = places_[record].normal_world.cast<float>();
  const float off_plane_m = 0.2f * cell_m_;
  const Cell cell = cell_of(position_m);
  const std::size_t bucket = bucket_of(cell);
  for (std::uint32_t i = bucket_begin_[bucket]; i < bucket_begin_[bucket + 1]; ++i) {
    const Packed& one = packed_[i];
    if (one.record == record || cell_of(one.position_m) != cell || one.normal.dot(normal) < kAlike) continue;
    const Vec3f apart_m = one.position_m - position_m;
    if (std::max(std::abs(apart_m.dot(normal)), std::abs(apart_m.dot(one.normal))) > off_plane_m) continue;
    beside.push_back(one.record);
  }
}

std::optional<IrradianceRecords::Found> IrradianceRecords::nearest(const Vec3& position_world_m,
                                                                   const Vec3& normal_world) const {
  if (places_.empty()) return std::nullopt;
  constexpr float kAlike = 0.9f;  // cos 25°
  constexpr float kFlat = 0.95f;
  const Vec3f position_m = (position_world_m - origin_world_m_).cast<float>(), normal = normal_world.cast<float>();
  const float off_plane_m = 0.3f * cell_m_;
  float best_m2 = cell_m_ * cell_m_;
  std::optional<std::uint32_t> best;
  const auto look_in = [&](const Cell& cell) {
    const std::size_t bucket = bucket_of(cell);
    for (std::uint32_t i = bucket_begin_[bucket]; i < bucket_begin_[bucket + 1]; ++i) {
      const Packed& one = packed_[i];
      const Vec3f apart_m = one.position_m - position_m;
      const float distance_m2 = apart_m.squaredNorm();
      if (distance_m2 > best_m2 || (distance_m2 == best_m2 && best && *best <= one.record)) continue;
      if (one.normal.dot(normal) < kAlike || std::abs(apart_m.dot(normal)) > off_plane_m) continue;
      best_m2 = distance_m2;
      best = one.record;
    }
  };
  const Cell cell = cell_of(position_m);
  // Neighbouring cells only within the reach of the best so far, those on the nearer side first; above and below the
  // surface only within the tolerance of its plane.
  struct Side {
    std::int32_t step;
    float gap2_m2;
  };
  std::array<std::array<Side, 3>, 3> sides{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float in_cell_m = position_m[static_cast<Eigen::Index>(axis)] - static_cast<float>(cell[axis]) * cell_m_;
    const bool flat = std::abs(normal[static_cast<Eigen::Index>(axis)]) > kFlat;
    const auto gap2_m2 = [&](float gap_m) { return flat && gap_m > off_plane_m ? HUGE_VALF : gap_m * gap_m; };
    const Side low{-1, gap2_m2(in_cell_m)}, high{1, gap2_m2(cell_m_ - in_cell_m)};
    const bool low_first = in_cell_m < cell_m_ - in_cell_m;
    sides[axis] = {Side{0, 0}, low_first ? low : high, low_first ? high : low};
  }
  for (const Side& z : sides[2]) {
    if (z.gap2_m2 >= best_m2) break;
    for (const Side& y : sides[1]) {
      if (y.gap2_m2 + z.gap2_m2 >= best_m2) break;
      for (const Side& x : sides[0]) {
        if (x.gap2_m2 + y.gap2_m2 + z.gap2_m2 >= best_m2) break;
        look_in({cell[0] + x.step, cell[1] + y.step, cell[2] + z.step});
      }
    }
  }
  if (!best) return std::nullopt;
  return Found{*best, static_cast<double>(std::sqrt(best_m2))};
}

}  // namespace luxrig
