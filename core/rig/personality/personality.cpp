#include "core/rig/personality/personality.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace luxrig {
namespace {

// DIN SPEC 15800, annex of attributes; colour names as usual in lighting.
constexpr std::pair<std::string_view, std::string_view> kAttributeEmitters[] = {
    {"ColorAdd_R", "red"},     {"ColorAdd_G", "green"},       {"ColorAdd_B", "blue"},        {"ColorAdd_C", "cyan"},
    {"ColorAdd_M", "magenta"}, {"ColorAdd_Y", "yellow"},      {"ColorAdd_RY", "amber"},      {"ColorAdd_GY", "lime"},
    {"ColorAdd_GC", "mint"},   {"ColorAdd_BC", "sky blue"},   {"ColorAdd_BM", "indigo"},     {"ColorAdd_RM", "pink"},
    {"ColorAdd_W", "white"},   {"ColorAdd_WW", "warm white"}, {"ColorAdd_CW", "cold white"}, {"ColorAdd_UV", "uv"},
    {"ColorRGB_Red", "red"},   {"ColorRGB_Green", "green"},   {"ColorRGB_Blue", "blue"},
};

char lower(char letter) { return static_cast<char>(std::tolower(static_cast<unsigned char>(letter))); }

std::string bare_letters(std::string_view text) {
  std::string out;
  for (const char letter : text)
    if (letter != ' ' && letter != '-' && letter != '_') out += lower(letter);
  return out;
}

bool tells_open(std::string_view name) { return says(name, "open") && !says(name, "close"); }

std::optional<ShutterState> told_by_name(std::string_view name) {
  if (tells_open(name)) return ShutterState::open;
  if (says(name, "strobe") || says(name, "pulse") || says(name, "random")) return ShutterState::unsteady;
  if (says(name, "close") || says(name, "blackout")) return ShutterState::closed;
  return std::nullopt;
}

bool tells_lamp_on(std::string_view name) {
  const std::string bare = bare_letters(name);
  return bare.find("lampon") != std::string::npos || bare.find("lampstrike") != std::string::npos ||
         bare.find("strikelamp") != std::string::npos || bare.find("ignit") != std::string::npos;
}

}  // namespace

double ChannelFunction::physical_at(std::uint32_t value) const {
  if (dmx.to == dmx.from) return physical_from;
  const double share = static_cast<double>(value - dmx.from) / static_cast<double>(dmx.to - dmx.from);
  return physical_from + share * (physical_to - physical_from);
}

const ChannelSet* ChannelFunction::set_at(std::uint32_t value) const {
  const auto at = std::find_if(sets.begin(), sets.end(), [&](const ChannelSet& s) { return s.dmx.contains(value); });
  return at == sets.end() ? nullptr : &*at;
}

std::uint32_t PersonalityChannel::max_dmx() const {
  const std::size_t bytes = offsets.empty() ? 4 : offsets.size();
  return bytes >= 4 ? 0xFFFFFFFFu : (1u << (8 * bytes)) - 1;
}

BeamGeometry light_of_mode(const PersonalityMode& mode) {
  BeamGeometry sum;
  for (const GeometryInstance& geometry : mode.geometries) {
    if (!geometry.beam) continue;
    if (sum.beam_angle_deg == 0)
      sum = {sum.lumens, geometry.beam->beam_angle_deg, geometry.beam->field_angle_deg, geometry.beam->cct_k,
             sum.power_w};
    sum.lumens += geometry.beam->lumens;
    sum.power_w += geometry.beam->power_w;
  }
  return sum;
}

bool PersonalityMode::share_a_branch(std::size_t geometry_a, std::size_t geometry_b) const {
  const auto within = [&](std::size_t inner, std::size_t outer) {
    for (std::optional<std::size_t> at = inner; at; at = geometries[*at].parent)
      if (*at == outer) return true;
    return false;
  };
  return within(geometry_a, geometry_b) || within(geometry_b, geometry_a);
}

double DmxProfile::at(double share) const {
  const auto after = std::upper_bound(pieces.begin(), pieces.end(), share,
                                      [](double x, const Piece& piece) { return x < piece.from; });
  if (after == pieces.begin()) return share;
  const Piece& piece = *std::prev(after);
  const double x = share - piece.from;
  return piece.c[0] + x * (piece.c[1] + x * (piece.c[2] + x * piece.c[3]));
}

bool says(std::string_view text, std::string_view word) {
  return std::search(text.begin(), text.end(), word.begin(), word.end(),
                     [](char a, char b) { return lower(a) == lower(b); }) != text.end();
}

std::string_view attribute_stem(std::string_view attribute) {
  const auto end = attribute.find_last_not_of("0123456789");
  return end == std::string_view::npos ? attribute : attribute.substr(0, end + 1);
}

std::string_view emitter_of_attribute(std::string_view attribute) {
  for (const auto& [known, emitter] : kAttributeEmitters)
    if (known == attribute) return emitter;
  return {};
}

bool sets_emitter(const ChannelFunction& function, std::string_view emitter) {
  const std::string_view own = emitter_of_attribute(function.attribute);
  if (own.empty()) return false;
  const std::string wanted = bare_letters(emitter);
  return wanted == bare_letters(own) || (!function.emitter.empty() && wanted == bare_letters(function.emitter));
}

std::optional<ShutterState> shutter_state(const ChannelFunction& function, std::uint32_t value) {
  if (!function.attribute.starts_with("Shutter")) return std::nullopt;
  if (attribute_stem(function.attribute) != "Shutter") return ShutterState::unsteady;  // Shutter1Strobe, …
  if (const ChannelSet* set = function.set_at(value); set && !set->name.empty()) {
    if (const auto told = told_by_name(set->name)) return told;
  }
  if (const auto told = told_by_name(function.name)) return told;
  return function.physical_at(value) > 0.999 ? ShutterState::open : ShutterState::closed;
}

bool strikes_lamp(const ChannelFunction& function, std::uint32_t value) {
  if (function.attribute != "LampControl") return false;
  if (const ChannelSet* set = function.set_at(value); set && !set->name.empty()) return tells_lamp_on(set->name);
  return tells_lamp_on(function.name);
}

}  // namespace luxrig
