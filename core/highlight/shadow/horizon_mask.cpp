#include "core/highlight/shadow/horizon_mask.h"

#include <cmath>

namespace luxrig {
namespace {

struct Angles {
  std::array<std::array<float, 2>, kScanAzimuths> azimuth;  // cosine, sine
  std::array<std::array<float, 2>, kScanElevations> elevation;
};

const Angles& scan_angles() {
  static const Angles angles = [] {
    Angles made;
    const auto cosine_and_sine = [](double rad) {
      return std::array{static_cast<float>(std::cos(rad)), static_cast<float>(std::sin(rad))};
    };
    for (std::size_t i = 0; i < kScanAzimuths; ++i)
      made.azimuth[i] = cosine_and_sine(2 * kPi * static_cast<double>(i) / kScanAzimuths);
    for (std::size_t j = 0; j < kScanElevations; ++j)
      made.elevation[j] = cosine_and_sine(kPi / 2 * (static_cast<double>(j) + 0.5) / kScanElevations);
    return made;
  }();
  return angles;
}

constexpr int kLastBits = kScanAzimuths - 64 * (HorizonMask::kWords - 1);  // in the last word

}  // namespace

ScanFrame::ScanFrame(const Vec3& normal) : normal_(normal.cast<float>()) {
  const Vec3 x = normal.unitOrthogonal();
  x_ = x.cast<float>();
  y_ = normal.cross(x).cast<float>();
}

Vec3f ScanFrame::direction(int azimuth, int elevation) const {
  const Angles& angles = scan_angles();
  const auto& a = angles.azimuth[static_cast<std::size_t>(azimuth)];
  const auto& e = angles.elevation[static_cast<std::size_t>(elevation)];
  return e[0] * (a[0] * x_ + a[1] * y_) + e[1] * normal_;
}

HorizonMask::Row HorizonMask::full_row() {
  Row row;
  row.fill(~std::uint64_t{0});
  row.back() = (std::uint64_t{1} << kLastBits) - 1;
  return row;
}

HorizonMask::Row HorizonMask::to_next(const Row& row) {
  Row moved;
  for (std::size_t w = 0; w < kWords; ++w)
    moved[w] = row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : row.back() >> (kLastBits - 1));
  moved.back() &= (std::uint64_t{1} << kLastBits) - 1;
  return moved;
}

HorizonMask::Row HorizonMask::to_previous(const Row& row) {
  Row moved;
  for (std::size_t w = 0; w < kWords; ++w) moved[w] = row[w] >> 1 | (w + 1 < kWords ? row[w + 1] << 63 : 0);
  moved.back() |= (row[0] & 1u) << (kLastBits - 1);
  return moved;
}

}  // namespace luxrig
