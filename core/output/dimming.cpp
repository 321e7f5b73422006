#include "core/output/dimming.h"

#include <algorithm>
#include <cmath>
#include <variant>

namespace luxrig {
namespace {

/// 0…1; NaN counts as 0 (dark).
double of_unit(double x) { return x > 0 ? std::min(x, 1.0) : 0.0; }

/// The second of each entry at `at`, a value of the first.
template <class Of, class To>
double along(const MeasuredCurve& curve, double at, Of of, To to) {
  at = of_unit(at);
  if (at == 0 || at == 1 || curve.size() < 2) return at;
  std::size_t next = 1;
  while (next + 1 < curve.size() && of(curve[next]) < at) ++next;
  const auto& a = curve[next - 1];
  const auto& b = curve[next];
  const double share = std::log(at / of(a)) / std::log(of(b) / of(a));
  return of_unit(to(a) * std::pow(to(b) / to(a), share));
}

constexpr auto kLevelOf = [](const auto& entry) { return entry.first; };
constexpr auto kShareOf = [](const auto& entry) { return entry.second; };

}  // namespace

double level_from_drive(DimmerCurve curve, double drive) {
  drive = of_unit(drive);
  switch (curve) {
    case DimmerCurve::square:
      return drive * drive;
    case DimmerCurve::s_curve:
      return drive * drive * (3 - 2 * drive);
    case DimmerCurve::linear:
      break;
  }
  return drive;
}

double drive_from_level(DimmerCurve curve, double level) {
  level = of_unit(level);
  switch (curve) {
    case DimmerCurve::square:
      return std::sqrt(level);
    case DimmerCurve::s_curve: {
      // y = 3x² − 2x³ has the root x = 1/2 − sin(asin(1 − 2y) / 3). With y = sin²(a/2) that becomes
      // sin²(a/6) + √3/2 sin(a/3), which loses no digits for small y as the textbook form does.
      if (level >= 1) return 1;  // the sum below rounds to 1 − 1e-16 there
      const double third = 2.0 / 3.0 * std::asin(std::sqrt(level));
      const double half_sine = std::sin(third / 2);
      return std::min(half_sine * half_sine + std::sqrt(0.75) * std::sin(third), 1.0);
    }
    case DimmerCurve::linear:
      break;
  }
  return level;
}

double share_at_level(const MeasuredCurve& curve, double level) { return along(curve, level, kLevelOf, kShareOf); }

double level_of_share(const MeasuredCurve& curve, double share) { return along(curve, share, kShareOf, kLevelOf); }

double smallest_drive_step(const Fixture& fixture) {
  if (const auto* modbus = std::get_if<ModbusPatch>(&fixture.patch)) {
    if (modbus->coil) return 1;
    const int values = std::abs(modbus->full_scale_raw - modbus->dark_raw);
    return modbus->format.number == RegisterNumber::floating || values == 0 ? 0 : 1.0 / values;
  }
  const auto& slots = std::get<DmxPatch>(fixture.patch).slots;
  const auto coarse =
      std::find_if(slots.begin(), slots.end(), [](const DmxSlot& slot) { return slot.use == SlotUse::dimmer; });
  if (coarse == slots.end()) return 0;
  double values = 255;
  for (const DmxSlot& slot : slots) {
    if (slot.cell != coarse->cell) continue;
    if (slot.use == SlotUse::dimmer_fine) values = std::max(values, 65535.0);
    if (slot.use == SlotUse::dimmer_ultra) values = 16777215;
  }
  const DmxTravel& travel = coarse->travel;
  const double used = std::abs(travel.at_end - travel.at_start);
  return used > 0 ? (1 - travel.least) / (used * values) : 0;
}

double drive_for(const Fixture& fixture, double level) {
  return drive_from_level(fixture.dimmer_curve, level_of_share(fixture.measured_curve, level));
}

double level_at(const Fixture& fixture, double drive) {
  return share_at_level(fixture.measured_curve, level_from_drive(fixture.dimmer_curve, drive));
}

}  // namespace luxrig
