#pragma once
/// Which channels of a mode dim its light, and how their DMX values follow a level. Private to core/rig and the
/// simulated fixture.
///
/// A file calls a function "Dimmer" for many reasons: a master, a blackout in a corner of a speed slot, the brightness
/// of built-in colours. A channel dims plain light when its dimmer function goes through a range of brightness over a
/// good part of the channel; of two such channels on one part of the fixture, the file does not say which is meant.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/rig/personality/personality.h"

namespace luxrig {

using FunctionKind = std::function<bool(const ChannelFunction&)>;

/// A dimmer's function. A blackout is none, whatever its attribute.
[[nodiscard]] bool is_dimmer(const ChannelFunction& function);
/// Sets the level of a colour that adds light.
[[nodiscard]] bool is_colour(const ChannelFunction& function);

/// How a channel's light lies in its DMX values.
struct LevelRange {
  std::uint32_t least = 0, full = 0;  ///< where its light is least, and brightest: either may be the larger value
  double least_share = 0;             ///< of its brightest light, at `least`
  std::optional<std::uint32_t> dark;  ///< a value outside of that range where the file says there is no light
  bool steps = false;                 ///< nothing between: it is off at `least` and on at `full`
};

/// Of the channel's functions of that kind, while the mode's channels stand at `dmx`. Nothing when none is there, when
/// they state no brightness, or when the brightest place is not one that the level runs up to.
[[nodiscard]] std::optional<LevelRange> level_range(const PersonalityChannel& channel,
                                                    const std::vector<std::uint32_t>& dmx, const FunctionKind& kind);

/// Whether the channel dims plain light.
[[nodiscard]] bool dims_light(const PersonalityChannel& channel, const std::vector<std::uint32_t>& dmx);

struct DimmerChoice {
  std::vector<std::size_t> level;  ///< channels that follow the level: one, or one for each separate part
  std::vector<std::size_t> open;   ///< that dim what those dim, above or below them, and have to be full
  std::vector<std::size_t> left;   ///< other dimmers, which stay at their default
  std::vector<std::size_t> alike;  ///< not empty: each could be it, and nothing was chosen
};

/// `chosen`: the channel that the rig file names.
[[nodiscard]] DimmerChoice choose_dimmers(const PersonalityMode& mode, const std::vector<std::uint32_t>& dmx,
                                          std::optional<std::size_t> chosen);

/// Why the mode is no description of a fixture but a stand-in, as programs write for fixtures that they have no file
/// of: every slot a dimmer of the same part. Empty: it is a description.
[[nodiscard]] std::string stand_in_problem(const PersonalityMode& mode);

}  // namespace luxrig
