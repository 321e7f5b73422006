// Output of a level, against the makers' files: full level is the brightest that a file describes, level 0 is dark, and
// channels without a choice stay at their stated default. The test reads the files itself, by the few relevant words of
// their format, so that an error of the reader cannot pass.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/rig/personality/personality_file.h"
#include "core/rig/reading/mode_slots.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::filesystem::path> fixture_folders() {
  std::vector<std::filesystem::path> folders{test::source_folder() / "tests/data/fixtures"};
  // A copy of the Open Fixture Library, or any folder of such files, to run over all of it.
  if (const char* more = std::getenv("LUXRIG_FIXTURE_LIBRARY")) folders.emplace_back(more);
  return folders;
}

std::vector<std::filesystem::path> files_of(const char* extension) {
  std::vector<std::filesystem::path> files;
  for (const auto& folder : fixture_folders())
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
      if (entry.path().extension() == extension) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// DMX value of a channel of the mode at a level, in the channel's own bytes.
std::uint32_t sent(const ModeSlots& slots, const PersonalityChannel& channel, double level) {
  const DmxSlot& first = slots.slots[static_cast<std::size_t>(channel.offsets.front())].slot;
  if (first.use == SlotUse::dimmer)
    return static_cast<std::uint32_t>(std::llround(first.travel.at(level) * channel.max_dmx()));
  std::uint32_t value = 0;
  for (const int offset : channel.offsets)
    value = value << 8 | static_cast<std::uint32_t>(slots.slots[static_cast<std::size_t>(offset)].slot.constant_dmx);
  return value;
}

bool is_carried(const ModeSlots& slots, const PersonalityChannel& channel) {
  return slots.slots[static_cast<std::size_t>(channel.offsets.front())].slot.use == SlotUse::dimmer;
}
bool turns(const ModeSlots& slots, const PersonalityChannel& channel) {
  const SlotUse use = slots.slots[static_cast<std::size_t>(channel.offsets.front())].slot.use;
  return use != SlotUse::dimmer && use != SlotUse::constant;
}

bool told_of(const ModeSlots& slots, const std::string& text) {
  return std::any_of(slots.told.begin(), slots.told.end(),
                     [&](const std::string& line) { return line.find(text) != std::string::npos; });
}

/// A channel of an OFL file, from its JSON.
class OflChannel {
 public:
  OflChannel(const Json& fixture, const std::string& name) {
    const Json plain = fixture.value("availableChannels", Json::object());
    if (plain.contains(name)) json_ = plain.at(name);
    const Json templates = fixture.value("templateChannels", Json::object());
    for (const auto& [key, channel] : templates.items()) {
      const auto at = key.find("$pixelKey");
      if (!json_.is_null() || at == std::string::npos) continue;
      const std::string before = key.substr(0, at), after = key.substr(at + 9);
      if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) continue;
      const std::string pixel = name.substr(before.size(), name.size() - before.size() - after.size());
      const bool counted =
          fixture.at("matrix").contains("pixelCount") && pixel.find_first_not_of("0123456789(), ") == std::string::npos;
      if (counted || fixture.at("matrix").dump().find("\"" + pixel + "\"") != std::string::npos) json_ = channel;
    }
    if (json_.is_null()) return;
    bytes_ = 1 + static_cast<int>(json_.value("fineChannelAliases", Json::array()).size());
    const std::string stated = json_.value("dmxValueResolution", "");
    if (!stated.empty()) bytes_ = std::stoi(stated) / 8;
  }

  /// The capability at a value of this many bytes.
  Json at(std::uint32_t value, int bytes) const {
    if (json_.contains("capability")) return json_.at("capability");
    const double scaled = std::floor(value * std::pow(256.0, bytes_ - bytes));
    for (const Json& capability : capabilities())
      if (scaled >= capability.at("dmxRange")[0] && scaled <= capability.at("dmxRange")[1]) return capability;
    return Json();
  }

  /// Share of light that the channel gives or passes; empty if it does not affect brightness.
  std::optional<double> light(std::uint32_t value, int bytes) const {
    const Json capability = at(value, bytes);
    if (capability.is_null()) return std::nullopt;
    const std::string type = capability.at("type");
    if (type == "ShutterStrobe") {
      const std::string effect = capability.at("shutterEffect");
      return effect == "Open" ? std::optional(1.0) : effect == "Closed" ? std::optional(0.0) : std::nullopt;
    }
    if (type == "NoFunction") return 1;
    if (type != "Intensity" && type != "ColorIntensity") return std::nullopt;
    const auto [from, to] = brightness(capability);
    double share = value / (std::pow(256.0, bytes) - 1);
    if (capability.contains("dmxRange")) {
      const double low = capability.at("dmxRange")[0], high = capability.at("dmxRange")[1];
      const double scaled = std::floor(value * std::pow(256.0, bytes_ - bytes));
      share = high > low ? (scaled - low) / (high - low) : 0;
    }
    return from + share * (to - from);
  }

  static std::pair<double, double> brightness(const Json& capability) {
    const auto read = [&](const char* key, double otherwise) {
      if (!capability.contains(key)) return otherwise;
      const std::string text = capability.at(key);
      return text == "off" ? 0 : text == "dark" ? 0.01 : text == "bright" ? 1 : std::stod(text) / 100;
    };
    const double one = read("brightness", -1);
    return one >= 0 ? std::pair(one, one) : std::pair(read("brightnessStart", 0), read("brightnessEnd", 1));
  }

  double brightest() const {
    double most = 0;
    for (const Json& capability : capabilities())
      if (is_light(capability)) most = std::max({most, brightness(capability).first, brightness(capability).second});
    return most;
  }
  bool is_of(const char* type) const {
    for (const Json& capability : capabilities())
      if (capability.at("type") == type) return true;
    return false;
  }
  bool can_pass_light() const {
    for (const Json& capability : capabilities()) {
      if (capability.at("type") == "NoFunction" || is_light(capability)) return true;
      if (capability.at("type") == "ShutterStrobe" && capability.at("shutterEffect") == "Open") return true;
    }
    return false;
  }
  bool follows_level_of_light() const { return is_of("Intensity") || is_of("ColorIntensity"); }
  std::uint32_t default_of(int bytes) const {
    const Json stated = json_.value("defaultValue", Json(0));
    if (stated.is_string())
      return static_cast<std::uint32_t>(
          std::floor(std::stod(stated.get<std::string>()) / 100 * (std::pow(256.0, bytes) - 1)));
    return static_cast<std::uint32_t>(std::floor(stated.get<double>() * std::pow(256.0, bytes - bytes_)));
  }

 private:
  static bool is_light(const Json& capability) {
    return capability.at("type") == "Intensity" || capability.at("type") == "ColorIntensity";
  }
  std::vector<Json> capabilities() const {
    if (json_.contains("capability")) return std::vector<Json>(1, json_.at("capability"));
    return json_.contains("capabilities") ? json_.at("capabilities").get<std::vector<Json>>() : std::vector<Json>{};
  }
  Json json_;
  int bytes_ = 1;
};

void check_ofl_mode(const Json& fixture, const Personality& personality, const PersonalityMode& mode,
                    const ModeSlots& slots) {
  bool dark = false, lit = false;
  for (const PersonalityChannel& channel : mode.channels) {
    const OflChannel stated(fixture, channel.name);
    const int bytes = static_cast<int>(channel.offsets.size());
    const std::uint32_t full = sent(slots, channel, 1), none = sent(slots, channel, 0);
    const std::string where =
        fmt::format("{}/{}, mode {}: {} sends {} at full level and {} at level 0", personality.manufacturer,
                    personality.name, mode.name, channel.name, full, none);
    if (turns(slots, channel)) continue;
    const bool named = told_of(slots, "\"" + channel.name + "\"");
    if (is_carried(slots, channel)) {
      lit = true;
      if (stated.follows_level_of_light()) {
        EXPECT_NEAR(stated.light(full, bytes).value_or(-1), stated.brightest(), 0.011) << where;
      } else {
        EXPECT_EQ(stated.light(full, bytes), 1) << where;
      }
      EXPECT_TRUE(stated.light(none, bytes).value_or(-1) == 0 || told_of(slots, "of its light at level 0")) << where;
      dark |= stated.light(none, bytes) == 0;
    } else {
      EXPECT_EQ(full, none) << where;
      if (!named) {
        EXPECT_EQ(full, stated.default_of(bytes)) << where;
      }
    }
    if (stated.is_of("ShutterStrobe") && stated.can_pass_light()) {
      EXPECT_GT(stated.light(full, bytes).value_or(-1), 0.9) << where << ": no light passes";
    }
  }
  if (!lit) return;  // the reader reports that there is nothing to dim
  EXPECT_TRUE(dark || told_of(slots, "of its light at level 0")) << personality.name << ", " << mode.name;
}

TEST(LightOfFiles, FullLevelIsTheBrightestOfAnOflFileAndLevel0IsDark) {
  std::size_t fitted = 0, refused = 0;
  for (const auto& file : files_of(".json")) {
    const Checked<Personality> personality = load_personality(file);
    if (!personality) continue;
    const Json fixture = Json::parse(std::ifstream(file));
    for (const PersonalityMode& mode : personality->modes) {
      ProblemList problems(file.string());
      ModeWanted wanted;
      wanted.owner = SlotOwner{"lamp", {}};
      wanted.beam_deg = 20;
      const auto slots = slots_of_mode(*personality, mode, wanted, problems);
      if (!slots) {
        const std::vector<Problem> found = problems.take();
        ASSERT_FALSE(found.empty()) << file;
        EXPECT_NE(found[0].what.find(mode.name), std::string::npos) << found[0].text();
        ++refused;
        continue;
      }
      ++fitted;
      check_ofl_mode(fixture, *personality, mode, *slots);
    }
  }
  RecordProperty("fitted", static_cast<int>(fitted));
  RecordProperty("refused", static_cast<int>(refused));
  EXPECT_GE(fitted, 30u);
  EXPECT_LE(refused * 4, fitted) << "most modes have one dimmer, and no doubt about it";
}

TEST(LightOfFiles, FullLevelIsTheBrightestOfAGdtfFileAndLevel0IsDark) {
  std::size_t fitted = 0;
  for (const auto& file : files_of(".gdtf")) {
    const Checked<Personality> personality = load_personality(file);
    if (!personality) continue;
    for (const PersonalityMode& mode : personality->modes) {
      ProblemList problems(file.string());
      ModeWanted wanted;
      wanted.owner = SlotOwner{"lamp", {}};
      const auto slots = slots_of_mode(*personality, mode, wanted, problems);
      if (!slots) continue;
      ++fitted;
      for (const PersonalityChannel& channel : mode.channels) {
        if (channel.is_virtual() || turns(*slots, channel)) continue;
        const std::uint32_t full = sent(*slots, channel, 1), none = sent(*slots, channel, 0);
        const std::string where =
            fmt::format("{} mode {}: {} at {} and {}", personality->name, mode.name, channel.name, full, none);
        const auto light = [&](std::uint32_t value, bool most) {
          std::optional<double> found;
          for (const ChannelFunction& f : channel.functions) {
            const bool is_light =
                f.attribute == "Dimmer" || f.attribute.starts_with("ColorAdd") || f.attribute.starts_with("ColorRGB");
            if (!is_light) continue;
            if (most) found = std::max({found.value_or(0), f.physical_from, f.physical_to});
            if (!most && f.dmx.contains(value)) found = f.physical_at(value);
          }
          return found;
        };
        if (is_carried(*slots, channel)) {
          EXPECT_EQ(light(full, false), light(full, true)) << where;
          EXPECT_EQ(light(none, false), 0) << where;
        } else if (!told_of(*slots, "\"" + channel.name + "\"")) {
          EXPECT_EQ(full, channel.default_dmx) << where;
        }
      }
    }
  }
  EXPECT_GE(fitted, 10u);
}

}  // namespace
}  // namespace luxrig
