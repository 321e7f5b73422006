#include "core/rig/personality/held_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

bool is_of_shutter(const ChannelFunction& function) { return function.attribute.starts_with("Shutter"); }

bool is_wheel(const ChannelFunction& function) {
  const std::string_view stem = attribute_stem(function.attribute);
  return (stem == "Color" || stem == "Gobo" || stem == "AnimationWheel") && stem != function.attribute;
}

bool is_open_place(const ChannelFunction& function, std::uint32_t value) {
  const ChannelSet* set = function.set_at(value);
  const std::string& name = set && !set->name.empty() ? set->name : function.name;
  return says(name, "open");
}

/// The distinct parts of a function: its sets, or all of it.
std::vector<DmxInterval> distinct_parts_of(const ChannelFunction& function) {
  std::vector<DmxInterval> parts;
  for (const ChannelSet& set : function.sets) parts.push_back(set.dmx);
  if (parts.empty()) parts.push_back(function.dmx);
  return parts;
}

class OpenHolder {
 public:
  OpenHolder(const PersonalityMode& mode, std::optional<double> zoom_deg, HeldValues& held)
      : mode_(mode), zoom_deg_(zoom_deg), held_(held) {}

  void hold(std::size_t c, bool tell) {
    const PersonalityChannel& channel = mode_.channels[c];
    tell_ = tell && !channel.is_virtual();
    const auto any = [&](auto&& wanted) { return active_function(channel, held_.dmx, wanted) != nullptr; };
    if (any(is_of_shutter)) {
      const auto is_open = [](const ChannelFunction& f, std::uint32_t value) {
        return shutter_state(f, value) == ShutterState::open;
      };
      // A range of a strobe channel without a function leaves the light unchanged.
      const auto is_idle = [](const ChannelFunction& f) { return f.attribute == "NoFeature"; };
      const auto idle = [&](const ChannelFunction& f, std::uint32_t) { return is_idle(f); };
      const bool found =
          take(c, "open", true, is_of_shutter, is_open) || take(c, "without strobe", true, is_idle, idle);
      if (!found && tell_) {
        told(c, "{}: no range is stated as open, it stays at its default {}", in_quotes(channel.name), held_.dmx[c]);
      }
    } else if (any(is_wheel)) {
      take(c, "open", false, is_wheel, is_open_place);
    } else if (zoom_deg_ && any([](const ChannelFunction& f) { return f.attribute == "Zoom"; })) {
      hold_zoom(c);
    }
    hold_lamp(c);
  }

 private:
  /// Keeps the default if it is good; else takes the first place that is.
  template <class Of, class Good>
  bool take(std::size_t c, const char* what, bool middle, const Of& of, const Good& good) {
    const PersonalityChannel& channel = mode_.channels[c];
    const ChannelFunction* now = active_function(
        channel, held_.dmx, [&](const ChannelFunction& f) { return of(f) && f.dmx.contains(held_.dmx[c]); });
    if (now != nullptr && good(*now, held_.dmx[c])) return true;
    for (const ChannelFunction& function : channel.functions) {
      if (!of(function) || !is_active(function, held_.dmx)) continue;
      for (const DmxInterval& part : distinct_parts_of(function)) {
        // The end of a shutter that opens gradually is open, too.
        for (const std::uint32_t value : {middle ? part.middle() : part.from, part.to}) {
          if (!good(function, value)) continue;
          held_.dmx[c] = value;
          if (tell_) told(c, "{} {} at {}", in_quotes(channel.name), what, value);
          return true;
        }
      }
    }
    return false;
  }

  void hold_zoom(std::size_t c) {
    const ChannelFunction* zoom =
        active_function(mode_.channels[c], held_.dmx, [](const ChannelFunction& f) { return f.attribute == "Zoom"; });
    const double from = zoom->physical_from, to = zoom->physical_to;
    if (std::abs(to - from) < 1.5) {  // 0 to 1 states no angles, and so small a range is no zoom
      if (tell_)
        told(c, "{} stays at its default {}: its file states no angles{}, so set it to the luminaire's {:.3g}° by hand",
             in_quotes(mode_.channels[c].name), held_.dmx[c],
             says(zoom->name, "narrow") ? fmt::format(" but {}", in_quotes(zoom->name)) : "", *zoom_deg_);
      return;
    }
    const double share = std::clamp((*zoom_deg_ - from) / (to - from), 0.0, 1.0);
    held_.dmx[c] = zoom->dmx.from + static_cast<std::uint32_t>(std::llround(share * (zoom->dmx.to - zoom->dmx.from)));
    if (tell_) {
      const double made_deg = zoom->physical_at(held_.dmx[c]);
      told(c, "{} {:.1f}° at {}{}", in_quotes(mode_.channels[c].name), made_deg, held_.dmx[c],
           std::abs(made_deg - *zoom_deg_) > 0.05 * *zoom_deg_ + 0.1
               ? fmt::format(", the nearest to the luminaire's {:.3g}°", *zoom_deg_)
               : "");
    }
  }

  void hold_lamp(std::size_t c) {
    const PersonalityChannel& channel = mode_.channels[c];
    for (const ChannelFunction& function : channel.functions) {
      if (function.attribute != "LampControl") continue;
      for (const DmxInterval& part : distinct_parts_of(function)) {
        const bool known = part.contains(function.default_dmx) && strikes_lamp(function, function.default_dmx);
        const std::uint32_t value = known && function.default_dmx != part.from ? function.default_dmx : part.middle();
        if (!strikes_lamp(function, value)) continue;
        const std::string hold = function.hold_s > 0 ? fmt::format(", for at least {:g} s", function.hold_s) : "";
        if (!has_lamp_channel_to_itself(channel)) {
          if (tell_) {
            told(c, "strike its lamp by hand: {} does it at {}{}, and is its shutter or dimmer",
                 in_quotes(channel.name), value, hold);
            held_.told.back().where = false;
          }
          return;
        }
        held_.dmx[c] = value;
        if (tell_) told(c, "{} lamp on at {}{}", in_quotes(channel.name), value, hold);
        return;
      }
    }
  }

  template <class... Values>
  void told(std::size_t c, fmt::format_string<Values...> format, Values&&... values) {
    held_.told.push_back({c, fmt::format(format, std::forward<Values>(values)...)});
  }

  const PersonalityMode& mode_;
  std::optional<double> zoom_deg_;
  HeldValues& held_;
  bool tell_ = false;
};

}  // namespace

bool is_active(const ChannelFunction& function, const std::vector<std::uint32_t>& dmx) {
  return !function.when || function.when->dmx.contains(dmx[function.when->channel]);
}

bool has_lamp_channel_to_itself(const PersonalityChannel& channel) {
  return std::none_of(channel.functions.begin(), channel.functions.end(), [](const ChannelFunction& f) {
    return is_of_shutter(f) || attribute_stem(f.attribute) == "Dimmer";
  });
}

HeldValues held_values(const PersonalityMode& mode, std::optional<double> zoom_deg) {
  HeldValues held;
  for (const PersonalityChannel& channel : mode.channels) held.dmx.push_back(channel.default_dmx);
  OpenHolder holder(mode, zoom_deg, held);
  // Two passes, since a channel's function may depend on the held value of another.
  for (const bool tell : {false, true})
    for (std::size_t c = 0; c < mode.channels.size(); ++c) {
      if (tell) held.dmx[c] = mode.channels[c].default_dmx;
      holder.hold(c, tell);
    }
  return held;
}

}  // namespace luxrig
