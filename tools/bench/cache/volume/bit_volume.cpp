#include "tools/bench/cache/volume/bit_volume.h"

#include "core/check.h"

namespace luxrig {

BitVolume::BitVolume(const Eigen::Vector3i& size)
    : size_(size), words_per_row_((static_cast<std::size_t>(size.x()) + 63) / 64) {
  LUXRIG_CHECK(size.minCoeff() >= 0, "size {} {} {}", size.x(), size.y(), size.z());
  words_.assign(words_per_row_ * static_cast<std::size_t>(size.y()) * static_cast<std::size_t>(size.z()), 0);
}

std::size_t BitVolume::count() const {
  std::size_t n = 0;
  for (const std::uint64_t word : words_) n += static_cast<std::size_t>(std::popcount(word));
  return n;
}

BitVolume BitVolume::reduced(int factor) const {
  LUXRIG_CHECK(factor > 0, "factor {}", factor);
  BitVolume cells((size_.array() + (factor - 1)) / factor);
  for_each([&](const Eigen::Vector3i& v) { cells.set(v / factor); });
  return cells;
}

BitVolume BitVolume::dilated() const {
  // First along x within words, with the bits that carry over to the next word. Then each row is merged with its eight
  // neighbours.
  BitVolume wide = *this;
  const std::uint64_t last = size_.x() % 64 == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << (size_.x() % 64)) - 1;
  for (int z = 0; z < size_.z(); ++z)
    for (int y = 0; y < size_.y(); ++y) {
      const std::uint64_t* from = row(y, z);
      std::uint64_t* to = wide.row(y, z);
      for (std::size_t w = 0; w < words_per_row_; ++w) {
        to[w] |= (from[w] << 1) | (from[w] >> 1);
        if (w > 0) to[w] |= from[w - 1] >> 63;
        if (w + 1 < words_per_row_) to[w] |= from[w + 1] << 63;
      }
      if (words_per_row_ > 0) to[words_per_row_ - 1] &= last;
    }
  BitVolume out = wide;
  for (int z = 0; z < size_.z(); ++z)
    for (int y = 0; y < size_.y(); ++y)
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy) {
          if (y + dy < 0 || y + dy >= size_.y() || z + dz < 0 || z + dz >= size_.z()) continue;
          const std::uint64_t* from = wide.row(y + dy, z + dz);
          std::uint64_t* to = out.row(y, z);
          for (std::size_t w = 0; w < words_per_row_; ++w) to[w] |= from[w];
        }
  return out;
}

BitVolume BitVolume::intersected(const BitVolume& other) const {
  LUXRIG_CHECK(size_ == other.size_, "sizes differ, {} and {} voxels", size_.prod(), other.size_.prod());
  BitVolume out = *this;
  for (std::size_t w = 0; w < words_.size(); ++w) out.words_[w] &= other.words_[w];
  return out;
}

}  // namespace luxrig
