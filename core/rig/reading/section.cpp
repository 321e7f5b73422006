#include "core/rig/reading/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/check.h"
#include "core/text/nearest.h"

namespace luxrig {
namespace {

constexpr std::size_t kLongestText = 4096;  // a path

std::string example_of(const KeySpec& spec) {
  switch (spec.type) {
    case ValueType::vector3:
      return fmt::format("write three numbers: {} = [0, 0, 1]", spec.key);
    case ValueType::span2:
      return fmt::format("write two numbers: {} = {}", spec.key, spec.fallback);
    case ValueType::box:
      return fmt::format("write two corners: {} = [[0, 0, 2], [5, 4, 3]]", spec.key);
    case ValueType::colour:
      return fmt::format("write one number or three: {0} = 0.5 or {0} = [0.5, 0.5, 0.5]", spec.key);
    case ValueType::chromaticity:
      return fmt::format("write two numbers: {} = [0.3127, 0.329] is daylight white", spec.key);
    case ValueType::texts:
      return fmt::format("write a list: {} = {}", spec.key,
                         spec.fallback == kNone || spec.fallback == kRequired ? R"(["one", "other"])" : spec.fallback);
    case ValueType::whole_numbers:
      return fmt::format("write a list: {} = [9600, 19200]", spec.key);
    case ValueType::yes_no:
      return fmt::format("write {} = true or {} = false, without quotes", spec.key, spec.key);
    case ValueType::number:
      return "write a number, without quotes";
    case ValueType::whole_number:
      return "write a whole number, without quotes or decimal point";
    default:
      return "write text in quotes";
  }
}

}  // namespace

Section::Section(const NodeTable& table, const FilePosition& in_file, std::string_view section, ProblemList& problems)
    : table_(table), place_(in_file), section_(section_spec(section)), keys_(keys_of(section)), problems_(problems) {
  if (section_.takes_other_keys) return;
  const auto children = [&] {
    std::vector<std::string_view> names;
    for (const SectionSpec& child : sections()) {
      if (child.name.size() > section.size() && child.name.starts_with(section) && child.name[section.size()] == '.') {
        names.push_back(child.name.substr(section.size() + 1));
      }
    }
    return names;
  };
  for (const Member& member : table_) {
    if (problems_.full()) return;
    const auto is_it = [&](const KeySpec& spec) { return spec.key == member.key; };
    if (std::any_of(keys_.begin(), keys_.end(), is_it)) continue;
    std::vector<std::string_view> known = children();
    if (std::find(known.begin(), known.end(), member.key) != known.end()) continue;
    for (const KeySpec& key : keys_) known.push_back(key.key);
    problems_.add(member.key_place, fmt::format("unknown key {} in {}", in_quotes(member.key), heading_of(section_)),
                  mend_for_unknown(member.key, known, "remove it"));
  }
}

FilePosition Section::place_of(std::string_view key) const {
  const Member* member = find(table_, key);
  return member ? member->node.in_file : place_;
}

const KeySpec& Section::spec(std::string_view key) const {
  const auto at = std::find_if(keys_.begin(), keys_.end(), [&](const KeySpec& k) { return k.key == key; });
  LUXRIG_CHECK(at != keys_.end(), "no key {} in section {}", key, section_.name);
  return *at;
}

const Node* Section::value(const KeySpec& spec) {
  if (const Member* member = find(table_, spec.key)) return &member->node;
  if (spec.fallback == kRequired) require(spec.key, "");
  return nullptr;
}

void Section::require(std::string_view key, std::string_view why) {
  const KeySpec& k = spec(key);
  const std::string range = range_text(k);
  problems_.add(
      place_, fmt::format("{} has no \"{}\"{}{}", heading_of(section_), key, why.empty() ? "" : ", ", why),
      fmt::format("add {} = ({}{}{}): {}", key, type_text(k.type), range.empty() ? "" : ", ", range, k.summary));
}

void Section::refuse(std::string_view key, std::string why, std::string mend) {
  if (const Member* member = find(table_, key)) problems_.add(member->key_place, std::move(why), std::move(mend));
}

bool Section::number_from(const KeySpec& spec, const Node& node, double& out) {
  double x = 0;
  if (const auto* integer = std::get_if<std::int64_t>(&node.value)) {
    x = static_cast<double>(*integer);
  } else if (const auto* number = std::get_if<double>(&node.value)) {
    x = *number;
  } else {
    problems_.add(node.in_file, fmt::format("{} must be a number, not {}", spec.key, kind_of(node)), example_of(spec));
    return false;
  }
  if (!std::isfinite(x)) {
    problems_.add(node.in_file, fmt::format("{} is not a finite number", spec.key),
                  range_text(spec).empty() ? "write a finite number" : "allowed: " + range_text(spec));
    return false;
  }
  if (!spec.bounds.contain(x)) {
    problems_.add(node.in_file, fmt::format("{} is {}, which is out of range", spec.key, x),
                  fmt::format("allowed: {}{}{}", range_text(spec), spec.unit.empty() ? "" : " ", spec.unit));
    return false;
  }
  out = x;
  return true;
}

bool Section::text_from(const KeySpec& spec, const Node& node, std::string& out) {
  const auto* given = std::get_if<std::string>(&node.value);
  if (!given) {
    problems_.add(node.in_file, fmt::format("{} must be text, not {}", spec.key, kind_of(node)), "write it in quotes");
    return false;
  }
  if (given->empty()) {
    problems_.add(node.in_file, fmt::format("{} is empty", spec.key),
                  spec.fallback == kRequired ? fmt::format("write {}", spec.summary) : "write it, or remove the key");
    return false;
  }
  const std::size_t most = spec.type == ValueType::name ? kLongestName : kLongestText;
  if (const std::size_t length = length_in_characters(*given); length > most) {
    problems_.add(node.in_file, fmt::format("{} has {} characters", spec.key, length),
                  fmt::format("use at most {}", most));
    return false;
  }
  if (!is_plain_text(*given)) {
    problems_.add(node.in_file, fmt::format("{} {} has a control character", spec.key, in_quotes(*given)),
                  "use printable characters only");
    return false;
  }
  out = *given;
  return true;
}

bool Section::read(std::string_view key, double& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::number, "{} is not a number", key);
  const Node* node = value(k);
  return node && number_from(k, *node, out);
}

bool Section::read(std::string_view key, int& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::whole_number, "{} is not a whole number", key);
  const Node* node = value(k);
  if (!node) return false;
  double x = 0;
  if (!std::holds_alternative<std::int64_t>(node->value)) {
    problems_.add(node->in_file, fmt::format("{} must be a whole number, not {}", key, kind_of(*node)), example_of(k));
    return false;
  }
  if (!number_from(k, *node, x)) return false;
  out = static_cast<int>(x);  // fits: the schema's bounds are within int
  return true;
}

bool Section::read(std::string_view key, bool& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::yes_no, "{} is not a boolean", key);
  const Node* node = value(k);
  if (!node) return false;
  const bool* given = std::get_if<bool>(&node->value);
  if (!given) {
    problems_.add(node->in_file, fmt::format("{} must be true or false, not {}", key, kind_of(*node)), example_of(k));
    return false;
  }
  out = *given;
  return true;
}

bool Section::read(std::string_view key, std::string& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::text || k.type == ValueType::name || k.type == ValueType::file, "{} is not text",
               key);
  const Node* node = value(k);
  return node && text_from(k, *node, out);
}

bool Section::read(std::string_view key, Vec3& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::vector3 || k.type == ValueType::colour, "{} is not a vector", key);
  const Node* node = value(k);
  if (!node) return false;
  const auto* list = std::get_if<NodeList>(&node->value);
  if (!list && k.type == ValueType::colour &&
      (std::holds_alternative<double>(node->value) || std::holds_alternative<std::int64_t>(node->value))) {
    double grey = 0;
    if (!number_from(k, *node, grey)) return false;
    out = Vec3::Constant(grey);
    return true;
  }
  return three_numbers_from(k, *node, out);
}

bool Section::three_numbers_from(const KeySpec& spec, const Node& node, Vec3& out) {
  const auto* list = std::get_if<NodeList>(&node.value);
  if (!list || list->size() != 3) {
    const std::string_view what = spec.type == ValueType::box ? "a corner of " : "";
    problems_.add(node.in_file,
                  list ? fmt::format("{}{} has {} entries", what, spec.key, list->size())
                       : fmt::format("{}{} must be {}, not {}", what, spec.key,
                                     what.empty() ? type_text(spec.type) : "[x, y, z]", kind_of(node)),
                  example_of(spec));
    return false;
  }
  Vec3 v;
  bool good = true;
  for (std::size_t i = 0; i < 3; ++i) good &= number_from(spec, (*list)[i], v[static_cast<Eigen::Index>(i)]);
  if (good) out = v;
  return good;
}

const NodeList* Section::pair_from(const KeySpec& spec, const Node& node, std::string_view parts) {
  const auto* list = std::get_if<NodeList>(&node.value);
  if (list && list->size() == 2) return list;
  problems_.add(node.in_file,
                list ? fmt::format("{} has {} {}", spec.key, list->size(), parts)
                     : fmt::format("{} must be {}, not {}", spec.key, type_text(spec.type), kind_of(node)),
                example_of(spec));
  return nullptr;
}

bool Section::read(std::string_view key, Eigen::AlignedBox3d& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::box, "{} is not a box", key);
  const Node* node = value(k);
  if (!node) return false;
  const NodeList* list = pair_from(k, *node, "corners");
  if (!list) return false;
  Vec3 one, other;
  const bool one_good = three_numbers_from(k, (*list)[0], one), other_good = three_numbers_from(k, (*list)[1], other);
  if (!one_good || !other_good) return false;
  const Eigen::AlignedBox3d box(one.cwiseMin(other), one.cwiseMax(other));
  if (!(box.sizes().minCoeff() > 0)) {
    problems_.add(node->in_file, fmt::format("{} has no volume", key),
                  "give two opposite corners that differ in x, y and z");
    return false;
  }
  out = box;
  return true;
}

bool Section::read(std::string_view key, std::pair<double, double>& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::span2, "{} is not a range", key);
  const Node* node = value(k);
  if (!node) return false;
  const NodeList* list = pair_from(k, *node, "entries");
  if (!list) return false;
  double from = 0, to = 0;
  const bool from_good = number_from(k, (*list)[0], from), to_good = number_from(k, (*list)[1], to);
  if (!from_good || !to_good) return false;
  if (!(from < to)) {
    problems_.add(node->in_file, fmt::format("{} runs from {} to {}", key, from, to),
                  from > to ? fmt::format("write the smaller first: [{}, {}]", to, from)
                            : "the second must be larger than the first");
    return false;
  }
  out = {from, to};
  return true;
}

bool Section::read(std::string_view key, Eigen::Vector2d& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::chromaticity, "{} is not a chromaticity", key);
  const Node* node = value(k);
  if (!node) return false;
  const NodeList* list = pair_from(k, *node, "entries");
  if (!list) return false;
  Eigen::Vector2d xy;
  const bool x_good = number_from(k, (*list)[0], xy[0]), y_good = number_from(k, (*list)[1], xy[1]);
  if (!x_good || !y_good) return false;
  if (xy.sum() > 1) {
    problems_.add(node->in_file, fmt::format("{} [{:g}, {:g}] add up to {:g}", key, xy[0], xy[1], xy.sum()),
                  "x and y of a chromaticity (CIE 1931) add up to 1 at most");
    return false;
  }
  out = xy;
  return true;
}

bool Section::read(std::string_view key, std::vector<int>& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::whole_numbers, "{} is not a list of whole numbers", key);
  const Node* node = value(k);
  if (!node) return false;
  const auto* list = std::get_if<NodeList>(&node->value);
  if (!list) {
    problems_.add(node->in_file, fmt::format("{} must be a list of whole numbers, not {}", key, kind_of(*node)),
                  example_of(k));
    return false;
  }
  std::vector<int> numbers;
  bool good = true;
  for (const Node& item : *list) {
    double x = 0;
    if (!std::holds_alternative<std::int64_t>(item.value)) {
      problems_.add(item.in_file, fmt::format("{} must hold whole numbers, not {}", key, kind_of(item)), example_of(k));
      good = false;
    } else if (number_from(k, item, x)) {
      numbers.push_back(static_cast<int>(x));
    } else {
      good = false;
    }
  }
  if (good) out = std::move(numbers);
  return good;
}

int Section::choice(std::string_view key) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(!k.choices.empty(), "{} has no choices", key);
  const Node* node = value(k);
  std::string given;
  if (!node || !text_from(k, *node, given)) return -1;
  const auto known = choices_of(k);
  const auto at = std::find(known.begin(), known.end(), given);
  if (at != known.end()) return static_cast<int>(at - known.begin());
  const std::string_view near = nearest_name(given, known);
  problems_.add(node->in_file, fmt::format("{} cannot be {}", key, in_quotes(given)),
                near.empty() ? fmt::format("allowed: {}", range_text(k))
                             : fmt::format("did you mean \"{}\"? (allowed: {})", near, range_text(k)));
  return -1;
}

double Section::number(std::string_view key) {
  const std::string_view fallback = spec(key).fallback;
  double value = 0;
  const auto [end, error] = std::from_chars(fallback.data(), fallback.data() + fallback.size(), value);
  LUXRIG_CHECK(error == std::errc{} && end == fallback.data() + fallback.size(), "{} has no default", key);
  read(key, value);
  return value;
}

bool Section::yes_no(std::string_view key) {
  bool value = spec(key).fallback == "true";
  read(key, value);
  return value;
}

bool Section::read_deg(std::string_view key, double& out_rad) {
  double deg = 0;
  if (!read(key, deg)) return false;
  out_rad = rad_from_deg(deg);
  return true;
}

bool Section::read_normal(std::string_view key, Vec3& out) {
  Vec3 v;
  if (!read(key, v)) return false;
  if (v.stableNorm() < 1e-9) {
    problems_.add(place_of(key), fmt::format("{} has no length", key),
                  "give the direction the lit side faces, as [0, 0, 1] for up");
    return false;
  }
  out = v.stableNormalized();
  return true;
}

bool Section::read_texts(std::string_view key, std::vector<std::pair<std::string, FilePosition>>& out) {
  const KeySpec& k = spec(key);
  LUXRIG_CHECK(k.type == ValueType::texts, "{} is not a list of text", key);
  const Node* node = value(k);
  if (!node) return false;
  const auto* list = std::get_if<NodeList>(&node->value);
  if (!list) {
    problems_.add(node->in_file, fmt::format("{} must be a list of text, not {}", key, kind_of(*node)), example_of(k));
    return false;
  }
  std::vector<std::pair<std::string, FilePosition>> texts;
  bool good = true;
  for (const Node& item : *list) {
    texts.emplace_back("", item.in_file);
    good &= text_from(k, item, texts.back().first);
  }
  if (good) out = std::move(texts);
  return good;
}

void each_section(const NodeTable& table, std::string_view section, ProblemList& problems,
                  const std::function<void(Section&)>& body) {
  const SectionSpec& spec = section_spec(section);
  const std::size_t dot = section.rfind('.');
  const Member* member = find(table, dot == std::string_view::npos ? section : section.substr(dot + 1));
  if (!member) return;
  const auto* list = std::get_if<NodeList>(&member->node.value);
  const auto* single = std::get_if<NodeTable>(&member->node.value);
  const auto wrong_shape = [&](const FilePosition& in_file) {
    problems.add(in_file, fmt::format("{} is not {}", section, spec.list ? "a list of tables" : "a table"),
                 fmt::format("head {} with {}", spec.list ? "each entry" : "it", heading_of(spec)));
  };
  if (spec.list ? list == nullptr : single == nullptr) {
    wrong_shape(member->key_place);
    return;
  }
  if (single) {
    Section entry(*single, member->node.in_file, section, problems);
    body(entry);
    return;
  }
  if (list->size() > spec.most) {
    problems.add(member->key_place, fmt::format("{} entries of {}", list->size(), heading_of(spec)),
                 fmt::format("use at most {}", spec.most));
    return;
  }
  for (const Node& node : *list) {
    if (const auto* entry_table = std::get_if<NodeTable>(&node.value)) {
      Section entry(*entry_table, node.in_file, section, problems);
      body(entry);
    } else {
      wrong_shape(node.in_file);
    }
  }
}

void report_unknown_sections(const NodeTable& root, SectionSpec::File file, std::string_view what,
                             ProblemList& problems) {
  std::vector<std::string_view> known;
  for (const SectionSpec& section : sections()) {
    if (section.file == file && section.name.find('.') == std::string_view::npos) known.push_back(section.name);
  }
  for (const Member& member : root) {
    if (std::find(known.begin(), known.end(), member.key) != known.end()) continue;
    if (problems.full()) return;
    problems.add(member.key_place,
                 fmt::format("unknown section {}{}{}", in_quotes(member.key), what.empty() ? "" : " in ", what),
                 mend_for_unknown(member.key, known, "remove it"));
  }
}

}  // namespace luxrig
