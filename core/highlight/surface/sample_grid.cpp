#include "core/highlight/surface/sample_grid.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/check.h"

namespace luxrig {
namespace {

using CellPlace = std::array<std::int32_t, 3>;

std::size_t hash_of(const CellPlace& at) {
  std::uint64_t h = 0;
  for (const std::int32_t i : at) h = (h ^ static_cast<std::uint32_t>(i)) * 0x9E3779B97F4A7C15ull + (h >> 29);
  return static_cast<std::size_t>(h ^ (h >> 32));
}

CellPlace cell_at(const Vec3& place_m, const Vec3& low_m, double cell_m) {
  CellPlace at;
  for (int axis = 0; axis < 3; ++axis)
    // In a grid too fine for cell numbers, far cells are joined, which only costs time.
    at[static_cast<std::size_t>(axis)] =
        static_cast<std::int32_t>(std::clamp(std::floor((place_m[axis] - low_m[axis]) / cell_m), -1e9, 1e9));
  return at;
}

Vec3 low_corner(const std::vector<SurfaceSample>& samples) {
  Eigen::AlignedBox3d box;
  for (const SurfaceSample& sample : samples) box.extend(sample.position_m);
  return box.isEmpty() ? Vec3::Zero() : Vec3(box.min());
}

}  // namespace

SampleGrid::SampleGrid(std::vector<SurfaceSample> samples, double cell_m) : cell_m_(cell_m) {
  LUXRIG_CHECK(cell_m > 0 && std::isfinite(cell_m), "cell {} m", cell_m);
  low_m_ = low_corner(samples);
  struct Key {
    CellPlace at;
    std::uint32_t sample;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<Key> keys(samples.size());
  for (std::uint32_t i = 0; i < samples.size(); ++i) keys[i] = {cell_of(samples[i].position_m), i};
  std::sort(keys.begin(), keys.end());
  samples_.reserve(samples.size());
  for (std::uint32_t k = 0; k < keys.size(); ++k) {
    if (k == 0 || keys[k].at != keys[k - 1].at) cells_.push_back({keys[k].at, k, k});
    cells_.back().end = k + 1;
    samples_.push_back(samples[keys[k].sample]);
  }
  table_.assign(std::bit_ceil(2 * cells_.size() + 2), 0);
  for (std::uint32_t c = 0; c < cells_.size(); ++c) table_[slot_of(cells_[c].at)] = c + 1;
}

std::array<std::int32_t, 3> SampleGrid::cell_of(const Vec3& place_m) const { return cell_at(place_m, low_m_, cell_m_); }

std::size_t SampleGrid::slot_of(const CellPlace& at) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = hash_of(at) & mask;
  while (table_[slot] != 0 && cells_[table_[slot] - 1].at != at) slot = (slot + 1) & mask;
  return slot;
}

void SampleGrid::near(const Vec3& place_m, double reach_m,
                      std::vector<std::span<const SurfaceSample>>& stretches) const {
  stretches.clear();
  const CellPlace low = cell_of(place_m - Vec3::Constant(reach_m)), high = cell_of(place_m + Vec3::Constant(reach_m));
  CellPlace at;
  for (at[0] = low[0]; at[0] <= high[0]; ++at[0])
    for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
      for (at[2] = low[2]; at[2] <= high[2]; ++at[2])
        if (const std::uint32_t cell = table_[slot_of(at)])
          stretches.push_back(
              std::span(samples_).subspan(cells_[cell - 1].begin, cells_[cell - 1].end - cells_[cell - 1].begin));
}

std::vector<SurfaceSample> merged_in_cells(const std::vector<SurfaceSample>& samples, double cell_m) {
  const Vec3 low_m = low_corner(samples);
  struct Key {
    CellPlace at;
    std::uint32_t sample;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<Key> keys(samples.size());
  for (std::uint32_t i = 0; i < samples.size(); ++i) keys[i] = {cell_at(samples[i].position_m, low_m, cell_m), i};
  std::sort(keys.begin(), keys.end());
  struct Sum {
    Vec3 moment_m = Vec3::Zero(), plain_m = Vec3::Zero(), normal = Vec3::Zero();
    double area_m2 = 0, count = 0;
  };
  std::vector<Sum> sums;  // of one cell
  std::vector<SurfaceSample> merged;
  for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    sums.clear();
    for (; end < keys.size() && keys[end].at == keys[begin].at; ++end) {
      const SurfaceSample& sample = samples[keys[end].sample];
      auto sum = std::ranges::find_if(sums, [&](const Sum& one) { return !(one.normal.dot(sample.normal) < 0); });
      if (sum == sums.end()) sum = sums.emplace(sums.end());
      sum->moment_m += sample.area_m2 * sample.position_m;
      sum->plain_m += sample.position_m;
      sum->normal += sample.area_m2 * sample.normal;
      sum->area_m2 += sample.area_m2;
      ++sum->count;
    }
    for (const Sum& sum : sums)
      merged.push_back({sum.area_m2 > 0 ? Vec3(sum.moment_m / sum.area_m2) : Vec3(sum.plain_m / sum.count),
                        sum.normal.isZero(0) ? sum.normal : Vec3(sum.normal.normalized()), sum.area_m2});
  }
  return merged;
}

}  // namespace luxrig
