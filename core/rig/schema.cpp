#include "core/rig/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {

const SectionSpec& section_spec(std::string_view section) {
  const auto at =
      std::find_if(sections().begin(), sections().end(), [&](const SectionSpec& spec) { return spec.name == section; });
  LUXRIG_CHECK(at != sections().end(), "no section {}", section);
  return *at;
}

std::span<const KeySpec> keys_of(std::string_view section) {
  const auto first =
      std::find_if(keys().begin(), keys().end(), [&](const KeySpec& spec) { return spec.section == section; });
  const auto last = std::find_if(first, keys().end(), [&](const KeySpec& spec) { return spec.section != section; });
  return {first, last};
}

std::string heading_of(const SectionSpec& section) {
  return section.list ? fmt::format("[[{}]]", section.name) : fmt::format("[{}]", section.name);
}

std::vector<std::string_view> choices_of(const KeySpec& spec) {
  std::vector<std::string_view> out;
  for (std::string_view rest = spec.choices; !rest.empty();) {
    const std::size_t comma = rest.find(", ");
    out.push_back(rest.substr(0, comma));
    rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 2);
  }
  return out;
}

std::string range_text(const KeySpec& spec) {
  if (spec.type == ValueType::name) return "1 to 100 characters";
  if (!spec.choices.empty()) {
    std::string list(spec.choices);
    if (const auto comma = list.rfind(", "); comma != std::string::npos) list.replace(comma, 2, " or ");
    return list;
  }
  const Bounds& b = spec.bounds;
  const auto plain = [](double x) {
    return std::abs(x) < 1e15 && x == std::floor(x) ? fmt::format("{:.0f}", x) : fmt::format("{}", x);
  };
  const bool low = std::isfinite(b.min), high = std::isfinite(b.max);
  if (!low && !high) return "";
  return fmt::format("{}{}{}{}{}", low && b.above_min ? "above " : "", low ? plain(b.min) : "",
                     low && high ? (b.below_max ? " to below " : " to ") : "", high ? plain(b.max) : "",
                     spec.type == ValueType::colour || spec.type == ValueType::vector3 ||
                             spec.type == ValueType::span2 || spec.type == ValueType::box ||
                             spec.type == ValueType::chromaticity || spec.type == ValueType::whole_numbers
                         ? ", each"
                         : "");
}

std::string_view type_text(ValueType type) {
  switch (type) {
    case ValueType::text:
    case ValueType::name:
      return "text";
    case ValueType::file:
      return "path";
    case ValueType::number:
      return "number";
    case ValueType::whole_number:
      return "whole number";
    case ValueType::yes_no:
      return "true or false";
    case ValueType::vector3:
      return "[x, y, z]";
    case ValueType::span2:
      return "[from, to]";
    case ValueType::box:
      return "[[x, y, z], [x, y, z]]";
    case ValueType::colour:
      return "number or [r, g, b]";
    case ValueType::chromaticity:
      return "[x, y]";
    case ValueType::texts:
      return "list of text";
    case ValueType::whole_numbers:
      return "list of whole numbers";
  }
  return "";
}

}  // namespace luxrig
