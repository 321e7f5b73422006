#pragma once
/// One bit per voxel, 64 to a word along x.

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "tools/bench/cache/volume/voxel_grid.h"

namespace luxrig {

class BitVolume {
 public:
  BitVolume() = default;
  explicit BitVolume(const Eigen::Vector3i& size);

  [[nodiscard]] const Eigen::Vector3i& size() const { return size_; }

  /// requires 0 ≤ voxel < size.
  [[nodiscard]] bool test(int x, int y, int z) const {
    return (row(y, z)[static_cast<std::size_t>(x) / 64] >> (static_cast<unsigned>(x) % 64)) & 1u;
  }
  [[nodiscard]] bool test(const Eigen::Vector3i& v) const { return test(v.x(), v.y(), v.z()); }
  void set(int x, int y, int z) {
    row(y, z)[static_cast<std::size_t>(x) / 64] |= std::uint64_t{1} << (static_cast<unsigned>(x) % 64);
  }
  void set(const Eigen::Vector3i& v) { set(v.x(), v.y(), v.z()); }

  /// Voxels set.
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] std::size_t bytes() const { return words_.size() * sizeof(std::uint64_t); }

  /// Each cell of factor³ voxels is set if one of its voxels is (thesis §3.2.3, by OR).
  [[nodiscard]] BitVolume reduced(int factor) const;

  /// Set where this voxel or one of its 26 neighbours is set.
  [[nodiscard]] BitVolume dilated() const;

  /// Voxels set in both. requires equal sizes.
  [[nodiscard]] BitVolume intersected(const BitVolume& other) const;

  /// Calls visit(Vector3i) for each voxel set, x fastest.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (int z = 0; z < size_.z(); ++z)
      for (int y = 0; y < size_.y(); ++y)
        for (std::size_t w = 0; w < words_per_row_; ++w)
          for (std::uint64_t bits = row(y, z)[w]; bits != 0; bits &= bits - 1)
            visit(Eigen::Vector3i(static_cast<int>(64 * w) + std::countr_zero(bits), y, z));
  }

  friend bool operator==(const BitVolume& a, const BitVolume& b) { return a.size_ == b.size_ && a.words_ == b.words_; }

 private:
  [[nodiscard]] const std::uint64_t* row(int y, int z) const {
    return words_.data() +
           (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_.y()) + static_cast<std::size_t>(y)) *
               words_per_row_;
  }
  [[nodiscard]] std::uint64_t* row(int y, int z) { return const_cast<std::uint64_t*>(std::as_const(*this).row(y, z)); }

  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::size_t words_per_row_ = 0;
  std::vector<std::uint64_t> words_;
};

}  // namespace luxrig
