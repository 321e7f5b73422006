#include "core/rig/personality/dimmer_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rig/personality/held_values.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr double kMinChange = 0.05;    // of full light: a smaller change is not dimming
constexpr double kAsBright = 0.99;     // of the brightest place
constexpr double kNoLight = 1e-6;
constexpr double kMinPart = 0.25;  // least share of a channel's values for its main dimmer function
constexpr std::size_t kMinOfStandIn = 3;

double brightest_of(const ChannelFunction& f) { return std::max(f.physical_from, f.physical_to); }
double darkest_of(const ChannelFunction& f) { return std::min(f.physical_from, f.physical_to); }
double width_of(const DmxInterval& dmx) { return static_cast<double>(dmx.to - dmx.from) + 1; }

/// The place of a range that is safest from its neighbours: its end if the channel ends there, else its middle.
std::uint32_t inside(const PersonalityChannel& channel, const DmxInterval& dmx) {
  return dmx.from == 0 ? 0 : dmx.to == channel.max_dmx() ? dmx.to : dmx.middle();
}

/// A value that the file states as dark: a range of the kind without light, or a closed shutter on the same channel.
std::optional<std::uint32_t> dark_value(const PersonalityChannel& channel, const std::vector<std::uint32_t>& dmx,
                                        const FunctionKind& kind, double full) {
  std::optional<std::uint32_t> shut;
  for (const ChannelFunction& f : channel.functions) {
    if (!is_active(f, dmx)) continue;
    const std::uint32_t value = inside(channel, f.dmx);
    if (kind(f) && brightest_of(f) <= kNoLight * full) return value;
    if (!shut && f.sets.empty() && shutter_state(f, value) == ShutterState::closed) shut = value;
  }
  return shut;
}

bool is_on_or_above(const PersonalityMode& mode, std::size_t outer, std::size_t inner) {
  for (std::optional<std::size_t> at = inner; at; at = mode.geometries[*at].parent)
    if (*at == outer) return true;
  return false;
}

}  // namespace

bool is_dimmer(const ChannelFunction& function) {
  return attribute_stem(function.attribute) == "Dimmer" && !says(function.name, "blackout") &&
         !says(function.name, "black out");
}

bool is_colour(const ChannelFunction& function) { return !emitter_of_attribute(function.attribute).empty(); }

std::optional<LevelRange> level_range(const PersonalityChannel& channel, const std::vector<std::uint32_t>& dmx,
                                      const FunctionKind& kind) {
  double full = 0;
  for (const ChannelFunction& f : channel.functions)
    if (is_active(f, dmx) && kind(f)) full = std::max(full, brightest_of(f));
  if (!(full > 0)) return std::nullopt;
  const ChannelFunction *runs = nullptr, *on = nullptr;
  bool runs_elsewhere = false;
  for (const ChannelFunction& f : channel.functions) {
    if (!is_active(f, dmx) || !kind(f)) continue;
    const bool changes = f.dmx.to > f.dmx.from && brightest_of(f) - darkest_of(f) > kMinChange * full;
    const bool as_bright = brightest_of(f) >= kAsBright * full;
    runs_elsewhere |= changes && !as_bright;
    if (!as_bright) continue;
    const ChannelFunction*& best = changes ? runs : on;
    if (!best || width_of(f.dmx) > width_of(best->dmx)) best = &f;
  }
  const std::optional<std::uint32_t> dark = dark_value(channel, dmx, kind, full);
  if (!runs) {
    if (!on || !dark || runs_elsewhere) return std::nullopt;
    return LevelRange{*dark, inside(channel, on->dmx), 0, std::nullopt, true};
  }
  const bool rises = runs->physical_to > runs->physical_from;
  const double least = std::max(0.0, darkest_of(*runs)) / brightest_of(*runs);
  return LevelRange{rises ? runs->dmx.from : runs->dmx.to, rises ? runs->dmx.to : runs->dmx.from,
                    least > kNoLight ? least : 0, dark, false};
}

bool dims_light(const PersonalityChannel& channel, const std::vector<std::uint32_t>& dmx) {
  const auto range = level_range(channel, dmx, is_dimmer);
  if (!range) return false;
  // A channel for light only (with shutter and lamp command) is there to dim, however short its dimmer range.
  const bool only_light = std::all_of(channel.functions.begin(), channel.functions.end(), [](const auto& f) {
    return is_dimmer(f) || f.attribute == "NoFeature" || f.attribute == "LampControl" || f.attribute == "Control1" ||
           f.attribute.starts_with("Shutter") || f.attribute.starts_with("Strobe");
  });
  if (only_light || range->steps) return only_light;
  const DmxInterval values{std::min(range->least, range->full), std::max(range->least, range->full)};
  return width_of(values) >= kMinPart * (static_cast<double>(channel.max_dmx()) + 1);
}

DimmerChoice choose_dimmers(const PersonalityMode& mode, const std::vector<std::uint32_t>& dmx,
                            std::optional<std::size_t> chosen) {
  std::vector<std::size_t> all;
  for (std::size_t c = 0; c < mode.channels.size(); ++c)
    if (!mode.channels[c].is_virtual() && (c == chosen || dims_light(mode.channels[c], dmx))) all.push_back(c);
  const auto part = [&](std::size_t c) { return mode.channels[c].geometry; };
  const auto alone = [&](std::size_t c) {
    return std::count_if(all.begin(), all.end(), [&](std::size_t other) { return part(other) == part(c); }) == 1;
  };
  DimmerChoice choice;
  if (chosen) {
    choice.level = {*chosen};
  } else {
    for (const std::size_t c : all) {
      const bool below_another = std::any_of(all.begin(), all.end(), [&](std::size_t other) {
        return part(other) != part(c) && is_on_or_above(mode, part(other), part(c));
      });
      if (below_another) continue;
      if (alone(c)) {
        choice.level.push_back(c);
        continue;
      }
      if (choice.alike.empty()) {
        for (const std::size_t other : all)
          if (part(other) == part(c)) choice.alike.push_back(other);
      }
    }
    if (!choice.alike.empty()) return choice;
  }
  for (const std::size_t c : all) {
    if (std::find(choice.level.begin(), choice.level.end(), c) != choice.level.end()) continue;
    const bool in_series = std::any_of(choice.level.begin(), choice.level.end(), [&](std::size_t level) {
      return part(c) != part(level) && mode.share_a_branch(part(c), part(level));
    });
    (in_series && alone(c) ? choice.open : choice.left).push_back(c);
  }
  return choice;
}

std::string stand_in_problem(const PersonalityMode& mode) {
  std::size_t slots = 0, part = 0;
  std::string first, last;
  for (const PersonalityChannel& channel : mode.channels) {
    if (channel.is_virtual()) continue;
    const bool dimmer_only = std::all_of(channel.functions.begin(), channel.functions.end(),
                                         [](const auto& f) { return attribute_stem(f.attribute) == "Dimmer"; });
    if (!dimmer_only || (slots > 0 && channel.geometry != part)) return {};
    part = channel.geometry;
    if (slots++ == 0) first = channel.name;
    last = channel.name;
  }
  if (slots < kMinOfStandIn) return {};
  return fmt::format(
      "calls all of its {} slots dimmers of one part, {} to {}: a stand-in that a program writes for a fixture it has "
      "no file of, which does not say what any slot does",
      slots, in_quotes(first), in_quotes(last));
}

}  // namespace luxrig
