#include "core/text/json_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <string_view>

#include "core/text/json_place.h"

namespace luxrig {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;  // a plan of 100 000 points is about 25 MB
constexpr std::size_t kMaxDepth = 16;                     // a plan needs 6
constexpr std::size_t kMaxValues = 2'000'000;             // each takes memory, however few bytes it has in the file
constexpr std::size_t kMaxKeys = 1000;                    // of one object; those of a plan have 20
constexpr std::size_t kMaxProblems = 50;                  // enough for a person

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

}  // namespace

void JsonReader::problem(std::string what, std::string mend) const {
  if (problems_.size() < kMaxProblems) problems_.push_back({file_name_, 0, 0, std::move(what), std::move(mend)});
}

std::optional<Json> JsonReader::document(const std::string& text) {
  if (text.size() > kMaxBytes) {
    problem(fmt::format("{} bytes are too much for {} (at most {})", text.size(), kind_, kMaxBytes), remedy_);
    return std::nullopt;
  }
  SyntaxCheck check;
  if (!Json::sax_parse(text, &check)) {
    Problem wrong{file_name_, 0, 0, check.error, remedy_ + ", or mend the text here"};
    if (check.error_byte > 0) {
      const std::size_t end = std::min(check.error_byte - 1, text.size());
      const auto before = std::string_view(text).substr(0, end);
      wrong.line = 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n'));
      const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
      wrong.column = 1 + static_cast<int>(end - line_start);
    }
    problems_.push_back(std::move(wrong));
    return std::nullopt;
  }
  Json json = Json::parse(text, nullptr, false);
  if (json.is_object()) return json;
  problem(fmt::format("{} is an object in braces, this is {}", kind_, json.type_name()), remedy_);
  return std::nullopt;
}

std::vector<Problem> JsonReader::problems(const std::string& text) const {
  std::vector<Problem> placed = problems_;
  for (Problem& problem : placed) {
    if (problem.what.empty() || problem.what.front() != '/') continue;
    const std::string_view what = problem.what;  // begins with the path of the wrong value
    const JsonPlace place = place_in_json(text, what.substr(0, what.find_first_of(" :")));
    problem.line = place.line;
    problem.column = place.column;
  }
  return placed;
}

const Json* JsonReader::member(const Json& object, const std::string& path, const char* key, bool required) const {
  const auto found = object.find(key);
  if (found != object.end()) return &*found;
  if (required) problem(fmt::format("{}/{} is missing", path, key), remedy_);
  return nullptr;
}

void JsonReader::require_version(const Json& object, const char* key, int version) const {
  const Json* found = member(object, "", key, true);
  if (found && *found != version) {
    problem(fmt::format("/{} is {}, this program reads version {}", key,
                        found->dump(-1, ' ', false, Json::error_handler_t::replace).substr(0, 40), version),
            remedy_);
  }
}

std::string JsonReader::text(const Json& object, const std::string& path, const char* key, bool required) const {
  const Json* value = member(object, path, key, required);
  if (!value) return {};
  if (value->is_string()) return value->get<std::string>();
  wrong_type(path, key, "a text in quotes", *value);
  return {};
}

double JsonReader::number(const Json& object, const std::string& path, const char* key, bool required) const {
  const Json* value = member(object, path, key, required);
  if (!value) return kAbsent;
  if (value->is_number()) return value->get<double>();
  wrong_type(path, key, "a number", *value);
  return kAbsent;
}

std::optional<double> JsonReader::optional_number(const Json& object, const std::string& path, const char* key) const {
  const double value = number(object, path, key, false);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::uint64_t JsonReader::fingerprint(const Json& object, const std::string& path, const char* key) const {
  const std::string digits = text(object, path, key, false);
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (digits.empty() || (error == std::errc{} && end == digits.data() + digits.size())) return value;
  wrong_type(path, key, "up to 16 hex digits", object[key]);
  return 0;
}

void JsonReader::read_yes_no(const Json& object, const std::string& path, const char* key, bool& value) const {
  const Json* found = member(object, path, key, false);
  if (!found) return;
  if (!found->is_boolean()) return wrong_type(path, key, "true or false", *found);
  value = found->get<bool>();
}

std::optional<Vec3> JsonReader::vector(const Json& object, const std::string& path, const char* key) const {
  return numbers<3>(object, path, key, "three numbers [x, y, z]");
}

std::optional<Eigen::Vector2d> JsonReader::pair(const Json& object, const std::string& path, const char* key) const {
  return numbers<2>(object, path, key, "two numbers [x, y]");
}

void JsonReader::wrong_type(const std::string& path, const char* key, const char* wanted, const Json& value) const {
  problem(fmt::format("{}/{} is {}", path, key,
                      value.is_primitive() ? value.dump(-1, ' ', false, Json::error_handler_t::replace).substr(0, 40)
                                           : std::string(value.type_name())),
          fmt::format("give {}", wanted));
}

template <int size>
std::optional<Eigen::Vector<double, size>> JsonReader::numbers(const Json& object, const std::string& path,
                                                               const char* key, const char* wanted) const {
  const Json* value = member(object, path, key, false);
  if (!value) return std::nullopt;
  const auto is_number = [](const Json& entry) { return entry.is_number(); };
  if (!value->is_array() || value->size() != size || !std::all_of(value->begin(), value->end(), is_number)) {
    wrong_type(path, key, wanted, *value);
    return std::nullopt;
  }
  Eigen::Vector<double, size> out;
  for (int i = 0; i < size; ++i) out[i] = (*value)[static_cast<std::size_t>(i)].get<double>();
  return out;
}

}  // namespace luxrig
