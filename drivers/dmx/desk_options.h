#pragma once
/// The options of a DMX bus that follows a lighting desk; the same for every protocol with an input.

#include <cstdint>
#include <optional>
#include <vector>

#include "core/output/devices.h"
#include "drivers/dmx/dmx_merge.h"
#include "drivers/options.h"

namespace luxrig {

// Rows for a driver's option table; it adds its own "input_port".
inline constexpr OptionDoc kInputOption = {
    "input",
    "text",
    "",
    "\"none\"",
    "none, merge, takeover or standby",
    "listen to a lighting desk: `merge`: the brighter of both counts; `takeover`: what it sends goes out instead of "
    "Luxrig's while it is there; `standby`: it drives the lamps itself, and Luxrig is silent until it is lost"};
inline constexpr OptionDoc kInputHandBackOption = {
    "input_hand_back",
    "text",
    "",
    "\"fade\"",
    "fade, at-once or when-asked",
    "how a desk that comes while Luxrig has the light gets it: over `fade_s` of `[control]`, at once, or when somebody "
    "asks for it (luxrig hand-back)"};
inline constexpr OptionDoc kInputOffsetOption = {
    "input_offset",
    "whole number",
    "",
    "0",
    "-63999 to 63999",
    "the desk's universe for a fixture is the fixture's own and this: so a desk can send to Luxrig alone"};
inline constexpr OptionDoc kInputMergeOption = {"input_merge",
                                                "text",
                                                "",
                                                "\"htp\"",
                                                "htp or ltp",
                                                "among several desks of one priority, slot by slot: the highest value "
                                                "takes precedence, or the latest change"};

struct DeskOptions {
  std::optional<DeskRules> rules;  ///< empty = no desk input
  int offset = 0;
  std::uint16_t port = 0;
  MergeRule merge = MergeRule::htp;
};
/// requires check_desk_options() to be empty.
[[nodiscard]] DeskOptions desk_options(const Bus& bus, std::span<const OptionDoc> docs);

/// Unknown words, and desk universes outside the range. requires check_options() to be empty.
[[nodiscard]] std::vector<Problem> check_desk_options(const Rig& rig, std::size_t bus, std::span<const OptionDoc> docs,
                                                      int lowest_universe, int highest_universe);

}  // namespace luxrig
