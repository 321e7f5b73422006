#pragma once
/// Values at which channels of a mode are held so that a fixture gives plain light: shutters open, wheels at their open
/// place, the lamp on, everything else at its default.

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
    bool where = true;  ///< text states the held value; dropped if the channel carries a level
  };
  std::vector<Told> told;  ///< values held other than at default, and problems
};

/// zoom_deg: full angle to set the zoom to, if the file states its angles; none = its default.
[[nodiscard]] HeldValues held_values(const PersonalityMode& mode, std::optional<double> zoom_deg);

/// Whether the function exists while the mode's channels have these values.
[[nodiscard]] bool is_active(const ChannelFunction& function, const std::vector<std::uint32_t>& dmx);

/// The first active function of that kind on the channel; null if there is none.
template <class Wanted>
[[nodiscard]] const ChannelFunction* active_function(const PersonalityChannel& channel,
                                                     const std::vector<std::uint32_t>& dmx, const Wanted& wanted) {
  for (const ChannelFunction& function : channel.functions)
    if (is_active(function, dmx) && wanted(function)) return &function;
  return nullptr;
}

/// Whether the channel can command the lamp and does nothing else. (A lamp struck by the shutter's channel must be
/// struck beforehand, by hand or from a console.)
[[nodiscard]] bool has_lamp_channel_to_itself(const PersonalityChannel& channel);

}  // namespace luxrig
