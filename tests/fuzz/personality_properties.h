#pragma once
// Properties of every accepted personality, whatever bytes it came from.
#include <cmath>
#include <set>

#include "core/check.h"
#include "core/rig/reading/mode_slots.h"
#include "core/text/plain_text.h"

namespace luxrig::fuzz {

inline void check_problems(const std::vector<Problem>& problems) {
  LUXRIG_CHECK(!problems.empty(), "refused without a problem");
  for (const Problem& problem : problems)
    LUXRIG_CHECK(!problem.what.empty() && !problem.mend.empty() && is_plain_text(problem.text()), "{}", problem.text());
}

inline void check_mode(const Personality& personality, const PersonalityMode& mode) {
  std::set<std::pair<int, int>> taken;
  for (const PersonalityChannel& channel : mode.channels) {
    LUXRIG_CHECK(channel.offsets.size() <= 4 && channel.geometry < mode.geometries.size(), "{}", channel.name);
    LUXRIG_CHECK(channel.default_dmx <= channel.max_dmx() && !channel.functions.empty(), "{}", channel.name);
    for (const int offset : channel.offsets) {
      LUXRIG_CHECK(offset >= 0 && offset < 512, "{}", offset);
      LUXRIG_CHECK(taken.emplace(channel.dmx_break, offset).second, "slot {} twice", offset);
    }
    for (const ChannelFunction& function : channel.functions) {
      LUXRIG_CHECK(function.dmx.from <= function.dmx.to && function.dmx.to <= channel.max_dmx(), "{}", function.name);
      LUXRIG_CHECK(std::isfinite(function.physical_from) && std::isfinite(function.physical_to), "{}", function.name);
      LUXRIG_CHECK(!function.profile || *function.profile < personality.profiles.size(), "{}", function.name);
      LUXRIG_CHECK(!function.when || function.when->channel < mode.channels.size(), "{}", function.name);
    }
  }
  // Also with a zoom in use: alone, and with pan and tilt by drives on another bus.
  for (const int i : {0, 1, 2, 3}) {
    const std::vector<std::string> emitters =
        i % 2 == 0 ? std::vector<std::string>{} : std::vector<std::string>{"red", "white"};
    ProblemList problems("fuzz");
    ModeWanted wanted;
    wanted.owner = SlotOwner{"lamp", emitters};
    wanted.beam_deg = 20;
    if (i > 0) wanted.zoom_deg = {10, 50};
    wanted.turned_elsewhere = i > 1;
    const auto slots = slots_of_mode(personality, mode, wanted, problems);
    if (!slots) {
      check_problems(problems.take());
      continue;
    }
    LUXRIG_CHECK(static_cast<int>(slots->slots.size()) == mode.footprint(), "{} slots", slots->slots.size());
    for (const NamedSlot& slot : slots->slots) {
      LUXRIG_CHECK(slot.slot.constant_dmx >= 0 && slot.slot.constant_dmx <= 255, "{}", slot.slot.constant_dmx);
      LUXRIG_CHECK(slot.slot.travel.at_start >= 0 && slot.slot.travel.at_start <= 1 && slot.slot.travel.at_end >= 0 &&
                       slot.slot.travel.at_end <= 1,
                   "{} to {}", slot.slot.travel.at_start, slot.slot.travel.at_end);
      for (const double level : {0.0, 1e-9, 0.3, 1.0})
        LUXRIG_CHECK(slot.slot.travel.at(level) >= 0 && slot.slot.travel.at(level) <= 1, "{} at level {}",
                     slot.slot.travel.at(level), level);
    }
    for (const std::string& line : slots->told) LUXRIG_CHECK(is_plain_text(line), "{}", line);
  }
}

inline void check_personality(const Checked<Personality>& personality) {
  if (!personality) return check_problems(personality.error());
  LUXRIG_CHECK(is_plain_text(personality->name) && !personality->modes.empty(), "{}", personality->name);
  for (const PersonalityMode& mode : personality->modes) check_mode(*personality, mode);
}

}  // namespace luxrig::fuzz
