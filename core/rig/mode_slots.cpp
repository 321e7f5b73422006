#include "core/rig/mode_slots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rig/nearest.h"
#include "core/rig/personality/held_values.h"

namespace luxrig {
namespace {

constexpr double kSlack_deg = 1e-6;

bool is_dimmer(const ChannelFunction& function) { return attribute_stem(function.attribute) == "Dimmer"; }
bool is_colour(const ChannelFunction& function) { return !emitter_of_attribute(function.attribute).empty(); }

/// Placeholders: files without a travel say 0 to 1.
bool states_travel(const ChannelFunction& function) {
  return std::abs(function.physical_to - function.physical_from) > 1.5;
}

/// Which of the named curves a profile is, within 5 % of the rated flux.
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

/// Whether its zoom is one more joint of a head.
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
    out_.slots.assign(static_cast<std::size_t>(mode_.footprint()),
                      NamedSlot{{SlotUse::unused, 0}, std::nullopt, wanted_.place});
    if (!carry_light() || !carry_joints()) return std::nullopt;
    for (std::size_t c = 0; c < mode_.channels.size(); ++c)
      if (!carried_[c]) hold(c);
    out_.told.insert(out_.told.end(), held_.told.begin(), held_.told.end());
    return std::move(out_);
  }

 private:
  std::optional<ModeSlots> refuse(const std::string& what, std::string mend) {
    problems_.add(wanted_.place, fmt::format("mode {} {}", in_quotes(mode_.name), what), std::move(mend));
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
    const std::vector<std::size_t> dimmers = channels_of(is_dimmer), colours = channels_of(is_colour);
    const bool by_emitter = wanted_.owner && !wanted_.owner->emitters.empty();
    if (by_emitter && !carry_emitters(colours)) return false;
    if (by_emitter) {
      for (const std::size_t c : dimmers) hold_full(c, is_dimmer, "full");
      for (const std::size_t c : colours) {
        if (carried_[c]) continue;
        held_.dmx[c] = end_of(c, is_colour, false);
        tell("{} dark, which its luminaire does not have", in_quotes(mode_.channels[c].name));
      }
      return true;
    }
    const std::vector<std::size_t> top = topmost(dimmers);
    for (const std::size_t c : top) carry(c, is_dimmer, SlotUse::dimmer, std::nullopt, "dimmer");
    for (const std::size_t c : dimmers)
      if (!carried_[c]) hold_full(c, is_dimmer, "full");
    for (const std::size_t c : colours) {
      if (carried_[c]) continue;
      if (dimmers.empty()) {
        carry(c, is_colour, SlotUse::dimmer, std::nullopt, "its level");
      } else {
        hold_full(c, is_colour, "full");
      }
    }
    if (!dimmers.empty() || !colours.empty() || !wanted_.owner) return true;
    static_cast<void>(refuse("has no dimmer", "choose another mode: every fixture is set by its level"));
    return false;
  }

  bool carry_emitters(const std::vector<std::size_t>& colours) {
    bool good = true;
    for (std::size_t e = 0; e < wanted_.owner->emitters.size(); ++e) {
      const std::string& emitter = wanted_.owner->emitters[e];
      bool found = false;
      for (const std::size_t c : colours) {
        const auto of = [&](const ChannelFunction& f) { return sets_emitter(f, emitter); };
        if (carried_[c] || !active_function(mode_.channels[c], held_.dmx, of)) continue;
        carry(c, of, SlotUse::dimmer, e, emitter);
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

  /// Dimmers that no other dims: of two in one branch the higher, of two in one place the first.
  std::vector<std::size_t> topmost(const std::vector<std::size_t>& dimmers) const {
    std::vector<std::size_t> top;
    for (std::size_t i = 0; i < dimmers.size(); ++i) {
      const std::size_t own = mode_.channels[dimmers[i]].geometry;
      bool dimmed = false;
      for (std::size_t j = 0; j < dimmers.size(); ++j) {
        const std::size_t other = mode_.channels[dimmers[j]].geometry;
        if (i == j || !mode_.share_a_branch(own, other)) continue;
        dimmed |= own == other ? j < i : is_above(other, own);
      }
      if (!dimmed) top.push_back(dimmers[i]);
    }
    return top;
  }

  bool is_above(std::size_t outer, std::size_t inner) const {
    for (std::optional<std::size_t> at = inner; at; at = mode_.geometries[*at].parent)
      if (*at == outer) return true;
    return false;
  }

  double share_of(std::size_t c, std::uint32_t dmx) const {
    return static_cast<double>(dmx) / static_cast<double>(mode_.channels[c].max_dmx());
  }

  /// Where a level is highest, or lowest.
  template <class Of>
  std::uint32_t end_of(std::size_t c, const Of& of, bool full) const {
    const ChannelFunction* f = active_function(mode_.channels[c], held_.dmx, of);
    return (f->physical_to >= f->physical_from) == full ? f->dmx.to : f->dmx.from;
  }

  template <class Of>
  void hold_full(std::size_t c, const Of& of, const char* what) {
    held_.dmx[c] = end_of(c, of, true);
    tell("{} {} at {}", in_quotes(mode_.channels[c].name), what, held_.dmx[c]);
  }

  template <class Of>
  void carry(std::size_t c, const Of& of, SlotUse use, std::optional<std::size_t> emitter, const std::string& what) {
    const ChannelFunction& f = *active_function(mode_.channels[c], held_.dmx, of);
    place(c, use, emitter, {share_of(c, end_of(c, of, false)), share_of(c, end_of(c, of, true))});
    tell("{} by {}, {} bit at slot {}", what, in_quotes(mode_.channels[c].name), 8 * mode_.channels[c].offsets.size(),
         mode_.channels[c].offsets.front() + 1);
    if (f.profile && is_dimmer(f)) {
      out_.dimmer_curve = curve_like(personality_.profiles[*f.profile]);
      if (!out_.dimmer_curve) tell("its dimmer follows no curve known here: state the nearest as dimmer_curve");
    }
  }

  /// `use` is the coarse one; those of the bytes below follow it. A fourth byte, which nothing here resolves, stays 0.
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
        carry_axis(pans, pan, SlotUse::pan, "pan", mode_.pan_offset_deg, wanted_.pan_range_deg, wanted_.pan_place,
                   out_.range.pan_min_rad, out_.range.pan_max_rad, out_.pan_speed_rad_s);
    const bool tilt_good =
        carry_axis(tilts, tilt, SlotUse::tilt, "tilt", mode_.tilt_offset_deg, wanted_.tilt_range_deg,
                   wanted_.tilt_place, out_.range.tilt_min_rad, out_.range.tilt_max_rad, out_.tilt_speed_rad_s);
    return pan_good && tilt_good && carry_zoom();
  }

  /// Through what both the file and the luminaire say that it goes through.
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
      problems_.add(wanted_.place,
                    fmt::format("mode {} has a zoom that does not make the beam angle of {:g}° of its luminaire",
                                in_quotes(mode_.name), beam_deg),
                    "correct beam_angle_deg and zoom_deg of the luminaire, or choose another mode");
      return false;
    }
    return carry_axis(zooms, zoom, SlotUse::zoom, "zoom", 0, range_deg, wanted_.place, out_.range.beam_min_rad,
                      out_.range.beam_max_rad, out_.zoom_speed_rad_s);
  }

  template <class Of>
  bool carry_axis(const std::vector<std::size_t>& channels, const Of& of, SlotUse use, const char* name,
                  double offset_deg, const std::optional<std::pair<double, double>>& wanted_deg,
                  const Place& place_of_range, double& min_rad, double& max_rad, double& speed_rad_s) {
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
      const double from_deg = states_travel(f) ? f.physical_from + offset_deg : range_deg.first;
      const double to_deg = states_travel(f) ? f.physical_to + offset_deg : range_deg.second;
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
  std::vector<bool> carried_ = std::vector<bool>(mode_.channels.size(), false);
  int cells_ = 0;
  ModeSlots out_;
};

}  // namespace

std::optional<ModeSlots> slots_of_mode(const Personality& personality, const PersonalityMode& mode,
                                       const ModeWanted& wanted, ProblemList& problems) {
  return ModeFitter(personality, mode, wanted, problems).fit();
}

}  // namespace luxrig
