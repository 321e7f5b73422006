#include "core/rig/personality/ofl/ofl_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "core/rig/personality/ofl/ofl_capabilities.h"
#include "core/rig/personality/ofl/ofl_pixels.h"
#include "core/rig/personality/slot_overlap.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxOflBytes = std::size_t{4} << 20;
constexpr int kMaxOflDepth = 40;
constexpr std::size_t kMaxOflModes = 256, kMaxOflSlots = 512, kMaxOflTemplates = 500;

int depth_of_brackets(std::string_view text) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (quoted) {
      if (letter == '\\') ++i;
      quoted = letter != '"';
    } else if (letter == '"') {
      quoted = true;
    } else if (letter == '[' || letter == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (letter == ']' || letter == '}') {
      --depth;
    }
  }
  return deepest;
}

FilePosition place_in_text(std::string_view text, std::size_t byte) {
  FilePosition in_file{1, 1};
  for (std::size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
    ++in_file.column;
    if (text[i] == '\n') in_file = {in_file.line + 1, 1};
  }
  return in_file;
}

class OflReader {
 public:
  OflReader(const OflJson& json, ProblemList& problems)
      : json_(json),
        problems_(problems),
        fixture_{json, adds_colours(json)},
        matrix_(read_ofl_matrix(ofl_member(json, "matrix"))) {
    index_channels(ofl_member(json, "availableChannels"), "");
    index_switches();
  }

  Personality read(const std::string& manufacturer) {
    Personality out;
    out.manufacturer = made_plain(manufacturer);
    out.name = ofl_text(ofl_member(json_, "name"));
    if (matrix_.too_large) {
      problem(fmt::format("a matrix of more than {} pixels", kMaxPixels),
              "no such fixture is known; do not trust the file");
      return out;
    }
    if (ofl_member(json_, "templateChannels").size() > kMaxOflTemplates) {
      problem(fmt::format("more than {} template channels", kMaxOflTemplates), "do not trust the file");
      return out;
    }
    const OflJson& modes = ofl_member(json_, "modes");
    if (!modes.is_array() || modes.empty()) problem("the fixture has no modes", "add one, as the format asks");
    if (!modes.is_array()) return out;
    for (const OflJson& mode : modes) {
      if (out.modes.size() == kMaxOflModes) {
        problem(fmt::format("more than {} modes", kMaxOflModes), "do not trust the file");
        break;
      }
      if (problems_.full()) break;
      out.modes.push_back(read_mode(mode));
    }
    return out;
  }

 private:
  /// A channel by its name in modes: its definition, which of its bytes, and which pixel.
  struct Known {
    const OflJson* channel = nullptr;
    std::string coarse;  ///< name of its coarse byte
    std::size_t byte = 0;
    std::string pixel;
  };

  void problem(std::string what, std::string mend) { problems_.add(FilePosition{}, std::move(what), std::move(mend)); }

  static bool adds_colours(const OflJson& json) {
    for (const char* list : {"availableChannels", "templateChannels"}) {
      const OflJson& channels = ofl_member(json, list);
      if (!channels.is_object()) continue;
      for (const auto& [key, channel] : channels.items()) {
        for (const OflJson* capability : ofl_capabilities(channel)) {
          const std::string colour = ofl_text(ofl_member(*capability, "color"));
          if (ofl_text(ofl_member(*capability, "type")) == "ColorIntensity" && colour != "Cyan" &&
              colour != "Magenta" && colour != "Yellow")
            return true;
        }
      }
    }
    return false;
  }

  void index_channels(const OflJson& channels, const std::string& pixel) {
    if (!channels.is_object()) return;
    for (const auto& [key, channel] : channels.items())
      index_channel(with_pixel(made_plain(key), pixel), channel, pixel);
  }

  void index_channel(const std::string& coarse, const OflJson& channel, const std::string& pixel) {
    known_.try_emplace(coarse, Known{&channel, coarse, 0, pixel});
    std::size_t byte = 0;
    for (const std::string& alias : ofl_texts(ofl_member(channel, "fineChannelAliases"))) {
      if (++byte > 3) break;
      known_.try_emplace(with_pixel(alias, pixel), Known{&channel, coarse, byte, pixel});
    }
  }

  /// The default channel of each switching alias, from the default value of its trigger.
  void index_switches() {
    index_switches_of(ofl_member(json_, "availableChannels"));
    index_switches_of(ofl_member(json_, "templateChannels"));
  }

  void index_switches_of(const OflJson& channels) {
    if (!channels.is_object()) return;
    for (const auto& [key, channel] : channels.items()) {
      const int bytes = ofl_resolution(channel);
      const auto initial = ofl_dmx(ofl_member(channel, "defaultValue"), bytes, bytes).value_or(0);
      for (const OflJson* capability : ofl_capabilities(channel)) {
        const OflJson& switches = ofl_member(*capability, "switchChannels");
        const OflJson& range = ofl_member(*capability, "dmxRange");
        if (!switches.is_object()) continue;
        if (range.is_array() && range.size() == 2) {
          const auto from = ofl_dmx(range[0], bytes, bytes), to = ofl_dmx(range[1], bytes, bytes);
          if (!from || !to || initial < *from || initial > *to) continue;
        }
        for (const auto& [alias, target] : switches.items()) switches_.try_emplace(made_plain(alias), ofl_text(target));
      }
    }
  }

  const Known* find(const std::string& name) {
    const std::string wanted = switched(name);
    if (const auto at = known_.find(wanted); at != known_.end()) return &at->second;
    // A template channel, made for the pixel in its name. Only those used by modes are made.
    const OflJson& templates = ofl_member(json_, "templateChannels");
    if (!templates.is_object()) return nullptr;
    for (const auto& [key, channel] : templates.items()) {
      for (const std::string& pattern : patterns_of(key, channel)) {
        const std::string pixel = pixel_in(wanted, pattern);
        if (pixel.empty() || !matrix_.has(pixel)) continue;
        index_channel(with_pixel(made_plain(key), pixel), channel, pixel);
        if (const auto at = known_.find(wanted); at != known_.end()) return &at->second;
      }
    }
    return nullptr;
  }

  /// The default channel of a switching alias; any other name unchanged.
  std::string switched(const std::string& name) const {
    if (const auto alias = switches_.find(name); alias != switches_.end()) return alias->second;
    for (const auto& [alias, target] : switches_)
      if (const std::string pixel = pixel_in(name, alias); matrix_.has(pixel)) return with_pixel(target, pixel);
    return name;
  }

  static std::vector<std::string> patterns_of(const std::string& key, const OflJson& channel) {
    std::vector<std::string> patterns = ofl_texts(ofl_member(channel, "fineChannelAliases"));
    patterns.resize(std::min<std::size_t>(patterns.size(), 3));
    patterns.push_back(made_plain(key));
    return patterns;
  }

  /// The pixel that turns the pattern into the name, where it may occur several times; empty = the name does not fit.
  static std::string pixel_in(const std::string& name, const std::string& pattern) {
    constexpr std::string_view kKey = "$pixelKey";
    const auto first = pattern.find(kKey);
    std::size_t places = 0;
    for (auto at = first; at != std::string::npos; at = pattern.find(kKey, at + kKey.size())) ++places;
    const std::size_t around = pattern.size() - places * kKey.size();
    if (places == 0 || name.size() <= around || (name.size() - around) % places != 0) return {};
    std::string pixel = name.substr(first, (name.size() - around) / places);
    return with_pixel(pattern, pixel) == name ? pixel : std::string();
  }

  /// The names of a mode's slots; empty = unused.
  std::vector<std::string> slot_names(const OflJson& mode, const std::string& mode_name) {
    std::vector<std::string> names;
    const OflJson& channels = ofl_member(mode, "channels");
    if (!channels.is_array()) return names;
    for (const OflJson& entry : channels) {
      if (names.size() > kMaxOflSlots) break;
      if (!entry.is_object()) {
        names.push_back(ofl_text(entry));
        continue;
      }
      const std::string kind = ofl_text(ofl_member(entry, "insert"));
      if (kind != "matrixChannels") {
        problem(fmt::format("mode {}: an insert block {} is not known", in_quotes(mode_name), in_quotes(kind)),
                "this reads format 12, which has \"matrixChannels\"");
        return {};
      }
      insert_matrix(entry, names);
    }
    return names;
  }

  void insert_matrix(const OflJson& block, std::vector<std::string>& names) {
    const OflJson& repeat = ofl_member(block, "repeatFor");
    const std::vector<std::string> keys = repeat.is_array() ? ofl_texts(repeat) : matrix_.order(ofl_text(repeat));
    const std::vector<std::string> templates = ofl_texts(ofl_member(block, "templateChannels"));
    const bool per_pixel = ofl_text(ofl_member(block, "channelOrder")) == "perPixel";
    const std::size_t outer = per_pixel ? keys.size() : templates.size(),
                      inner = per_pixel ? templates.size() : keys.size();
    for (std::size_t i = 0; i < outer; ++i)
      for (std::size_t j = 0; j < inner && names.size() <= kMaxOflSlots; ++j)
        names.push_back(with_pixel(templates[per_pixel ? j : i], keys[per_pixel ? i : j]));
  }

  std::size_t geometry_of(PersonalityMode& mode, const std::string& pixel) const {
    if (pixel.empty() || std::find(matrix_.whole.begin(), matrix_.whole.end(), pixel) != matrix_.whole.end()) return 0;
    for (std::size_t i = 1; i < mode.geometries.size(); ++i)
      if (mode.geometries[i].name == pixel) return i;
    mode.geometries.push_back({pixel, 0, std::nullopt});
    return mode.geometries.size() - 1;
  }

  PersonalityMode read_mode(const OflJson& json) {
    PersonalityMode mode;
    mode.name = ofl_text(ofl_member(json, "name"));
    mode.geometries.push_back({"", std::nullopt, std::nullopt});
    std::map<std::string, std::map<std::size_t, int>> slots;  // by coarse name: byte -> offset
    std::vector<Known> order;
    const std::vector<std::string> names = slot_names(json, mode.name);
    if (names.size() > kMaxOflSlots) {
      problem(fmt::format("mode {} has more than {} slots", in_quotes(mode.name), kMaxOflSlots), "a universe has 512");
      return mode;
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (names[i].empty()) continue;
      const Known* known = find(names[i]);
      if (known == nullptr) {
        problem(fmt::format("mode {}: there is no channel {}", in_quotes(mode.name), in_quotes(names[i])),
                "define it under availableChannels or templateChannels");
        continue;
      }
      auto& bytes = slots[known->coarse];
      if (bytes.empty()) order.push_back(*known);
      if (!bytes.try_emplace(known->byte, static_cast<int>(i)).second) {
        problem(fmt::format("mode {}: channel {} twice", in_quotes(mode.name), in_quotes(names[i])),
                "list each channel once");
      }
    }
    for (const Known& known : order) add_channel(known, slots[known.coarse], mode);
    lay_out_slots(mode, std::vector<FilePosition>(mode.channels.size()), problems_);
    // Unused slots at the end still belong to the fixture.
    if (!names.empty()) mode.break_footprints = {static_cast<int>(names.size())};
    centre_angles(mode);
    return mode;
  }

  void add_channel(const Known& known, const std::map<std::size_t, int>& bytes, PersonalityMode& mode) {
    PersonalityChannel channel;
    channel.name = known.coarse;
    for (const auto& [byte, offset] : bytes) {
      if (byte != channel.offsets.size()) {
        problem(fmt::format("mode {} has a fine byte of channel {} without the byte above it", in_quotes(mode.name),
                            in_quotes(known.coarse)),
                "add it, or put null in place of the fine one");
        return;
      }
      channel.offsets.push_back(offset);
    }
    OflFunctions read =
        read_ofl_functions(fixture_, known.coarse, *known.channel, static_cast<int>(channel.offsets.size()), problems_);
    if (read.functions.empty()) return;
    channel.functions = std::move(read.functions);
    channel.default_dmx = read.default_dmx;
    channel.highlight_dmx = read.highlight_dmx;
    channel.geometry = geometry_of(mode, known.pixel);
    mode.channels.push_back(std::move(channel));
  }

  static void centre_angles(PersonalityMode& mode) {
    bool pan = false, tilt = false;
    for (const PersonalityChannel& channel : mode.channels) {
      for (const ChannelFunction& function : channel.functions) {
        const double middle_deg = (function.physical_from + function.physical_to) / 2;
        if (function.attribute == "Pan" && !std::exchange(pan, true)) mode.pan_offset_deg = -middle_deg;
        if (function.attribute == "Tilt" && !std::exchange(tilt, true)) mode.tilt_offset_deg = -middle_deg;
      }
    }
  }

  const OflJson& json_;
  ProblemList& problems_;
  OflFixture fixture_;
  OflMatrix matrix_;
  std::unordered_map<std::string, Known> known_;
  std::map<std::string, std::string> switches_;
};

/// Later versions may use the same words with other meanings.
bool is_known_schema(const std::string& schema) {
  return schema.find("open-fixture-library/") != std::string::npos && schema.ends_with("/schemas/fixture.json") &&
         (schema.find("/schema-") == std::string::npos || schema.find("/schema-12.") != std::string::npos);
}

}  // namespace

Checked<Personality> parse_ofl(std::string_view text, const std::string& manufacturer, const std::string& file) {
  ProblemList problems(file);
  const auto refuse = [&](const FilePosition& in_file, std::string what, std::string mend) {
    problems.add(in_file, std::move(what), std::move(mend));
    return tl::unexpected(problems.take());
  };
  if (text.size() > kMaxOflBytes) {
    return refuse({}, fmt::format("the file has {} bytes", text.size()),
                  fmt::format("it may have at most {} MiB", kMaxOflBytes >> 20));
  }
  if (depth_of_brackets(text) > kMaxOflDepth)
    return refuse({}, fmt::format("nested deeper than {}", kMaxOflDepth), "no such file needs that; do not trust it");
  OflJson json;
  try {  // only an exception of the parser has the place of an error
    json = OflJson::parse(text);
  } catch (const OflJson::parse_error& error) {
    return refuse(place_in_text(text, error.byte), "not well-formed JSON", "get the file again from the library");
  } catch (const OflJson::exception&) {  // a number out of range
    return refuse({}, "a number that no computer can hold", "get the file again from the library");
  }
  const std::string schema = ofl_text(ofl_member(json, "$schema"));
  if (!is_known_schema(schema)) {
    return refuse({},
                  schema.empty() ? "no $schema, so no Open Fixture Library file"
                                 : fmt::format("the format {} is not known", in_quotes(schema)),
                  "this reads fixtures of the Open Fixture Library, schema version 12");
  }
  Personality personality = OflReader(json, problems).read(manufacturer);
  if (!problems.empty()) return tl::unexpected(problems.take());
  return personality;
}

}  // namespace luxrig
