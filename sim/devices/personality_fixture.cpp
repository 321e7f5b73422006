#include "sim/devices/personality_fixture.h"

#include <algorithm>
#include <cmath>

#include "core/rig/personality/dimmer_choice.h"

namespace luxrig::sim {
namespace {

bool of_shutter(const ChannelFunction& f) { return f.attribute.starts_with("Shutter"); }

class FixtureFirmware {
 public:
  /// `dimmer`: names the one that dims plain light, if several act on one part and the file does not say.
  FixtureFirmware(const PersonalityMode& mode, const std::string& dimmer, const DmxPatch& patch,
                  std::span<const std::uint8_t, kDmxSlots> slots)
      : mode_(mode) {
    for (const PersonalityChannel& channel : mode.channels) {
      std::uint32_t value = channel.is_virtual() ? channel.default_dmx : 0;
      for (const int offset : channel.offsets) {
        const auto index = static_cast<std::size_t>(patch.address - 1 + offset);
        value = value << 8 | (index < slots.size() ? slots[index] : 0u);
      }
      values_.push_back(value);
    }
    const auto named = std::find_if(mode.channels.begin(), mode.channels.end(), [&](const PersonalityChannel& channel) {
      return !channel.is_virtual() && channel.name == dimmer;
    });
    for (const PersonalityChannel& channel : mode.channels) {
      const bool other = !dimmer.empty() && named != mode.channels.end() && channel.name != dimmer &&
                         channel.geometry == named->geometry;
      dims_.push_back(!channel.is_virtual() && (channel.name == dimmer || (!other && dims_light(channel, values_))));
    }
  }

  double light(const std::string& emitter) const {
    if (!lamp_burns()) return 0;
    const std::vector<std::size_t> sources = sources_of(emitter);
    double sum = 0;
    for (const std::size_t c : sources) sum += light_of(c);
    return sources.empty() ? 0 : sum / static_cast<double>(sources.size());
  }

  /// Physical angle of the attribute's first channel, in the rig file's convention.
  std::optional<double> angle_rad(std::string_view attribute, double offset_deg, double min_rad, double max_rad) const {
    for (std::size_t c = 0; c < mode_.channels.size(); ++c) {
      if (mode_.channels[c].is_virtual()) continue;
      const ChannelFunction* f = at_work(c);
      if (f == nullptr || f->attribute != attribute) continue;
      // A file without stated travel has 0 to 1. Then the rig file's travel applies.
      const bool stated = std::abs(f->physical_to - f->physical_from) > 1.5;
      const double angle = stated ? rad_from_deg(f->physical_at(values_[c]) + offset_deg)
                                  : min_rad + (max_rad - min_rad) * share_in(*f, values_[c]);
      return std::clamp(angle, min_rad, max_rad);
    }
    return std::nullopt;
  }

 private:
  static double share_in(const ChannelFunction& f, std::uint32_t value) {
    return f.dmx.to == f.dmx.from ? 0 : (value - f.dmx.from) / static_cast<double>(f.dmx.to - f.dmx.from);
  }

  bool exists(const ChannelFunction& f) const { return !f.when || f.when->dmx.contains(values_[f.when->channel]); }

  /// The function that the channel's value selects.
  const ChannelFunction* at_work(std::size_t c) const {
    for (const ChannelFunction& f : mode_.channels[c].functions)
      if (exists(f) && f.dmx.contains(values_[c])) return &f;
    return nullptr;
  }

  template <class Of>
  bool can(std::size_t c, const Of& of) const {
    const auto& functions = mode_.channels[c].functions;
    return std::any_of(functions.begin(), functions.end(),
                       [&](const ChannelFunction& f) { return exists(f) && of(f); });
  }

  /// A lamp with its own strike channel burns while that channel says so. If that channel is also its shutter or
  /// dimmer, the lamp counts as already struck.
  bool lamp_burns() const {
    for (std::size_t c = 0; c < mode_.channels.size(); ++c) {
      if (mode_.channels[c].is_virtual() || can(c, of_shutter) || dims_[c]) continue;
      const bool strikes = can(c, [](const ChannelFunction& f) {
        if (f.sets.empty()) return strikes_lamp(f, f.dmx.from);
        return std::any_of(f.sets.begin(), f.sets.end(),
                           [&](const ChannelSet& s) { return strikes_lamp(f, s.dmx.from); });
      });
      const ChannelFunction* now = at_work(c);
      if (strikes && (now == nullptr || !strikes_lamp(*now, values_[c]))) return false;
    }
    return true;
  }

  std::vector<std::size_t> sources_of(const std::string& emitter) const {
    std::vector<std::size_t> of_colour, dimmers;
    for (std::size_t c = 0; c < mode_.channels.size(); ++c) {
      if (mode_.channels[c].is_virtual()) continue;
      const auto wanted = [&](const ChannelFunction& f) {
        return emitter.empty() ? is_colour(f) : sets_emitter(f, emitter);
      };
      if (can(c, wanted)) of_colour.push_back(c);
      if (dims_[c]) dimmers.push_back(c);
    }
    if (!of_colour.empty() || !emitter.empty()) return of_colour;
    std::vector<std::size_t> lowest;  // dimmers without another dimmer on a geometry below theirs
    for (const std::size_t c : dimmers) {
      if (std::none_of(dimmers.begin(), dimmers.end(), [&](std::size_t other) { return is_within(other, c); }))
        lowest.push_back(c);
    }
    return lowest;
  }

  bool is_within(std::size_t inner, std::size_t outer) const {
    const std::size_t wanted = mode_.channels[outer].geometry;
    for (auto at = mode_.geometries[mode_.channels[inner].geometry].parent; at; at = mode_.geometries[*at].parent)
      if (*at == wanted) return true;
    return false;
  }

  /// 0…1 of a dimmer or a colour. On a channel with shutter functions, open is 1 and other states 0.
  double level(std::size_t c) const {
    const ChannelFunction* f = at_work(c);
    if (f == nullptr) return 0;
    if (const auto state = shutter_state(*f, values_[c])) return *state == ShutterState::open ? 1 : 0;
    if (!is_dimmer(*f) && !is_colour(*f)) return 0;
    double most = 1e-9;  // of the channel's brightest value
    for (const ChannelFunction& other : mode_.channels[c].functions)
      if (exists(other) && other.attribute == f->attribute)
        most = std::max({most, std::abs(other.physical_from), std::abs(other.physical_to)});
    return std::clamp(f->physical_at(values_[c]) / most, 0.0, 1.0);
  }

  double light_of(std::size_t source) const {
    double light = level(source);
    for (std::size_t c = 0; c < mode_.channels.size(); ++c) {
      if (c == source || mode_.channels[c].is_virtual()) continue;
      if (!mode_.share_a_branch(mode_.channels[c].geometry, mode_.channels[source].geometry)) continue;
      if (dims_[c]) {
        light *= level(c);
      } else if (can(c, of_shutter)) {
        const ChannelFunction* f = at_work(c);
        const auto state = f == nullptr ? std::nullopt : shutter_state(*f, values_[c]);
        const bool idle = f != nullptr && f->attribute == "NoFeature";  // no strobe
        if (!idle && state != ShutterState::open) light = 0;
      }
    }
    return light;
  }

  const PersonalityMode& mode_;
  std::vector<std::uint32_t> values_;
  std::vector<bool> dims_;  // by channel: dims plain light
};

}  // namespace

DmxOrder decode_personality(const Fixture& fixture, const DmxPatch& patch,
                            std::span<const std::uint8_t, kDmxSlots> slots) {
  const PersonalityMode& mode = fixture.mode->personality->modes[fixture.mode->mode];
  const FixtureFirmware firmware(mode, fixture.mode->dimmer, patch, slots);
  DmxOrder order;
  order.drive = firmware.light(fixture.mode->emitter);
  const auto beam = fixture.range.zooms()
                        ? firmware.angle_rad("Zoom", 0, fixture.range.beam_min_rad, fixture.range.beam_max_rad)
                        : std::nullopt;
  if (fixture.axes) order.beam_rad = beam;
  if (!fixture.moves || fixture.axes) return order;
  const auto pan = firmware.angle_rad("Pan", mode.pan_offset_deg, fixture.range.pan_min_rad, fixture.range.pan_max_rad);
  const auto tilt =
      firmware.angle_rad("Tilt", mode.tilt_offset_deg, fixture.range.tilt_min_rad, fixture.range.tilt_max_rad);
  if (!pan || !tilt) return order;
  order.joints = Joints{*pan, *tilt, beam.value_or(fixture.joints.beam_rad)};
  return order;
}

}  // namespace luxrig::sim
