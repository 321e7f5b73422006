#pragma once
/// The slots of a fixture, from the mode of a maker's file. Private to core/rig.

#include <optional>
#include <vector>

#include "core/rig/personality/personality.h"
#include "core/rig/reading/dmx_slots.h"

namespace luxrig {

/// What the rig file says of the fixture that its mode has to fit.
struct ModeWanted {
  std::optional<SlotOwner> owner;  ///< none: its luminaire is not known, and what depends on it goes unchecked
  std::optional<double> beam_deg;  ///< of its luminaire; zooms are set to it
  std::optional<std::pair<double, double>> zoom_deg;  ///< what its luminaire's zoom goes through; none: it is held
  bool turned_elsewhere = false;                      ///< pan and tilt are drives on another bus
  std::string dimmer;                                 ///< channel that is its dimmer; empty: the file has to say
  std::optional<std::pair<double, double>> pan_range_deg, tilt_range_deg;
  Place place, pan_place, tilt_place, dimmer_place;  ///< of `mode`, `pan_range_deg`, `tilt_range_deg`, `dimmer`
};

struct ModeSlots {
  std::vector<NamedSlot> slots;
  bool moves = false;
  bool steps = false;                                ///< its dimmer is on or off
  JointRange range;                                  ///< only when it moves
  double pan_speed_rad_s = 0, tilt_speed_rad_s = 0;  ///< 0: the file states none
  double zoom_speed_rad_s = 0;                       ///< the same
  std::optional<DimmerCurve> dimmer_curve;           ///< none: the file states none
  std::vector<std::string> told;                     ///< how it was understood, for a person
};

/// Nothing, and problems, when the mode cannot serve: no dimmer, two that could be it, no channel for an emitter, a
/// travel that is too short, axes that cannot be computed with, several start addresses.
///
/// Light follows the level by the topmost dimmers (personality/dimmer_choice.h), or, in a luminaire with emitters or a
/// mode without dimmers, by the colours. Held full: dimmers above and below those, and colours. Held dark: colours that
/// the luminaire does not have. All else, other dimmers too, stays at its stated default.
[[nodiscard]] std::optional<ModeSlots> slots_of_mode(const Personality& personality, const PersonalityMode& mode,
                                                     const ModeWanted& wanted, ProblemList& problems);

}  // namespace luxrig
