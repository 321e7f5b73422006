#include "tools/bench/cache/volume/distance_field.h"

namespace luxrig {

// Two sweeps of the 3×3×3 chamfer with all weights 1, which is exact for the chessboard distance (A. Rosenfeld and J.
// Pfaltz, "Distance functions on digital pictures", 1968). A frame of far voxels around the volume makes checks for
// missing neighbours unnecessary.
DistanceField::DistanceField(const BitVolume& volume) : size_(volume.size()) {
  if (size_.minCoeff() <= 0) return;
  const int nx = size_.x() + 2, ny = size_.y() + 2, nz = size_.z() + 2;
  const auto at = [&](int x, int y, int z) {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(nx) +
           static_cast<std::size_t>(x);
  };
  std::vector<std::uint8_t> framed(at(0, 0, nz), static_cast<std::uint8_t>(kFarthest));
  volume.for_each([&](const Eigen::Vector3i& v) { framed[at(v.x() + 1, v.y() + 1, v.z() + 1)] = 0; });
  std::ptrdiff_t before[13];
  int n = 0;
  for (int dz = -1; dz <= 0; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (dz < 0 || dy < 0 || (dy == 0 && dx < 0))
          before[n++] = (static_cast<std::ptrdiff_t>(dz) * ny + dy) * nx + dx;
  const auto relax = [&](std::size_t i, int sign) {
    int least = framed[i];
    if (least == 0) return;
    for (const std::ptrdiff_t offset : before)
      least = std::min(least, framed[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + sign * offset)] + 1);
    framed[i] = static_cast<std::uint8_t>(least);
  };
  for (int z = 1; z < nz - 1; ++z)
    for (int y = 1; y < ny - 1; ++y)
      for (int x = 1; x < nx - 1; ++x) relax(at(x, y, z), 1);
  for (int z = nz - 2; z > 0; --z)
    for (int y = ny - 2; y > 0; --y)
      for (int x = nx - 2; x > 0; --x) relax(at(x, y, z), -1);
  distance_.reserve(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) *
                    static_cast<std::size_t>(size_.z()));
  for (int z = 1; z < nz - 1; ++z)
    for (int y = 1; y < ny - 1; ++y)
      for (int x = 1; x < nx - 1; ++x) distance_.push_back(framed[at(x, y, z)]);
}

}  // namespace luxrig
