#pragma once
/// Distance of each voxel from the nearest set one.

#include <cstdint>
#include <vector>

#include "tools/bench/cache/volume/bit_volume.h"

namespace luxrig {

/// Chessboard distance (largest difference of the three indices), at most kFarthest; 0 in set voxels. It suits strides
/// along rays: the free cube that it guarantees is made of whole voxels.
class DistanceField {
 public:
  static constexpr int kFarthest = 255;

  DistanceField() = default;
  explicit DistanceField(const BitVolume& volume);

  [[nodiscard]] int at(const Eigen::Vector3i& v) const {
    return distance_[(static_cast<std::size_t>(v.z()) * static_cast<std::size_t>(size_.y()) +
                      static_cast<std::size_t>(v.y())) *
                         static_cast<std::size_t>(size_.x()) +
                     static_cast<std::size_t>(v.x())];
  }
  [[nodiscard]] const Eigen::Vector3i& size() const { return size_; }
  [[nodiscard]] std::size_t bytes() const { return distance_.size(); }

 private:
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<std::uint8_t> distance_;
};

}  // namespace luxrig
