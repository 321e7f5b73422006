#include "core/rig/personality/ofl/ofl_json.h"

#include <cmath>

#include "core/rig/personality/xml_file.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

const OflJson kNoJson;
constexpr std::string_view kPixelKey = "$pixelKey";

}  // namespace

const OflJson& ofl_member(const OflJson& object, const char* key) {
  if (!object.is_object()) return kNoJson;
  const auto at = object.find(key);
  return at == object.end() ? kNoJson : *at;
}

std::string ofl_text(const OflJson& value) {
  const auto* text = value.get_ptr<const OflJson::string_t*>();
  return text == nullptr ? std::string() : made_plain(*text);
}

std::vector<std::string> ofl_texts(const OflJson& value) {
  std::vector<std::string> texts;
  if (value.is_array())
    for (const OflJson& item : value) texts.push_back(ofl_text(item));
  return texts;
}

std::optional<double> ofl_entity(const OflJson& value, std::string_view unit) {
  if (value.is_number()) return unit.empty() ? std::optional(value.get<double>()) : std::nullopt;
  const std::string text = ofl_text(value);
  if (!text.ends_with(unit)) return std::nullopt;
  return finite_number(std::string_view(text).substr(0, text.size() - unit.size()));
}

std::optional<double> ofl_brightness(const OflJson& value) {
  const std::string text = ofl_text(value);
  if (text == "off") return 0;
  if (text == "dark") return 0.01;
  if (text == "bright") return 1;
  if (const auto percent = ofl_entity(value, "%")) return *percent / 100;
  return std::nullopt;
}

std::optional<std::uint32_t> ofl_dmx(const OflJson& value, int bytes, int bytes_wanted) {
  const double most = std::exp2(8 * bytes) - 1;
  std::uint64_t dmx = 0;
  if (value.is_number()) {
    const auto number = value.get<double>();
    if (!(number >= 0 && number <= most) || number != std::floor(number)) return std::nullopt;
    dmx = static_cast<std::uint64_t>(number);
  } else {
    const auto percent = ofl_entity(value, "%");
    if (!percent || !(*percent >= 0 && *percent <= 100)) return std::nullopt;
    return static_cast<std::uint32_t>(std::floor(*percent / 100 * (std::exp2(8 * bytes_wanted) - 1)));
  }
  if (bytes_wanted < bytes) return static_cast<std::uint32_t>(dmx >> (8 * (bytes - bytes_wanted)));
  return static_cast<std::uint32_t>(dmx << (8 * (bytes_wanted - bytes)));
}

std::string with_pixel(std::string text, std::string_view pixel) {
  for (std::size_t at = 0; (at = text.find(kPixelKey, at)) != std::string::npos; at += pixel.size())
    text.replace(at, kPixelKey.size(), pixel);
  return text;
}

}  // namespace luxrig
