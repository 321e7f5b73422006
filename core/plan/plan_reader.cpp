/// plan_from_json(): reads a plan that a person may have edited, with the place of every mistake.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "core/plan/json_place.h"
#include "core/plan/plan.h"

namespace luxrig {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;  // a plan of 100 000 points is about 25 MB
constexpr std::size_t kMaxDepth = 16;                     // a plan needs 6
constexpr std::size_t kMaxValues = 2'000'000;             // each takes memory, however few bytes it has in the file
constexpr std::size_t kMaxKeys = 1000;                    // of one object; those of a plan have 20
constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

/// First pass over the text: finds errors that the document parser would throw on or silently accept, with their place.
class SyntaxCheck : public nlohmann::json_sax<Json> {
 public:
  std::size_t error_byte = 0;  ///< from 1; 0 = place unknown
  std::string error;           ///< empty = well formed

  bool null() override { return count(); }
  bool boolean(bool) override { return count(); }
  bool number_integer(number_integer_t) override { return count(); }
  bool number_unsigned(number_unsigned_t) override { return count(); }
  bool number_float(number_float_t, const string_t&) override { return count(); }
  bool string(string_t&) override { return count(); }
  bool binary(binary_t&) override { return count(); }
  bool start_object(std::size_t) override { return enter(); }
  bool start_array(std::size_t) override { return enter(); }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  bool key(string_t& name) override {
    if (keys_.back().size() >= kMaxKeys) {
      error = fmt::format("an object with more than {} keys", kMaxKeys);
      return false;
    }
    if (keys_.back().insert(name).second) return true;
    error = fmt::format("key \"{}\" is given twice in one object", name);
    return false;
  }
  bool parse_error(std::size_t byte, const std::string& token, const nlohmann::detail::exception& e) override {
    error_byte = byte;
    const std::string_view text = e.what();
    error = text.find("number overflow") != std::string_view::npos
                ? fmt::format("number {} is too large", token)
                : fmt::format("not valid JSON{}", token.empty() ? "" : fmt::format(" at \"{}\"", token.substr(0, 40)));
    return false;
  }

 private:
  std::vector<std::set<std::string>> keys_;
  std::size_t values_ = 0;

  bool count() {
    if (++values_ <= kMaxValues) return true;
    error = fmt::format("more than {} values", kMaxValues);
    return false;
  }
  bool enter() {
    keys_.emplace_back();
    if (keys_.size() <= kMaxDepth) return count();
    error = fmt::format("nested deeper than {}", kMaxDepth);
    return false;
  }
  bool leave() {
    keys_.pop_back();
    return true;
  }
};

/// Reads typed members of a document and collects every problem with its path (/tasks/0/lights/3/level).
class Reader {
 public:
  Reader(const std::string& file_name, std::vector<Problem>& problems) : file_name_(file_name), problems_(problems) {}

  void problem(std::string what, std::string mend) const {
    // Fifty wrong entries are enough for a person.
    if (problems_.size() < 50) problems_.push_back({file_name_, 0, 0, std::move(what), std::move(mend)});
  }

  /// The member, or null if absent (a problem if required).
  [[nodiscard]] const Json* member(const Json& object, const std::string& path, const char* key, bool required) const {
    const auto found = object.find(key);
    if (found != object.end()) return &*found;
    if (required) problem(fmt::format("{}/{} is missing", path, key), "write the plan anew with luxrig solve");
    return nullptr;
  }

  [[nodiscard]] std::string text(const Json& object, const std::string& path, const char* key, bool required) const {
    const Json* value = member(object, path, key, required);
    if (!value) return {};
    if (value->is_string()) return value->get<std::string>();
    wrong_type(path, key, "a text in quotes", *value);
    return {};
  }

  /// NaN if absent, since the key of an unknown number is left out.
  [[nodiscard]] double number(const Json& object, const std::string& path, const char* key, bool required) const {
    const Json* value = member(object, path, key, required);
    if (!value) return kAbsent;
    if (value->is_number()) return value->get<double>();
    wrong_type(path, key, "a number", *value);
    return kAbsent;
  }

  [[nodiscard]] std::optional<double> optional_number(const Json& object, const std::string& path,
                                                      const char* key) const {
    const double value = number(object, path, key, false);
    return std::isfinite(value) ? std::optional(value) : std::nullopt;
  }

  /// A fingerprint in hex digits; 0 = none.
  [[nodiscard]] std::uint64_t fingerprint(const Json& object, const std::string& path, const char* key) const {
    const std::string digits = text(object, path, key, false);
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (digits.empty() || (error == std::errc{} && end == digits.data() + digits.size())) return value;
    wrong_type(path, key, "up to 16 hex digits", object[key]);
    return 0;
  }

  /// Leaves `value` unchanged if the key is absent.
  void read_yes_no(const Json& object, const std::string& path, const char* key, bool& value) const {
    const Json* found = member(object, path, key, false);
    if (!found) return;
    if (!found->is_boolean()) return wrong_type(path, key, "true or false", *found);
    value = found->get<bool>();
  }

  [[nodiscard]] std::optional<Vec3> vector(const Json& object, const std::string& path, const char* key) const {
    return numbers<3>(object, path, key, "three numbers [x, y, z]");
  }
  [[nodiscard]] std::optional<Chromaticity> chromaticity(const Json& object, const std::string& path,
                                                         const char* key) const {
    return numbers<2>(object, path, key, "two numbers [x, y]");
  }

  template <class Unsigned>
  [[nodiscard]] Unsigned count(const Json& object, const std::string& path, const char* key) const {
    const Json* value = member(object, path, key, false);
    if (!value) return 0;
    if (value->is_number_unsigned() &&
        value->get<std::uint64_t>() <= static_cast<std::uint64_t>(std::numeric_limits<Unsigned>::max())) {
      return static_cast<Unsigned>(value->get<std::uint64_t>());
    }
    wrong_type(path, key, "a whole number from 0", *value);
    return 0;
  }

  /// Calls body(entry, path) for each object of the list.
  template <class Body>
  void each(const Json& object, const std::string& path, const char* key, bool required, Body body) const {
    const Json* list = member(object, path, key, required);
    if (!list) return;
    if (!list->is_array()) return wrong_type(path, key, "a list", *list);
    for (std::size_t i = 0; i < list->size(); ++i) {
      const std::string entry_path = fmt::format("{}/{}/{}", path, key, i);
      if ((*list)[i].is_object()) {
        body((*list)[i], entry_path);
      } else {
        problem(fmt::format("{} is {}, not an object", entry_path, (*list)[i].type_name()),
                "write the plan anew with luxrig solve");
      }
    }
  }

  void wrong_type(const std::string& path, const char* key, const char* wanted, const Json& value) const {
    problem(fmt::format("{}/{} is {}", path, key,
                        value.is_primitive() ? value.dump(-1, ' ', false, Json::error_handler_t::replace).substr(0, 40)
                                             : std::string(value.type_name())),
            fmt::format("give {}", wanted));
  }

 private:
  template <int count>
  [[nodiscard]] std::optional<Eigen::Vector<double, count>> numbers(const Json& object, const std::string& path,
                                                                    const char* key, const char* wanted) const {
    const Json* value = member(object, path, key, false);
    if (!value) return std::nullopt;
    const auto is_number = [](const Json& entry) { return entry.is_number(); };
    if (!value->is_array() || value->size() != count || !std::all_of(value->begin(), value->end(), is_number)) {
      wrong_type(path, key, wanted, *value);
      return std::nullopt;
    }
    Eigen::Vector<double, count> out;
    for (int i = 0; i < count; ++i) out[i] = (*value)[static_cast<std::size_t>(i)].get<double>();
    return out;
  }

  const std::string& file_name_;
  std::vector<Problem>& problems_;
};

PlannedLight light_of(const Reader& reader, const Json& json, const std::string& path) {
  PlannedLight light;
  light.name = reader.text(json, path, "name", true);
  light.luminaire = reader.text(json, path, "luminaire", false);
  light.position_world_m = reader.vector(json, path, "position").value_or(Vec3::Constant(kAbsent));
  light.aim_world_m = reader.vector(json, path, "aim");
  const auto pan_deg = reader.optional_number(json, path, "pan_deg");
  const auto tilt_deg = reader.optional_number(json, path, "tilt_deg");
  const auto beam_deg = reader.optional_number(json, path, "beam_angle_deg");
  if (pan_deg && tilt_deg)
    light.joints = Joints{rad_from_deg(*pan_deg), rad_from_deg(*tilt_deg), rad_from_deg(beam_deg.value_or(0))};
  light.level = reader.number(json, path, "level", true);
  light.solved_level = reader.optional_number(json, path, "solved_level");
  light.lumens = reader.number(json, path, "lumens", false);
  light.watts = reader.optional_number(json, path, "watts");
  return light;
}

PlannedTask task_of(const Reader& reader, const Json& json, const std::string& path) {
  PlannedTask task;
  task.name = reader.text(json, path, "name", true);
  task.kind = reader.text(json, path, "kind", false);
  task.normalised_error = reader.number(json, path, "normalised_error", false);
  task.lower_bound = reader.optional_number(json, path, "lower_bound");
  reader.read_yes_no(json, path, "switches_proven", task.switches_proven);
  task.lower_bound_of_number = reader.optional_number(json, path, "lower_bound_of_number");
  if (const auto contrast_lx = reader.optional_number(json, path, "local_contrast")) {
    PlannedRelief relief;
    relief.local_contrast_lx = *contrast_lx;
    relief.coverage = reader.number(json, path, "coverage", false);
    relief.relative_contrast = reader.number(json, path, "relative_contrast", false);
    relief.before_relative_contrast = reader.optional_number(json, path, "before_relative_contrast");
    relief.before_local_contrast_lx = reader.optional_number(json, path, "before_local_contrast");
    relief.before_coverage = reader.optional_number(json, path, "before_coverage");
    relief.object_lux = reader.number(json, path, "object_lux", false);
    relief.key_to_fill = reader.optional_number(json, path, "key_to_fill");
    task.relief = relief;
  }
  task.iterations = reader.count<int>(json, path, "iterations");
  task.seconds = reader.number(json, path, "seconds", false);
  reader.each(json, path, "lights", true, [&](const Json& light, const std::string& light_path) {
    task.lights.push_back(light_of(reader, light, light_path));
  });
  reader.each(json, path, "fixtures", false, [&](const Json& light, const std::string& light_path) {
    task.fixtures.push_back(light_of(reader, light, light_path));
  });
  reader.each(json, path, "numbers", false, [&](const Json& number, const std::string& number_path) {
    task.numbers.push_back({reader.count<int>(number, number_path, "lights"),
                            reader.number(number, number_path, "normalised_error", false),
                            reader.optional_number(number, number_path, "local_contrast"),
                            reader.optional_number(number, number_path, "relative_contrast")});
  });
  reader.each(json, path, "directions", false, [&](const Json& held, const std::string& held_path) {
    task.directions.push_back({reader.vector(held, held_path, "direction").value_or(Vec3::Constant(kAbsent)),
                               rad_from_deg(reader.number(held, held_path, "azimuth_deg", false)),
                               rad_from_deg(reader.number(held, held_path, "elevation_deg", false)),
                               reader.vector(held, held_path, "position").value_or(Vec3::Constant(kAbsent))});
  });
  task.watts = reader.optional_number(json, path, "watts");
  reader.each(json, path, "front", false, [&](const Json& power, const std::string& power_path) {
    task.front.push_back({reader.number(power, power_path, "max_watts", false),
                          reader.number(power, power_path, "watts", false),
                          reader.number(power, power_path, "normalised_error", false)});
  });
  return task;
}

PlannedPoint point_of(const Reader& reader, const Json& json, const std::string& path) {
  PlannedPoint point;
  point.name = reader.text(json, path, "name", true);
  point.position_world_m = reader.vector(json, path, "position").value_or(Vec3::Constant(kAbsent));
  point.normal_world = reader.vector(json, path, "normal").value_or(Vec3::Constant(kAbsent));
  point.lux = reader.number(json, path, "lux", false);
  point.direct_lux = reader.number(json, path, "direct_lux", false);
  point.standard_error_lux = reader.number(json, path, "standard_error_lux", false);
  point.opening_lux = reader.optional_number(json, path, "opening_lux");
  point.daylight_lux = reader.optional_number(json, path, "daylight_lux");
  point.goal_lux = reader.optional_number(json, path, "goal_lux");
  point.xy = reader.chromaticity(json, path, "xy");
  point.goal_xy = reader.chromaticity(json, path, "goal_xy");
  point.weight = reader.optional_number(json, path, "weight");
  point.max_lux = reader.optional_number(json, path, "max_lux");
  point.opening_lux = reader.optional_number(json, path, "opening_lux");
  point.why = reader.text(json, path, "why", false);
  point.verdict = verdict_named(reader.text(json, path, "verdict", false));
  point.reason = reader.text(json, path, "reason", false);
  return point;
}

PlannedLimit limit_of(const Reader& reader, const Json& json, const std::string& path) {
  PlannedLimit limit;
  limit.point = reader.text(json, path, "point", true);
  limit.max_lux = reader.number(json, path, "max_lux", false);
  limit.lux = reader.number(json, path, "lux", false);
  reader.read_yes_no(json, path, "met", limit.met);
  return limit;
}

Problem syntax_problem(const SyntaxCheck& check, const std::string& text, const std::string& file_name) {
  Problem problem{file_name, 0, 0, check.error, "write the plan anew with luxrig solve, or mend the text here"};
  if (check.error_byte > 0) {
    const std::size_t end = std::min(check.error_byte - 1, text.size());
    const auto before = std::string_view(text).substr(0, end);
    problem.line = 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n'));
    const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    problem.column = 1 + static_cast<int>(end - line_start);
  }
  return problem;
}

}  // namespace

Checked<Plan> plan_from_json(const std::string& text, const std::string& file_name) {
  std::vector<Problem> problems;
  const Reader reader(file_name, problems);
  if (text.size() > kMaxBytes) {
    reader.problem(fmt::format("{} bytes are too much for a plan (at most {})", text.size(), kMaxBytes),
                   "give a plan written by luxrig solve");
    return tl::unexpected(problems);
  }
  SyntaxCheck check;
  if (!Json::sax_parse(text, &check)) {
    return tl::unexpected(std::vector<Problem>{syntax_problem(check, text, file_name)});
  }
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) {
    reader.problem(fmt::format("a plan is an object in braces, this is {}", json.type_name()),
                   "give a plan written by luxrig solve");
    return tl::unexpected(problems);
  }
  const Json* version = reader.member(json, "", "luxrig_plan", true);
  if (version && *version != 1) {
    reader.problem(fmt::format("/luxrig_plan is {}, this program reads plans of version 1",
                               version->dump(-1, ' ', false, Json::error_handler_t::replace).substr(0, 40)),
                   "write the plan anew with luxrig solve");
  }
  Plan plan;
  plan.rig = reader.text(json, "", "rig", true);
  if (const Json* made_for = reader.member(json, "", "made_for", false)) {
    if (made_for->is_object()) {
      plan.made_for = {reader.fingerprint(*made_for, "/made_for", "goals"),
                       reader.fingerprint(*made_for, "/made_for", "limits"),
                       reader.fingerprint(*made_for, "/made_for", "light")};
    } else {
      reader.wrong_type("", "made_for", "an object in braces", *made_for);
    }
  }
  plan.seed = reader.count<std::uint64_t>(json, "", "seed");
  plan.seconds = reader.number(json, "", "seconds", false);
  reader.each(json, "", "tasks", true,
              [&](const Json& task, const std::string& path) { plan.tasks.push_back(task_of(reader, task, path)); });
  reader.each(json, "", "points", false, [&](const Json& point, const std::string& path) {
    plan.points.push_back(point_of(reader, point, path));
  });
  reader.each(json, "", "limits", false, [&](const Json& limit, const std::string& path) {
    plan.limits.push_back(limit_of(reader, limit, path));
  });
  if (problems.empty()) return plan;
  for (Problem& problem : problems) {
    const std::string_view what = problem.what;  // begins with the path of the wrong value
    const JsonPlace place = place_in_json(text, what.substr(0, what.find_first_of(" :")));
    problem.line = place.line;
    problem.column = place.column;
  }
  return tl::unexpected(problems);
}

}  // namespace luxrig
