#pragma once
/// The slots of a fixture, from the mode of a maker's file. Private to core/rig.

#include <optional>
#include <vector>

#include "core/rig/personality/personality.h"
#include "core/rig/equipment.h"
#include "core/rig/reading/dmx_slots.h"

namespace luxrig {

/// Facts from the rig file that the mode of a fixture has to fit.
struct ModeWanted {
  std::optional<SlotOwner> owner;  ///< none = its luminaire is unknown; checks that need it are skipped
  std::optional<double> beam_deg;  ///< of its luminaire; zooms are set to it
  std::optional<std::pair<double, double>> zoom_deg;  ///< zoom range of its luminaire; none = the zoom is held
  bool turned_elsewhere = false;                      ///< pan and tilt are drives on another bus
  std::string dimmer;                                 ///< its dimmer channel; empty = the maker's file must show it
  std::optional<std::pair<double, double>> pan_range_deg, tilt_range_deg;
  FilePosition in_file, pan_in_file, tilt_in_file,
      dimmer_in_file;  ///< of `mode`, `pan_range_deg`, `tilt_range_deg`, `dimmer`
};

struct ModeSlots {
  std::vector<NamedSlot> slots;
  bool moves = false;
  bool steps = false;                                ///< its dimmer only switches on and off
  JointRange range;                                  ///< only if it moves
  double pan_speed_rad_s = 0, tilt_speed_rad_s = 0;  ///< 0 = not stated in the file
  double zoom_speed_rad_s = 0;                       ///< 0 = not stated in the file
  std::optional<DimmerCurve> dimmer_curve;           ///< none = not stated in the file
  std::vector<std::string> told;                     ///< how the file was interpreted, for a person
};

/// Slots of the mode. nullopt and problems if the mode cannot be used: no dimmer, two possible dimmers, no channel for
/// an emitter, too short a travel, axes that cannot be computed with, several start addresses.
///
/// Light follows the level by the topmost dimmers (personality/dimmer_choice.h). In a luminaire with emitters or a mode
/// without dimmers, it follows by the colours. Held full: dimmers above and below those, and colours. Held dark:
/// colours that the luminaire does not have. Everything else, including other dimmers, stays at its stated default.
[[nodiscard]] std::optional<ModeSlots> slots_of_mode(const Personality& personality, const PersonalityMode& mode,
                                                     const ModeWanted& wanted, ProblemList& problems);

}  // namespace luxrig
