#include "core/transport/candidates/reflected/direction_guide.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// Share that is drawn evenly, whatever the worth.
constexpr double kEven = 0.1;
/// Share of a direction's worth that goes to neighbouring bins.
constexpr double kSpread = 0.5;
constexpr std::size_t kBins = DirectionGuide::kRings * DirectionGuide::kSectors;

}  // namespace

std::size_t DirectionGuide::ring_of(const Vec3& direction) {
  return std::min(kRings - 1, static_cast<std::size_t>(std::max(0.0, (direction.z() + 1) / 2 * kRings)));
}

std::size_t DirectionGuide::sector_of(const Vec3& direction) {
  const double turn = std::atan2(direction.y(), direction.x()) / (2 * kPi) + 0.5;
  return std::min(kSectors - 1, static_cast<std::size_t>(std::max(0.0, turn * kSectors)));
}

void DirectionGuide::add(const Vec3& direction, double worth) {
  if (!(worth > 0) || !std::isfinite(worth)) return;
  const std::size_t ring = ring_of(direction), sector = sector_of(direction);
  share_[ring * kSectors + sector] += static_cast<float>((1 - kSpread) * worth);
  const auto about = static_cast<float>(kSpread / 4 * worth);
  share_[ring * kSectors + (sector + 1) % kSectors] += about;
  share_[ring * kSectors + (sector + kSectors - 1) % kSectors] += about;
  share_[std::min(ring + 1, kRings - 1) * kSectors + sector] += about;
  share_[(ring > 0 ? ring - 1 : 0) * kSectors + sector] += about;
  empty_ = false;
}

void DirectionGuide::finish() {
  double sum = 0;
  for (const float s : share_) sum += s;
  for (float& s : share_) s = static_cast<float>(sum > 0 ? kEven / kBins + (1 - kEven) * s / sum : 1.0 / kBins);
  float below = 0;
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    float in_ring = 0;
    for (std::size_t s = 0; s < kSectors; ++s) {
      in_ring += share_[ring * kSectors + s];
      up_to_[ring * kSectors + s] = in_ring;
    }
    below += in_ring;
    up_to_ring_[ring] = below;
  }
}

DirectionSample DirectionGuide::sample(double u, double v) const {
  const double at = v * up_to_ring_.back();
  std::size_t ring = 0;
  while (ring + 1 < kRings && at >= up_to_ring_[ring]) ++ring;
  const double ring_from = ring > 0 ? up_to_ring_[ring - 1] : 0;
  const double ring_share = up_to_ring_[ring] - ring_from;
  const double in_ring = std::clamp((at - ring_from) / ring_share, 0.0, 1.0);
  const float* up_to = up_to_.data() + ring * kSectors;
  const double along = u * static_cast<double>(up_to[kSectors - 1]);
  const auto sector =
      std::min(static_cast<std::size_t>(std::upper_bound(up_to, up_to + kSectors, along) - up_to), kSectors - 1);
  const float share = share_[ring * kSectors + sector];
  const double before = sector > 0 ? static_cast<double>(up_to[sector - 1]) : 0.0;
  const double in_sector = std::clamp((along - before) / static_cast<double>(share), 0.0, 1.0);
  const double z = std::clamp(2 * (static_cast<double>(ring) + in_ring) / kRings - 1, -1.0, 1.0);
  const double angle = 2 * kPi * ((static_cast<double>(sector) + in_sector) / kSectors - 0.5);
  const double radius = std::sqrt(std::max(0.0, 1 - z * z));
  const Vec3 direction(radius * std::cos(angle), radius * std::sin(angle), z);
  return {direction, share * (kBins / (4 * kPi))};
}

double DirectionGuide::density_per_sr(const Vec3& direction) const {
  return share_[ring_of(direction) * kSectors + sector_of(direction)] * (kBins / (4 * kPi));
}

}  // namespace luxrig
