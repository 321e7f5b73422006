#include "core/goals/cell_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace luxrig {
namespace {

constexpr double kOffWorldZero_cells = 0.381966;  // 2 - golden ratio
constexpr CellKey kEveryThird = 0x1249249249249249;

CellKey spread(std::uint32_t coordinate) {
  CellKey bits = coordinate & kMaxCells;
  bits = (bits | bits << 32) & 0x001f00000000ffff;
  bits = (bits | bits << 16) & 0x001f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & kEveryThird;
}

std::uint32_t gathered(CellKey bits) {
  bits &= kEveryThird;
  bits = (bits | bits >> 2) & 0x10c30c30c30c30c3;
  bits = (bits | bits >> 4) & 0x100f00f00f00f00f;
  bits = (bits | bits >> 8) & 0x001f0000ff0000ff;
  bits = (bits | bits >> 16) & 0x001f00000000ffff;
  return static_cast<std::uint32_t>((bits | bits >> 32) & kMaxCells);
}

}  // namespace

CellGrid::CellGrid(double cell_m, const Vec3& origin_world_m, const Eigen::AlignedBox3d& box_m)
    : cell_m_(cell_m), shift_cells_(origin_world_m / cell_m + Vec3::Constant(kOffWorldZero_cells)) {
  if (box_m.isEmpty()) return;
  const Vec3 lowest = (cells_of(box_m.min())).array().floor() - 1;
  shift_cells_ -= lowest;
  cells_ = cells_of(box_m.max()).array().floor() + 2;
}

CellKey key_of(const std::array<std::uint32_t, 3>& cell) {
  return spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2;
}

CellKey key_at(const Vec3& in_cells) {
  return key_of(std::array{static_cast<std::uint32_t>(in_cells.x()), static_cast<std::uint32_t>(in_cells.y()),
                           static_cast<std::uint32_t>(in_cells.z())});
}

std::array<std::uint32_t, 3> cell_of(CellKey key) { return {gathered(key), gathered(key >> 1), gathered(key >> 2)}; }

CellKey next_cell(CellKey key, int axis) {
  const CellKey mask = kEveryThird << axis;
  return (((key | ~mask) + 1) & mask) | (key & ~mask);
}

CellIndex::CellIndex(const std::vector<CellKey>& keys) : slots_(std::bit_ceil(2 * keys.size() + 1)) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    std::size_t slot = slot_of(keys[i]);
    while (slots_[slot].place != kNone) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = {keys[i], static_cast<std::uint32_t>(i)};
  }
}

// Blocks of 4 × 4 × 4 cells stay together: who asks for one cell soon asks for its neighbours.
std::size_t CellIndex::slot_of(CellKey key) const {
  CellKey block = (key >> 6) * 0x9e3779b97f4a7c15;
  block ^= block >> 32;
  return static_cast<std::size_t>(block << 6 | (key & 63)) & (slots_.size() - 1);
}

std::uint32_t CellIndex::find(CellKey key) const {
  if (slots_.empty()) return kNone;
  std::size_t slot = slot_of(key);
  while (slots_[slot].place != kNone && slots_[slot].key != key) slot = (slot + 1) & (slots_.size() - 1);
  return slots_[slot].place;
}

std::vector<std::uint32_t> order_of(const std::vector<CellKey>& keys) {
  constexpr int kDigitBits = 11;
  constexpr std::size_t kDigits = 1u << kDigitBits;
  std::vector<std::uint32_t> order(keys.size()), sorted(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  const CellKey highest = keys.empty() ? 0 : *std::max_element(keys.begin(), keys.end());
  for (int shift = 0; shift < 64 && highest >> shift != 0; shift += kDigitBits) {
    std::vector<std::size_t> place(kDigits + 1, 0);
    const auto digit = [&](std::uint32_t i) { return keys[i] >> shift & (kDigits - 1); };
    for (const std::uint32_t i : order) ++place[digit(i) + 1];
    for (std::size_t d = 0; d < kDigits; ++d) place[d + 1] += place[d];
    for (const std::uint32_t i : order) sorted[place[digit(i)]++] = i;
    order.swap(sorted);
  }
  return order;
}

}  // namespace luxrig
