#include <fmt/format.h>

#include <algorithm>

#include "core/photometry/beam.h"
#include "core/rig/personality/personality_file.h"
#include "core/rig/reading/dmx_slots.h"
#include "core/rig/reading/mode_slots.h"
#include "core/rig/reading/rig_reader.h"
#include "core/text/nearest.h"

namespace luxrig {
namespace {

/// Full angle to set the zoom to so that the light is as the luminaire states.
std::optional<double> zoom_deg_of(const Luminaire& luminaire) {
  if (luminaire.model == LuminaireModel::spot) return deg_from_rad(luminaire.beam_angle_rad);
  if (luminaire.model != LuminaireModel::ies || !luminaire.intensity) return std::nullopt;
  const PlaneAngles angles = beam_angles(*luminaire.intensity);
  return deg_from_rad(std::max(angles.c0_rad, angles.c90_rad));
}

std::string listed(const std::vector<PersonalityMode>& modes) {
  std::string text;
  for (std::size_t i = 0; i < modes.size() && i < 12; ++i) text += (i ? ", " : "") + in_quotes(modes[i].name);
  return text + (modes.size() > 12 ? fmt::format(" and {} more", modes.size() - 12) : "");
}

}  // namespace

std::shared_ptr<const Personality> RigReader::personality_at(const std::filesystem::path& path) {
  const auto known = personalities.find(path.string());
  if (known != personalities.end()) return known->second;
  Checked<Personality> personality = load_personality(path);
  if (!personality) return nullptr;
  for (const std::string& note : personality->notes)
    rig.notes.push_back({path.string(), 0, 0, note, "check it where this channel matters"});
  return personalities.emplace(path.string(), std::make_shared<const Personality>(std::move(*personality)))
      .first->second;
}

std::shared_ptr<const Personality> RigReader::read_personality(Section& s) {
  const auto path = read_file(s, "personality");
  if (!path || personalities.contains(path->string())) return path ? personalities.at(path->string()) : nullptr;
  std::shared_ptr<const Personality> good = personality_at(*path);
  if (!good) {
    problems.add(s.place_of("personality"), fmt::format("{} cannot be used", in_quotes(path->filename().string())),
                 "mend what is listed for it, or use another file");
    const Checked<Personality> refused = load_personality(*path);
    if (!refused)
      for (const Problem& problem : refused.error()) problems.add(problem);
    personalities.emplace(path->string(), nullptr);
  }
  return good;
}

std::optional<std::size_t> RigReader::read_mode(Section& s, const Personality& personality) {
  if (!s.has("mode")) {
    if (personality.modes.size() == 1) return 0;
    problems.add(
        s.place_of("personality"),
        fmt::format("{} has {} modes, and none is chosen", in_quotes(personality.name), personality.modes.size()),
        fmt::format("add mode = with one of {}, as the fixture itself is set", listed(personality.modes)));
    return std::nullopt;
  }
  std::string name;
  if (!s.read("mode", name)) return std::nullopt;
  std::vector<std::string_view> known;
  for (std::size_t m = 0; m < personality.modes.size(); ++m) {
    if (personality.modes[m].name == name) return m;
    known.push_back(personality.modes[m].name);
  }
  problems.add(s.place_of("mode"),
               fmt::format("{} has no mode {}: it has {}", in_quotes(personality.name), in_quotes(name),
                           listed(personality.modes)),
               mend_for_unknown(name, known, "use one of those"));
  return std::nullopt;
}

std::optional<ModeSlots> RigReader::read_slots_of_mode(Section& s, const std::optional<SlotOwner>& owner,
                                                       Fixture& fixture) {
  s.refuse("slots", "slots has no effect: the personality says what each slot carries",
           "keep one of slots and personality");
  const std::shared_ptr<const Personality> personality = read_personality(s);
  if (!personality) return std::nullopt;
  const auto mode = read_mode(s, *personality);
  if (!mode) return std::nullopt;
  ModeWanted wanted;
  wanted.owner = owner;
  if (owner) {
    wanted.beam_deg = zoom_deg_of(rig.luminaires[fixture.luminaire]);
    if (const auto& zoom_rad = rig.luminaires[fixture.luminaire].zoom_beam_rad)
      wanted.zoom_deg = {deg_from_rad(zoom_rad->first), deg_from_rad(zoom_rad->second)};
  }
  wanted.turned_elsewhere = s.has("axes_bus");
  s.read("pan_range_deg", wanted.pan_range_deg);
  s.read("tilt_range_deg", wanted.tilt_range_deg);
  s.read("dimmer", wanted.dimmer);
  wanted.dimmer_in_file = s.place_of("dimmer");
  wanted.in_file = s.place_of(s.has("mode") ? "mode" : "personality");
  wanted.pan_in_file = s.place_of(s.has("pan_range_deg") ? "pan_range_deg" : "personality");
  wanted.tilt_in_file = s.place_of(s.has("tilt_range_deg") ? "tilt_range_deg" : "personality");
  std::optional<ModeSlots> slots = slots_of_mode(*personality, personality->modes[*mode], wanted, problems);
  if (slots) {
    std::string text;
    s.read("personality", text);
    if (const auto stated = stated_lights.find(fixture.luminaire); owner && stated != stated_lights.end())
      slots->told.insert(slots->told.begin(), stated->second.told.begin(), stated->second.told.end());
    if (owner) check_stated_light(s, fixture, personality->modes[*mode]);
    fixture.mode = FixtureMode{text, personality, *mode, {}, wanted.dimmer, slots->told};
  }
  return slots;
}

bool RigReader::read_dmx(Section& s, const std::optional<SlotOwner>& owner, bool planned, Fixture& fixture,
                         std::vector<NamedSlot>& named, std::optional<ModeSlots>& of_mode) {
  DmxPatch patch;
  s.read("universe", patch.universe);
  if (!s.has("address") && !planned) s.require("address", "which DMX needs");
  bool good = s.read("address", patch.address) || planned;
  if (s.has("personality")) {
    of_mode = read_slots_of_mode(s, owner, fixture);
    if (of_mode) named = of_mode->slots;
    good = good && of_mode.has_value();
  } else {
    for (const std::string key : {"mode", "dimmer"})
      s.refuse(key, key + " has no effect without a personality",
               "add personality, a GDTF or Open Fixture Library file");
    if (planned && owner && !owner->emitters.empty() && !s.has("slots"))
      for (std::size_t e = 0; e < owner->emitters.size(); ++e) named.push_back({DmxSlot{}, e, s.in_file()});
    else
      good &= read_slots(s, owner, named);
  }
  patch.slots = slots_of(named, named.empty() || !owner || owner->emitters.empty() ? std::nullopt : std::optional(0ul));
  const auto count = static_cast<int>(std::min<std::size_t>(patch.slots.size(), 10000));
  if (good && patch.address + count - 1 > 512) {
    s.problems().add(s.place_of("address"),
                     fmt::format("{} slots from address {} end at {}, past slot 512", count, patch.address,
                                 patch.address + count - 1),
                     count <= 512 ? fmt::format("use address {} or lower", 513 - count) : "a universe has 512 slots");
    good = false;
  }
  for (const DmxSlot& slot : patch.slots) fixture.moves |= slot.use == SlotUse::pan || slot.use == SlotUse::tilt;
  fixture.patch = std::move(patch);
  return good;
}

}  // namespace luxrig
