// Questions and answers over the wire: what was written is read back, and what is none is refused.
#include "tools/luxrigd/api/question_json.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace luxrig {
namespace {

using nlohmann::json;

HandQuestion full_question() {
  HandQuestion question;
  question.id = "0a1b-3";
  question.text = "Hold the luxmeter at \"Würde\": 1.20 m high, facing up.";
  question.position_world_m = {1, -2.5, 1.2};
  question.normal_world = Vec3(0, 3, 4) / 5;
  question.fixture = "wash/red";
  question.level = 0.62;
  question.step = 2;
  question.steps = 5;
  question.readings = 3;
  question.known_to = 0.12;
  question.known_to_worst = 0.2;
  return question;
}

TEST(QuestionJson, IsReadAsItWasWritten) {
  for (const bool dark : {false, true}) {
    HandQuestion question = full_question();
    if (dark) question.fixture.clear();
    const auto read = question_from_json(to_json(question));
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(read->id, question.id);
    EXPECT_EQ(read->text, question.text);
    EXPECT_EQ(read->position_world_m, question.position_world_m);
    EXPECT_LT((read->normal_world - question.normal_world).norm(), 1e-12);
    EXPECT_EQ(read->fixture, question.fixture);
    EXPECT_EQ(read->level, dark ? 0 : 0.62);
    EXPECT_EQ(read->step, 2);
    EXPECT_EQ(read->steps, 5);
    EXPECT_EQ(read->readings, 3);
    EXPECT_EQ(read->known_to, 0.12);
    EXPECT_EQ(read->known_to_worst, 0.2);
  }
}

/// What is said of the full question with one member changed.
std::string refused(const char* key, const json& instead) {
  json body = to_json(full_question());
  body[key] = instead;
  const auto read = question_from_json(body);
  return read ? "taken" : read.error().detail;
}

TEST(QuestionJson, WhatIsNoQuestionIsRefusedByItsKey) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<const char*, std::vector<json>>> wrong = {
      {"id", {"", "a b", "a\n", "ä", std::string(41, 'a'), 7, nullptr}},
      {"text", {"", "a\x1b[2J", "two\nlines", "\xff", std::string(401, 'a'), 7, json::array()}},
      {"position", {"here", {1, 2}, {1, 2, 3, 4}, {1, 2, "3"}, {1, 2, nan}, {1, 2, inf}, {1, 2, 1e6}}},
      {"normal", {7, {0, 0, 0}, {0, 0, nan}, {0, 1e300, 0}}},
      {"fixture", {"", 7, std::string(300, 'a'), "a\n"}},
      {"level", {-0.1, 1.1, nan, "full", nullptr}},
      {"step", {0, 6, 1.5, "1", -1, nullptr}},
      {"steps", {0, 1.5, 1e12, 10'000'000, "5"}},
      {"readings", {-1, 0.5, "3", 4'294'967'296, json::array()}},
      {"known_to", {-0.1, nan, inf, "12 %", 1e9}},
      {"known_to_worst", {-0.1, nan, "12 %"}},
  };
  EXPECT_EQ(refused("readings", 4), "taken");
  for (const auto& [key, values] : wrong)
    for (const json& value : values)
      EXPECT_NE(refused(key, value).find('"' + std::string(key) + '"'), std::string::npos)
          << key << ": " << value.dump(-1, ' ', false, json::error_handler_t::replace) << ": " << refused(key, value);
  for (const json& body : {json(), json(7), json::array(), json("question"), json(json::value_t::discarded)})
    EXPECT_FALSE(question_from_json(body));
}

TEST(AnswerJson, IsReadAsItWasWritten) {
  using What = HandAnswer::What;
  for (const HandAnswer& answer : {HandAnswer{What::reading, 182.5}, HandAnswer{What::reading, 0},
                                   HandAnswer{What::skip}, HandAnswer{What::other_place}, HandAnswer{What::done}}) {
    const auto read = answer_from_json(to_json(answer));
    ASSERT_TRUE(read) << read.error().detail;
    EXPECT_EQ(*read, answer);
  }
}

TEST(AnswerJson, WhatIsNoLightIsNoAnswer) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const json& body :
       {json(), json(7), json::array({"what"}), json{{"lux", 1}}, json{{"what", 1}}, json{{"what", "dance"}},
        json{{"what", "reading"}}, json{{"what", "reading"}, {"lux", -1}}, json{{"what", "reading"}, {"lux", nan}},
        json{{"what", "reading"}, {"lux", 1e9}}, json{{"what", "reading"}, {"lux", "182"}},
        json{{"what", "reading"}, {"lux", nullptr}}, json{{"what", "from_file"}}})
    EXPECT_FALSE(answer_from_json(body)) << body.dump();
}

}  // namespace
}  // namespace luxrig
