#pragma once
/// Level <-> drive of a dimmer: by its maker's curve, and by what was measured of it.

#include "core/rig/equipment.h"

namespace luxrig {

/// drive <-> level of a maker's nominal curve. Both 0…1, strictly monotone, exact at 0 and 1.
[[nodiscard]] double level_from_drive(DimmerCurve curve, double drive);
[[nodiscard]] double drive_from_level(DimmerCurve curve, double level);

/// Share of full light at a level by the maker's curve, and back; exact at 0 and 1. Between the entries of a measured
/// curve in proportion on logarithmic scales, since dimmers are nearly powers; beyond them as the next two go on.
[[nodiscard]] double share_at_level(const MeasuredCurve& curve, double level);
[[nodiscard]] double level_of_share(const MeasuredCurve& curve, double share);

/// The smallest change of drive that its patch can send; 0 = as small as one likes, or far smaller than any lamp shows.
[[nodiscard]] double smallest_drive_step(const Fixture& fixture);

/// The drive that gives this share of the fixture's full light.
[[nodiscard]] double drive_for(const Fixture& fixture, double level);
/// The share of its full light that this drive gives.
[[nodiscard]] double level_at(const Fixture& fixture, double drive);

}  // namespace luxrig
