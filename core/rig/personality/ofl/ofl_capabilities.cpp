#include "core/rig/personality/ofl/ofl_capabilities.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxCapabilities = 1024;

// GDTF attributes for types that only need another name. Types not listed keep their own.
constexpr std::pair<std::string_view, std::string_view> kPlainTypes[] = {
    {"NoFunction", "NoFeature"},
    {"PanContinuous", "PanRotate"},
    {"TiltContinuous", "TiltRotate"},
    {"PanTiltSpeed", "PositionMSpeed"},
    {"ColorTemperature", "CTC"},
    {"Focus", "Focus1"},
    {"Iris", "Iris"},
    {"IrisEffect", "IrisStrobe"},
    {"Frost", "Frost1"},
    {"FrostEffect", "Frost1Ramp"},
    {"Prism", "Prism1"},
    {"PrismRotation", "Prism1PosRotate"},
    {"WheelShake", "Gobo1SelectShake"},
    {"WheelRotation", "Gobo1WheelSpin"},
    {"WheelSlotRotation", "Gobo1PosRotate"},
    {"ColorPreset", "ColorMacro1"},
    {"Effect", "Effects1"},
    {"EffectSpeed", "Effects1Rate"},
    {"StrobeSpeed", "StrobeFrequency"},
    {"Maintenance", "Control1"},
};

constexpr std::pair<std::string_view, std::string_view> kAddedColours[] = {
    {"Red", "ColorAdd_R"},         {"Green", "ColorAdd_G"},       {"Blue", "ColorAdd_B"},   {"Cyan", "ColorAdd_C"},
    {"Magenta", "ColorAdd_M"},     {"Yellow", "ColorAdd_Y"},      {"Amber", "ColorAdd_RY"}, {"White", "ColorAdd_W"},
    {"Warm White", "ColorAdd_WW"}, {"Cold White", "ColorAdd_CW"}, {"UV", "ColorAdd_UV"},    {"Lime", "ColorAdd_GY"},
    {"Indigo", "ColorAdd_BM"},
};

std::string_view translated(std::span<const std::pair<std::string_view, std::string_view>> table,
                            std::string_view word) {
  for (const auto& [from, to] : table)
    if (from == word) return to;
  return {};
}

/// `key`, or `key`Start to `key`End.
template <class Read>
bool read_span(const OflJson& capability, const std::string& key, const Read& read, ChannelFunction& function) {
  const auto one = read(ofl_member(capability, key.c_str()));
  const auto from = one ? one : read(ofl_member(capability, (key + "Start").c_str()));
  const auto to = one ? one : read(ofl_member(capability, (key + "End").c_str()));
  if (!from || !to) return false;
  function.physical_from = *from;
  function.physical_to = *to;
  return true;
}

void read_level(const OflJson& capability, ChannelFunction& function) {
  read_span(capability, "brightness", ofl_brightness, function);
}

/// Angles in degrees. If the file has shares or words, 0 to 1, which states no angle. For a zoom, the words say which
/// end is wide: the wide one is then 1.
void read_angle(const OflJson& capability, ChannelFunction& function) {
  const auto degrees = [](const OflJson& v) { return ofl_entity(v, "deg"); };
  if (read_span(capability, "angle", degrees, function)) return;
  const auto width = [](const OflJson& v) -> std::optional<double> {
    const std::string word = ofl_text(v);
    return word == "narrow" ? std::optional(0.0) : word == "wide" ? std::optional(1.0) : std::nullopt;
  };
  if (!read_span(capability, "angle", width, function)) return;
  const auto word = [](double share) { return share > 0 ? "wide" : "narrow"; };
  if (function.name.empty())
    function.name = fmt::format("{} to {}", word(function.physical_from), word(function.physical_to));
}

std::string colour_attribute(const OflFixture& fixture, const std::string& colour) {
  if (!fixture.adds_colours && (colour == "Cyan" || colour == "Magenta" || colour == "Yellow"))
    return "ColorSub_" + colour.substr(0, 1);
  return std::string(translated(kAddedColours, colour));
}

void read_shutter(const OflJson& capability, ChannelFunction& function) {
  const std::string effect = ofl_text(ofl_member(capability, "shutterEffect"));
  const bool still = effect == "Open" || effect == "Closed";
  function.attribute = still ? "Shutter1" : "Shutter1Strobe";
  function.name = effect;
  if (still) function.physical_from = function.physical_to = effect == "Open" ? 1 : 0;
}

void read_wheel_slot(const OflFixture& fixture, const std::string& channel_key, const OflJson& capability,
                     ChannelFunction& function) {
  std::string wheel = ofl_text(ofl_member(capability, "wheel"));
  if (wheel.empty()) wheel = channel_key;
  const OflJson& slots = ofl_member(ofl_member(ofl_member(fixture.json, "wheels"), wheel.c_str()), "slots");
  bool colours = false;
  if (slots.is_array())
    for (const OflJson& slot : slots) colours |= ofl_text(ofl_member(slot, "type")) == "Color";
  function.attribute = colours ? "Color1" : "Gobo1";
  const auto number = ofl_entity(ofl_member(capability, "slotNumber"), "");
  if (!slots.is_array() || !number || !(*number >= 1 && *number <= static_cast<double>(slots.size()))) return;
  const OflJson& slot = slots[static_cast<std::size_t>(*number) - 1];
  const bool whole = *number == static_cast<double>(static_cast<std::size_t>(*number));
  if (!whole) return;  // half of one slot and half of the next
  function.name = ofl_text(ofl_member(slot, "type")) == "Open" ? "Open" : ofl_text(ofl_member(slot, "name"));
}

void translate(const OflFixture& fixture, const std::string& channel_key, const OflJson& capability,
               ChannelFunction& function) {
  const std::string type = ofl_text(ofl_member(capability, "type"));
  function.name = ofl_text(ofl_member(capability, "comment"));
  if (function.name.empty()) function.name = ofl_text(ofl_member(capability, "effectName"));
  // In files, parts of a hue, saturation and intensity mix are called intensities, too.
  const bool tints = says(channel_key, "hue") || says(channel_key, "saturation");
  if (type == "Intensity" && tints) {
    function.attribute = says(channel_key, "hue") ? "HSB_Hue" : "HSB_Saturation";
  } else if (type == "Intensity") {
    function.attribute = "Dimmer";
    read_level(capability, function);
  } else if (type == "ColorIntensity") {
    function.attribute = colour_attribute(fixture, ofl_text(ofl_member(capability, "color")));
    read_level(capability, function);
  } else if (type == "Pan" || type == "Tilt" || type == "Zoom") {
    function.attribute = type;
    read_angle(capability, function);
  } else if (type == "ShutterStrobe") {
    read_shutter(capability, function);
  } else if (type == "WheelSlot") {
    read_wheel_slot(fixture, channel_key, capability, function);
  } else {
    const std::string_view known = translated(kPlainTypes, type);
    function.attribute = known.empty() ? type : std::string(known);
    if (type == "Maintenance") {
      function.attribute = "LampControl";
      if (!strikes_lamp(function, 0)) function.attribute = "Control1";
      function.hold_s = std::clamp(ofl_entity(ofl_member(capability, "hold"), "s").value_or(0), 0.0, 3600.0);
    }
  }
}

}  // namespace

int ofl_resolution(const OflJson& channel) {
  const OflJson& fine = ofl_member(channel, "fineChannelAliases");
  return 1 + (fine.is_array() ? static_cast<int>(std::min<std::size_t>(fine.size(), 3)) : 0);
}

std::vector<const OflJson*> ofl_capabilities(const OflJson& channel) {
  std::vector<const OflJson*> out;
  if (const OflJson& one = ofl_member(channel, "capability"); one.is_object()) out.push_back(&one);
  if (const OflJson& many = ofl_member(channel, "capabilities"); many.is_array())
    for (const OflJson& capability : many) out.push_back(&capability);
  return out;
}

OflFunctions read_ofl_functions(const OflFixture& fixture, const std::string& key, const OflJson& channel, int bytes,
                                ProblemList& problems) {
  OflFunctions out;
  const auto problem = [&](std::string what, std::string mend) {
    problems.add(FilePosition{}, fmt::format("channel {}: {}", in_quotes(key), what), std::move(mend));
  };
  const std::string stated = ofl_text(ofl_member(channel, "dmxValueResolution"));
  const int resolution = stated == "8bit" ? 1 : stated == "16bit" ? 2 : stated == "24bit" ? 3 : ofl_resolution(channel);
  const auto value = [&](const char* name) -> std::optional<std::uint32_t> {
    const OflJson& given = ofl_member(channel, name);
    if (given.is_null()) return std::nullopt;
    const auto dmx = ofl_dmx(given, resolution, bytes);
    if (!dmx)
      problem(fmt::format("{} is no DMX value in {} bytes", name, resolution), "write 0 to 255, or a share: \"50%\"");
    return dmx;
  };
  out.default_dmx = value("defaultValue").value_or(0);
  out.highlight_dmx = value("highlightValue");
  const std::uint32_t most = bytes >= 4 ? 0xFFFFFFFFu : (1u << (8 * bytes)) - 1;
  for (const OflJson* capability : ofl_capabilities(channel)) {
    if (out.functions.size() == kMaxCapabilities) {
      problem(fmt::format("more than {} capabilities", kMaxCapabilities), "do not trust the file");
      break;
    }
    ChannelFunction function;
    function.dmx = {0, most};
    if (const OflJson& range = ofl_member(*capability, "dmxRange"); !range.is_null()) {
      const bool two = range.is_array() && range.size() == 2;
      const auto from = two ? ofl_dmx(range[0], resolution, bytes) : std::nullopt;
      auto to = two ? ofl_dmx(range[1], resolution, bytes) : std::nullopt;
      if (to && bytes > resolution) *to |= (1u << (8 * (bytes - resolution))) - 1;  // to the end of its last step
      if (!from || !to || *from > *to) {
        problem("a dmxRange is no two rising DMX values", fmt::format("write [from, to] in {} bytes", resolution));
        continue;
      }
      function.dmx = {*from, *to};
    }
    function.default_dmx = function.dmx.from;
    translate(fixture, key, *capability, function);
    out.functions.push_back(std::move(function));
  }
  if (out.functions.empty()) problem("no capability", "give it a capability, as the format asks");
  return out;
}

}  // namespace luxrig
