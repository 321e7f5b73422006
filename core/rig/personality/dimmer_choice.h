#pragma once
/// Chooses the channels of a mode that dim its light, and how their DMX values follow a level. Private to core/rig and
/// the simulated fixture.
///
/// Files use the function "Dimmer" for many purposes: a master, a blackout in a corner of a speed slot, the brightness
/// of built-in colours. A channel dims plain light if its dimmer function covers a range of brightness over a good part
/// of the channel. If two such channels act on one part of the fixture, the file does not say which to use.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/rig/personality/personality.h"

namespace luxrig {

using FunctionKind = std::function<bool(const ChannelFunction&)>;

/// A dimmer's function. A blackout is not one, whatever its attribute.
[[nodiscard]] bool is_dimmer(const ChannelFunction& function);
/// The level of a colour that adds light.
[[nodiscard]] bool is_colour(const ChannelFunction& function);

/// Brightness of a channel along its DMX values.
struct LevelRange {
  std::uint32_t least = 0, full = 0;  ///< values of least and of full light; either may be the larger
  double min_share = 0;               ///< light at `least`, as a share of full light
  std::optional<std::uint32_t> dark;  ///< a value outside that range where the file states no light
  bool steps = false;                 ///< nothing between: off at `least`, on at `full`
};

/// Range of the channel's functions of that kind, while the mode's channels have the values `dmx`. nullopt if there is
/// none, if they state no brightness, or if the brightest place is not one that the level runs up to.
[[nodiscard]] std::optional<LevelRange> level_range(const PersonalityChannel& channel,
                                                    const std::vector<std::uint32_t>& dmx, const FunctionKind& kind);

/// Whether the channel dims plain light.
[[nodiscard]] bool dims_light(const PersonalityChannel& channel, const std::vector<std::uint32_t>& dmx);

struct DimmerChoice {
  std::vector<std::size_t> level;  ///< channels that follow the level: one, or one per separate part
  std::vector<std::size_t> open;   ///< dimmers above or below those on the same part, which must be full
  std::vector<std::size_t> left;   ///< other dimmers, which stay at their default
  std::vector<std::size_t> alike;  ///< if not empty, each of these could be the dimmer, and none was chosen
};

/// `chosen`: the channel named in the rig file.
[[nodiscard]] DimmerChoice choose_dimmers(const PersonalityMode& mode, const std::vector<std::uint32_t>& dmx,
                                          std::optional<std::size_t> chosen);

/// Why the mode does not describe a fixture but is a stand-in, as programs write for fixtures without a file: every
/// slot dims the same part. Empty = it is a description.
[[nodiscard]] std::string stand_in_problem(const PersonalityMode& mode);

}  // namespace luxrig
