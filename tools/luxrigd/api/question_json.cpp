#include "tools/luxrigd/api/question_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text/plain_text.h"
#include "tools/luxrig/vector_json.h"
#include "tools/luxrigd/api/command_limits.h"

namespace luxrig {
namespace {

using nlohmann::json;

constexpr std::size_t kLongestId = 40;
/// Characters of the place in words: a point's name, numbers and a direction.
constexpr std::size_t kLongestPlace = 400;
/// A fixture of a housing is called "housing/emitter".
constexpr std::size_t kLongestFixture = 2 * kLongestName + 1;
constexpr double kLeastKnown = 1e3;
constexpr int kMostSteps = 1'000'000;

constexpr std::pair<HandAnswer::What, const char*> kWhats[] = {{HandAnswer::What::reading, "reading"},
                                                               {HandAnswer::What::skip, "skip"},
                                                               {HandAnswer::What::other_place, "other_place"},
                                                               {HandAnswer::What::done, "end"}};

/// Reads members; remembers the first that is wrong.
class QuestionReader {
 public:
  explicit QuestionReader(const json& body) : body_(body) {}

  [[nodiscard]] const std::string& wrong() const { return wrong_; }
  std::string text(const char* key, std::size_t longest) {
    const json* const found = member(key);
    if (found && found->is_string()) {
      auto value = found->get<std::string>();
      if (!value.empty() && is_plain_text(value) && length_in_characters(value) <= longest) return value;
    }
    refuse(key, fmt::format("has to be text of 1 to {} characters", longest));
    return {};
  }
  double number(const char* key, double least, double most) {
    const json* const found = member(key);
    if (found && found->is_number()) {
      const double value = found->get<double>();
      if (value >= least && value <= most) return value;  // false if it is no number
    }
    refuse(key, fmt::format("has to be a number from {:g} to {:g}", least, most));
    return 0;
  }
  std::optional<double> number_if_any(const char* key, double least, double most) {
    return member(key) ? std::optional(number(key, least, most)) : std::nullopt;
  }
  int count(const char* key, int least) {
    const json* const found = member(key);
    if (found && found->is_number_integer()) return static_cast<int>(number(key, least, kMostSteps));
    refuse(key, "has to be a whole number");
    return 0;
  }
  Vec3 vector(const char* key, double most) {
    Vec3 value = Vec3::Zero();
    const json* const found = member(key);
    bool good = found && found->is_array() && found->size() == 3;
    for (int i = 0; good && i < 3; ++i) {
      const json& part = (*found)[static_cast<std::size_t>(i)];
      good = part.is_number() && std::abs(part.get<double>()) <= most;
      if (good) value[i] = part.get<double>();
    }
    if (!good) refuse(key, fmt::format("has to be [x, y, z], each at most {:g}", most));
    return value;
  }
  [[nodiscard]] const json* member(const char* key) const {
    const auto it = body_.find(key);
    return it == body_.end() ? nullptr : &*it;
  }
  void refuse(const char* key, const std::string& why) {
    if (wrong_.empty()) wrong_ = fmt::format("\"{}\" {}", key, why);
  }

 private:
  const json& body_;
  std::string wrong_;
};

}  // namespace

bool is_question_id(const std::string& id) {
  return !id.empty() && id.size() <= kLongestId && std::all_of(id.begin(), id.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
  });
}

json to_json(const HandQuestion& question) {
  json out = {{"id", question.id},
              {"text", question.text},
              {"position", array_of(question.position_world_m)},
              {"normal", array_of(question.normal_world)},
              {"step", question.step},
              {"steps", question.steps},
              {"readings", question.readings}};
  if (!question.fixture.empty()) {
    out["fixture"] = question.fixture;
    out["level"] = question.level;
  }
  if (question.known_to) out["known_to"] = *question.known_to;
  if (question.known_to_worst) out["known_to_worst"] = *question.known_to_worst;
  return out;
}

Result<HandQuestion> question_from_json(const json& body) {
  if (!body.is_object()) return refusal("send an object");
  QuestionReader read(body);
  HandQuestion question;
  question.id = read.text("id", kLongestId);
  if (!is_question_id(question.id)) read.refuse("id", "has to be letters, digits, - and _");
  question.text = read.text("text", kLongestPlace);
  question.position_world_m = read.vector("position", kFarthest_m);
  const Vec3 normal = read.vector("normal", kFarthest_m);
  if (!(normal.norm() > 1e-6)) read.refuse("normal", "has to be a direction");
  if (read.member("fixture")) {
    question.fixture = read.text("fixture", kLongestFixture);
    question.level = read.number("level", 0, 1);
  }
  question.steps = read.count("steps", 1);
  question.step = read.count("step", 1);
  if (question.step > question.steps) read.refuse("step", "has to be one of the steps");
  question.readings = read.count("readings", 0);
  question.known_to = read.number_if_any("known_to", 0, kLeastKnown);
  question.known_to_worst = read.number_if_any("known_to_worst", 0, kLeastKnown);
  if (!read.wrong().empty()) return refusal(read.wrong());
  question.normal_world = normal.normalized();
  return question;
}

json to_json(const HandAnswer& answer) {
  const auto* const named =
      std::find_if(std::begin(kWhats), std::end(kWhats), [&](const auto& one) { return one.first == answer.what; });
  json out = {{"what", named == std::end(kWhats) ? "skip" : named->second}};
  if (answer.what == HandAnswer::What::reading) out["lux"] = answer.lux;
  return out;
}

Result<HandAnswer> answer_from_json(const json& body) {
  constexpr const char* kSend =
      "send \"what\": \"reading\" and \"lux\": a number from 0 to {:g}, or \"what\": \"skip\", \"other_place\" or "
      "\"end\"";
  const auto what = body.is_object() ? body.find("what") : body.end();
  if (!body.is_object() || what == body.end() || !what->is_string()) return refusal(fmt::format(kSend, kMostLux));
  const auto* const named = std::find_if(std::begin(kWhats), std::end(kWhats), [&](const auto& one) {
    return what->get_ref<const std::string&>() == one.second;
  });
  if (named == std::end(kWhats)) return refusal(fmt::format(kSend, kMostLux));
  HandAnswer answer{named->first};
  if (answer.what != HandAnswer::What::reading) return answer;
  QuestionReader read(body);
  answer.lux = read.number("lux", 0, kMostLux);
  if (!read.wrong().empty()) return refusal(read.wrong());
  return answer;
}

}  // namespace luxrig
