#pragma once
/// Scan of a hemisphere: a bit for each of 360 × 90 directions, set if blocked.

#include <array>
#include <cstdint>
#include <span>

#include "core/geometry.h"

namespace luxrig {

inline constexpr int kScanAzimuths = 360;
inline constexpr int kScanElevations = 90;

/// Directions of the scan around a normal. Azimuth i is i degrees from an axis at right angles to the normal; elevation
/// j is j + ½ degrees above the plane. So none lies in the plane, and no two coincide at the apex.
class ScanFrame {
 public:
  explicit ScanFrame(const Vec3& normal);
  [[nodiscard]] Vec3f direction(int azimuth, int elevation) const;

 private:
  Vec3f x_, y_, normal_;
};

/// A bit for each direction of a scan; one row per elevation, azimuths along it.
class HorizonMask {
 public:
  static constexpr int kWords = (kScanAzimuths + 63) / 64;
  using Row = std::array<std::uint64_t, kWords>;

  [[nodiscard]] bool test(int azimuth, int elevation) const {
    return rows[static_cast<std::size_t>(elevation)][static_cast<std::size_t>(azimuth / 64)] >> (azimuth % 64) & 1u;
  }
  void set(int azimuth, int elevation, bool value) {
    std::uint64_t& word = rows[static_cast<std::size_t>(elevation)][static_cast<std::size_t>(azimuth / 64)];
    const std::uint64_t bit = std::uint64_t{1} << (azimuth % 64);
    word = value ? word | bit : word & ~bit;
  }
  /// The row with each azimuth's bit moved to the next azimuth, and to the one before.
  [[nodiscard]] static Row to_next(const Row& row);
  [[nodiscard]] static Row to_previous(const Row& row);
  [[nodiscard]] static Row full_row();
  bool operator==(const HorizonMask&) const = default;

  std::array<Row, kScanElevations> rows{};
};

}  // namespace luxrig
