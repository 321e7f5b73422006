#include "core/rig/reading/mode_slots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rig/personality/dimmer_choice.h"
#include "core/rig/personality/held_values.h"
#include "core/text/nearest.h"

namespace luxrig {
namespace {

constexpr double kSlack_deg = 1e-6;

/// 0 to 1 is a placeholder of files without a travel.
bool states_travel(const ChannelFunction& function) {
  return std::abs(function.physical_to - function.physical_from) > 1.5;
}

/// The named curve that fits a profile within 5 % of the rated flux.
std::optional<DimmerCurve> curve_like(const DmxProfile& profile) {
  const auto level = [](DimmerCurve curve, double x) {
    return curve == DimmerCurve::linear ? x : curve == DimmerCurve::square ? x * x : x * x * (3 - 2 * x);
  };
  for (const DimmerCurve curve : {DimmerCurve::linear, DimmerCurve::square, DimmerCurve::s_curve}) {
    bool near = true;
    for (int i = 0; i <= 64; ++i) near &= std::abs(profile.at(i / 64.0) - level(curve, i / 64.0)) <= 0.05;
    if (near) return curve;
  }
  return std::nullopt;
}

/// Whether its zoom is a further joint of a head.
bool zooms(const PersonalityMode& mode, const ModeWanted& wanted) {
  const auto has = [&](std::string_view attribute) {
    return std::any_of(mode.channels.begin(), mode.channels.end(), [&](const PersonalityChannel& channel) {
      return !channel.is_virtual() && std::any_of(channel.functions.begin(), channel.functions.end(),
                                                  [&](const ChannelFunction& f) { return f.attribute == attribute; });
    });
  };
  return wanted.zoom_deg && has("Zoom") && (wanted.turned_elsewhere || (has("Pan") && has("Tilt")));
}

class ModeFitter {
 public:
  ModeFitter(const Personality& personality, const PersonalityMode& mode, const ModeWanted& wanted,
             ProblemList& problems)
      : personality_(personality),
        mode_(mode),
        wanted_(wanted),
        problems_(problems),
        held_(held_values(mode, zooms(mode, wanted) ? std::nullopt : wanted.beam_deg)) {}

  std::optional<ModeSlots> fit() {
    if (mode_.break_footprints.size() != 1) {
      return refuse(mode_.break_footprints.empty()
                        ? "takes no DMX slot"
                        : fmt::format("has {} start addresses", mode_.break_footprints.size()),
                    "choose another mode: a fixture here has one address");
    }
    if (const std::string stand_in = stand_in_problem(mode_); !stand_in.empty())
      return refuse(stand_in, "get the maker's GDTF file, or write its slots by hand");
    out_.slots.assign(static_cast<std::size_t>(mode_.footprint()),
                      NamedSlot{{SlotUse::unused, 0}, std::nullopt, wanted_.in_file});
    if (!carry_light() || !carry_joints()) return std::nullopt;
    for (std::size_t c = 0; c < mode_.channels.size(); ++c)
      if (!carried_[c]) hold(c);
    for (HeldValues::Told& told : held_.told)
      if (!told.where || !carried_[told.channel]) out_.told.push_back(std::move(told.text));
    return std::move(out_);
  }

 private:
  std::optional<ModeSlots> refuse(const std::string& what, std::string mend) {
    problems_.add(wanted_.in_file, fmt::format("mode {} {}", in_quotes(mode_.name), what), std::move(mend));
    return std::nullopt;
  }

  template <class Of>
  std::vector<std::size_t> channels_of(const Of& of) const {
    std::vector<std::size_t> found;
    for (std::size_t c = 0; c < mode_.channels.size(); ++c)
      if (!mode_.channels[c].is_virtual() && active_function(mode_.channels[c], held_.dmx, of)) found.push_back(c);
    return found;
  }

  bool carry_light() {
    const std::optional<DimmerChoice> dimmers = choose();
    if (!dimmers) return false;
    const std::vector<std::size_t> colours = channels_of(is_colour);
    const bool by_emitter = wanted_.owner && !wanted_.owner->emitters.empty();
    if (by_emitter && !carry_emitters(colours)) return false;
    for (const std::size_t c : dimmers->level) {
      if (by_emitter) {
        hold_full(c, is_dimmer, "full");
      } else {
        carry(c, is_dimmer, std::nullopt, "dimmer");
      }
    }
    for (const std::size_t c : dimmers->open)
      if (!carried_[c]) hold_full(c, is_dimmer, "full");
    for (const std::size_t c : dimmers->left)
      if (!carried_[c])
        tell("{} is another dimmer, which nothing asks for: it stays at its default {}",
             in_quotes(mode_.channels[c].name), held_.dmx[c]);
    for (const std::size_t c : colours) {
      if (carried_[c] || !range_of(c, is_colour)) continue;
      if (by_emitter) {
        held_.dmx[c] = range_of(c, is_colour)->dark.value_or(range_of(c, is_colour)->least);
        tell("{} dark, which its luminaire does not have", in_quotes(mode_.channels[c].name));
      } else if (dimmers->level.empty()) {
        carry(c, is_colour, std::nullopt, "its level");
      } else {
        hold_full(c, is_colour, "full");
      }
    }
    const bool any = cells_ > 0;
    shut_where_level_0_is_not_dark(!by_emitter);
    if (any || !wanted_.owner) return true;
    static_cast<void>(
        refuse("has no dimmer" + slight_dimmers(), "choose another mode: every fixture is set by its level"));
    return false;
  }

  std::optional<LevelRange> range_of(std::size_t c, const FunctionKind& kind) const {
    return level_range(mode_.channels[c], held_.dmx, kind);
  }

  /// nullopt and a problem if the choice is not clear.
  std::optional<DimmerChoice> choose() {
    std::optional<std::size_t> chosen;
    std::vector<std::string_view> known;
    for (std::size_t c = 0; c < mode_.channels.size(); ++c) {
      if (mode_.channels[c].is_virtual() || !range_of(c, is_dimmer)) continue;
      known.push_back(mode_.channels[c].name);
      if (!chosen && mode_.channels[c].name == wanted_.dimmer) chosen = c;
    }
    if (!wanted_.dimmer.empty() && !chosen) {
      problems_.add(wanted_.dimmer_in_file,
                    fmt::format("mode {} has no dimmer {}", in_quotes(mode_.name), in_quotes(wanted_.dimmer)),
                    mend_for_unknown(wanted_.dimmer, known, "it has none at all: choose another mode"));
      return std::nullopt;
    }
    DimmerChoice choice = choose_dimmers(mode_, held_.dmx, chosen);
    if (choice.alike.empty()) return choice;
    std::string names;
    for (std::size_t i = 0; i < choice.alike.size() && i < 6; ++i)
      names += fmt::format("{}{} (slot {})",
                           i == 0                        ? ""
                           : i + 1 < choice.alike.size() ? ", "
                                                         : " and ",
                           in_quotes(mode_.channels[choice.alike[i]].name),
                           mode_.channels[choice.alike[i]].offsets.front() + 1);
    static_cast<void>(
        refuse(fmt::format("has dimmers {}{}, and its file does not say which of them dims its light", names,
                           choice.alike.size() > 6 ? " and more" : ""),
               "add dimmer = \"NAME\" with the one that its manual says does; the others stay at their default"));
    return std::nullopt;
  }

  /// Channels where a dimmer is one function among others.
  std::string slight_dimmers() const {
    for (const PersonalityChannel& channel : mode_.channels) {
      if (channel.is_virtual()) continue;
      for (const ChannelFunction& f : channel.functions)
        if (attribute_stem(f.attribute) == "Dimmer")
          return fmt::format(
              ": {} has a function of one at {} to {}, which goes through no range of brightness that "
              "a level could follow",
              in_quotes(channel.name), f.dmx.from, f.dmx.to);
    }
    return "";
  }

  /// If the lowest value of a dimmer still gives light, a shutter beside it shuts at level 0, or a remark says so.
  /// `one_level`: false for one dimmer per emitter, all behind the same shutter.
  void shut_where_level_0_is_not_dark(bool one_level) {
    for (const auto& [dimmer, min_share] : bright_at_0_) {
      bool shut = false;
      for (std::size_t c = 0; c < mode_.channels.size() && one_level; ++c) {
        const PersonalityChannel& channel = mode_.channels[c];
        if (channel.is_virtual() || !mode_.share_a_branch(channel.geometry, mode_.channels[dimmer].geometry)) continue;
        shut |= shuts_[c];
        const auto closed = carried_[c] ? std::optional<std::uint32_t>() : shut_value(channel);
        if (!closed) continue;
        shut = shuts_[c] = true;
        const double open = share_of(c, held_.dmx[c]);
        place(c, SlotUse::dimmer, std::nullopt, {open, open, 0, share_of(c, *closed)});
        tell("{} shut at level 0 ({}), open at any other ({})", in_quotes(channel.name), *closed, held_.dmx[c]);
      }
      if (!shut)
        tell("{} gives {:.3g} % of its light at level 0: its file states nothing darker",
             in_quotes(mode_.channels[dimmer].name), 100 * min_share);
    }
  }

  std::optional<std::uint32_t> shut_value(const PersonalityChannel& channel) const {
    for (const ChannelFunction& f : channel.functions) {
      if (!is_active(f, held_.dmx)) continue;
      for (const std::uint32_t value : {f.dmx.middle(), f.dmx.from})
        if (shutter_state(f, value) == ShutterState::closed) return value;
    }
    return std::nullopt;
  }

  bool carry_emitters(const std::vector<std::size_t>& colours) {
    bool good = true;
    for (std::size_t e = 0; e < wanted_.owner->emitters.size(); ++e) {
      const std::string& emitter = wanted_.owner->emitters[e];
      bool found = false;
      for (const std::size_t c : colours) {
        const auto of = [&](const ChannelFunction& f) { return sets_emitter(f, emitter); };
        if (carried_[c] || !range_of(c, of)) continue;
        carry(c, of, e, emitter);
        found = true;
      }
      if (found) continue;
      std::vector<std::string_view> known;
      for (const std::size_t c : colours) {
        const auto* f = active_function(mode_.channels[c], held_.dmx, is_colour);
        const std::string_view name = emitter_of_attribute(f->attribute);
        if (std::find(known.begin(), known.end(), name) == known.end()) known.push_back(name);
      }
      static_cast<void>(refuse(
          fmt::format("has no emitter {}, which luminaire {} has", in_quotes(emitter),
                      in_quotes(wanted_.owner->luminaire)),
          mend_for_unknown(emitter, known, "it has no colours to mix: give the luminaire one flux, without emitters")));
      good = false;
    }
    return good;
  }

  double share_of(std::size_t c, std::uint32_t dmx) const {
    return static_cast<double>(dmx) / static_cast<double>(mode_.channels[c].max_dmx());
  }

  void hold_full(std::size_t c, const FunctionKind& of, const char* what) {
    const auto range = range_of(c, of);
    if (!range) return;
    held_.dmx[c] = range->full;
    tell("{} {} at {}", in_quotes(mode_.channels[c].name), what, held_.dmx[c]);
  }

  /// requires range_of(c, of)
  void carry(std::size_t c, const FunctionKind& of, std::optional<std::size_t> emitter, const std::string& what) {
    const LevelRange range = *range_of(c, of);
    DmxTravel travel{share_of(c, range.least), share_of(c, range.full), range.min_share, std::nullopt};
    if (range.dark) travel.at_dark = share_of(c, *range.dark);
    place(c, SlotUse::dimmer, emitter, travel);
    out_.steps |= range.steps;
    const PersonalityChannel& channel = mode_.channels[c];
    const bool whole = std::min(range.least, range.full) == 0 && std::max(range.least, range.full) == channel.max_dmx();
    tell("{} by {}, {} bit at slot {}{}", what, in_quotes(channel.name), 8 * channel.offsets.size(),
         channel.offsets.front() + 1,
         range.steps ? fmt::format(", off at {} and on at {}: it is switched", range.least, range.full)
         : whole && !range.dark
             ? ""
             : fmt::format(", {}{} to {}", range.dark ? fmt::format("dark at {}, then ", *range.dark) : "", range.least,
                           range.full));
    if (range.min_share > 0 && !range.dark) bright_at_0_.emplace_back(c, range.min_share);
    const ChannelFunction& f = *active_function(channel, held_.dmx, of);
    if (f.profile && is_dimmer(f)) {
      out_.dimmer_curve = curve_like(personality_.profiles[*f.profile]);
      if (!out_.dimmer_curve) tell("its dimmer follows no curve known here: state the nearest as dimmer_curve");
    }
  }

  /// `use` is the coarse one; those of the lower bytes follow it. A fourth byte is beyond the resolution here and stays
  /// 0.
  void place(std::size_t c, SlotUse use, std::optional<std::size_t> emitter, DmxTravel travel) {
    carried_[c] = true;
    const int cell = cells_++;
    for (std::size_t byte = 0; byte < mode_.channels[c].offsets.size(); ++byte) {
      NamedSlot& slot = at(mode_.channels[c].offsets[byte]);
      slot.slot = {byte < 3 ? static_cast<SlotUse>(static_cast<int>(use) + static_cast<int>(byte)) : SlotUse::constant,
                   0, true, cell, travel};
      slot.emitter = emitter;
    }
  }

  void hold(std::size_t c) {
    const std::vector<int>& offsets = mode_.channels[c].offsets;
    for (std::size_t byte = 0; byte < offsets.size(); ++byte)
      at(offsets[byte]).slot = {SlotUse::constant,
                                static_cast<int>(held_.dmx[c] >> (8 * (offsets.size() - 1 - byte)) & 0xFF)};
  }

  NamedSlot& at(int offset) { return out_.slots[static_cast<std::size_t>(offset)]; }

  bool carry_joints() {
    const auto pan = [](const ChannelFunction& f) { return f.attribute == "Pan"; };
    const auto tilt = [](const ChannelFunction& f) { return f.attribute == "Tilt"; };
    const std::vector<std::size_t> pans = channels_of(pan), tilts = channels_of(tilt);
    if (pans.empty() || tilts.empty()) {
      if (!pans.empty() || !tilts.empty()) tell("its {} alone is held at its default", pans.empty() ? "tilt" : "pan");
      return !wanted_.turned_elsewhere || carry_zoom();
    }
    if (!mode_.axes_problem.empty()) {
      static_cast<void>(refuse("cannot be aimed: " + mode_.axes_problem,
                               "choose another mode, correct the file's geometry, or write its slots by hand"));
      return false;
    }
    out_.moves = true;
    const bool pan_good =
        carry_axis(pans, pan, SlotUse::pan, "pan", mode_.pan_offset_deg, wanted_.pan_range_deg, wanted_.pan_in_file,
                   out_.range.pan_min_rad, out_.range.pan_max_rad, out_.pan_speed_rad_s);
    const bool tilt_good =
        carry_axis(tilts, tilt, SlotUse::tilt, "tilt", mode_.tilt_offset_deg, wanted_.tilt_range_deg,
                   wanted_.tilt_in_file, out_.range.tilt_min_rad, out_.range.tilt_max_rad, out_.tilt_speed_rad_s);
    return pan_good && tilt_good && carry_zoom();
  }

  /// Uses the overlap of the zoom ranges of the file and the luminaire.
  bool carry_zoom() {
    const auto zoom = [](const ChannelFunction& f) { return f.attribute == "Zoom"; };
    const std::vector<std::size_t> zooms = channels_of(zoom);
    if (zooms.empty() || !wanted_.zoom_deg) return true;
    std::pair<double, double> range_deg = *wanted_.zoom_deg;
    for (const std::size_t c : zooms) {
      const ChannelFunction& f = *active_function(mode_.channels[c], held_.dmx, zoom);
      if (!states_travel(f)) continue;
      range_deg.first = std::max(range_deg.first, std::min(f.physical_from, f.physical_to));
      range_deg.second = std::min(range_deg.second, std::max(f.physical_from, f.physical_to));
    }
    const double beam_deg = wanted_.beam_deg.value_or(range_deg.first);
    if (!(range_deg.first < range_deg.second) || beam_deg < range_deg.first - kSlack_deg ||
        beam_deg > range_deg.second + kSlack_deg) {
      problems_.add(wanted_.in_file,
                    fmt::format("mode {} has a zoom that does not make the beam angle of {:g}° of its luminaire",
                                in_quotes(mode_.name), beam_deg),
                    "correct beam_angle_deg and zoom_deg of the luminaire, or choose another mode");
      return false;
    }
    return carry_axis(zooms, zoom, SlotUse::zoom, "zoom", 0, range_deg, wanted_.in_file, out_.range.beam_min_rad,
                      out_.range.beam_max_rad, out_.zoom_speed_rad_s);
  }

  template <class Of>
  bool carry_axis(const std::vector<std::size_t>& channels, const Of& of, SlotUse use, const char* name,
                  double offset_deg, const std::optional<std::pair<double, double>>& wanted_deg,
                  const FilePosition& place_of_range, double& min_rad, double& max_rad, double& speed_rad_s) {
    std::optional<std::pair<double, double>> stated_deg;
    for (const std::size_t c : channels) {
      const ChannelFunction& f = *active_function(mode_.channels[c], held_.dmx, of);
      if (!states_travel(f)) continue;
      const double least = std::min(f.physical_from, f.physical_to) + offset_deg;
      const double most = std::max(f.physical_from, f.physical_to) + offset_deg;
      stated_deg = stated_deg ? std::pair(std::max(stated_deg->first, least), std::min(stated_deg->second, most))
                              : std::pair(least, most);
      if (f.real_fade_s > 0) speed_rad_s = rad_from_deg(most - least) / f.real_fade_s;
    }
    std::pair<double, double> range_deg =
        wanted_deg.value_or(stated_deg.value_or(std::pair(deg_from_rad(min_rad), deg_from_rad(max_rad))));
    if (stated_deg &&
        (range_deg.first < stated_deg->first - kSlack_deg || range_deg.second > stated_deg->second + kSlack_deg ||
         !(stated_deg->first < stated_deg->second))) {
      problems_.add(
          place_of_range,
          fmt::format("{}_range_deg {:g} to {:g} goes beyond the {:g} to {:g} of mode {}", name, range_deg.first,
                      range_deg.second, stated_deg->first, stated_deg->second, in_quotes(mode_.name)),
          "remove it: the maker's file states the travel; or narrow it");
      return false;
    }
    for (const std::size_t c : channels) {
      const ChannelFunction& f = *active_function(mode_.channels[c], held_.dmx, of);
      const bool falls = f.physical_to < f.physical_from;
      const double from_deg = states_travel(f) ? f.physical_from + offset_deg
                              : falls          ? range_deg.second
                                               : range_deg.first;
      const double to_deg = states_travel(f) ? f.physical_to + offset_deg : falls ? range_deg.first : range_deg.second;
      const auto dmx_share = [&](double angle_deg) {
        const double share = std::clamp((angle_deg - from_deg) / (to_deg - from_deg), 0.0, 1.0);
        return share_of(c, f.dmx.from) + share * (share_of(c, f.dmx.to) - share_of(c, f.dmx.from));
      };
      place(c, use, std::nullopt, {dmx_share(range_deg.first), dmx_share(range_deg.second)});
      tell("{} by {}, {} bit at slot {}, {:g} to {:g}°{}", name, in_quotes(mode_.channels[c].name),
           8 * mode_.channels[c].offsets.size(), mode_.channels[c].offsets.front() + 1, range_deg.first,
           range_deg.second, states_travel(f) ? "" : " (the file states no travel)");
    }
    min_rad = rad_from_deg(range_deg.first);
    max_rad = rad_from_deg(range_deg.second);
    return true;
  }

  template <class... Values>
  void tell(fmt::format_string<Values...> format, Values&&... values) {
    out_.told.push_back(fmt::format(format, std::forward<Values>(values)...));
  }

  const Personality& personality_;
  const PersonalityMode& mode_;
  const ModeWanted& wanted_;
  ProblemList& problems_;
  HeldValues held_;
  std::vector<bool> carried_ = std::vector<bool>(mode_.channels.size(), false), shuts_ = carried_;
  std::vector<std::pair<std::size_t, double>> bright_at_0_;  // channels that carry a level, with their least light
  int cells_ = 0;
  ModeSlots out_;
};

}  // namespace

std::optional<ModeSlots> slots_of_mode(const Personality& personality, const PersonalityMode& mode,
                                       const ModeWanted& wanted, ProblemList& problems) {
  return ModeFitter(personality, mode, wanted, problems).fit();
}

}  // namespace luxrig
