#pragma once
/// What the channels of a mode are held at while a fixture is to give plain light: shutters open, wheels at their open
/// place, the lamp commanded to burn, everything else at its default.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/rig/personality/personality.h"

namespace luxrig {

struct HeldValues {
  std::vector<std::uint32_t> dmx;  ///< by channel of the mode
  struct Told {
    std::size_t channel;
    std::string text;
    bool where = true;  ///< it tells where the channel is held, so nothing of one that carries a level
  };
  std::vector<Told> told;  ///< what is held otherwise than by default, and what could not be met
};

/// zoom_deg: full angle that a zoom is set to where the file states its angles; none: its default.
[[nodiscard]] HeldValues held_values(const PersonalityMode& mode, std::optional<double> zoom_deg);

/// Whether the function exists while the mode's channels have these values.
[[nodiscard]] bool is_active(const ChannelFunction& function, const std::vector<std::uint32_t>& dmx);

/// The first function of the channel that is active and of that kind; null when none is.
template <class Wanted>
[[nodiscard]] const ChannelFunction* active_function(const PersonalityChannel& channel,
                                                     const std::vector<std::uint32_t>& dmx, const Wanted& wanted) {
  for (const ChannelFunction& function : channel.functions)
    if (is_active(function, dmx) && wanted(function)) return &function;
  return nullptr;
}

/// Whether the channel's lamp can be commanded without doing anything else by the same channel (a lamp that is struck
/// by the shutter's channel must be struck before, by hand or a console).
[[nodiscard]] bool has_lamp_channel_to_itself(const PersonalityChannel& channel);

}  // namespace luxrig
