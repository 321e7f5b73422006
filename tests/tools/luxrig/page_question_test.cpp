// The client's side of a question on the page, against the daemon's routes over a real socket.
#include "tools/luxrig/calibrate/page_question.h"

#include <gtest/gtest.h>

#include <memory>

#include "tools/luxrigd/api/http_api.h"
#include "tools/process/clock.h"
#include "tools/process/meeting_place.h"

namespace luxrig {
namespace {

constexpr HandAnswer kAnotherPlace{HandAnswer::What::other_place}, kReading{HandAnswer::What::reading, 182.5};

class PageQuestionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    HttpHandlers handlers;
    handlers.question = [this](const HandQuestion& question, double seconds) {
      return board.ask(question, from_seconds(seconds), now());
    };
    handlers.withdraw_question = [this](const std::string& id) { board.withdraw(id); };
    handlers.answer = [this](const std::string& id, const HandAnswer& answer) {
      return board.answer(id, answer, now());
    };
    api = std::make_unique<HttpApi>(std::move(handlers), "/nonexistent");
    DaemonSpec where;
    where.http_port = 0;
    const auto port = api->start(where);
    ASSERT_TRUE(port) << port.error().detail;
    const auto daemon = daemon_on(*port);
    ASSERT_TRUE(daemon) << daemon.error().detail;
    page = std::make_unique<PageQuestion>(*daemon, 45);
  }
  static HandQuestion at(const std::string& place) {
    HandQuestion question;
    question.text = "Hold the luxmeter at " + place;
    return question;
  }
  std::string asked_id() { return board.present(now()).value_or(AskedQuestion{}).question.id; }

  QuestionBoard board;
  std::unique_ptr<HttpApi> api;
  std::unique_ptr<PageQuestion> page;
};

TEST_F(PageQuestionTest, IsOnThePageUntilItHasItsAnswerThere) {
  page->put(at("the desk"));
  EXPECT_FALSE(page->look());
  EXPECT_EQ(page->why_not(), "");
  ASSERT_TRUE(board.present(now()));
  EXPECT_EQ(board.present(now())->question.text, "Hold the luxmeter at the desk");
  const std::string first = asked_id();
  ASSERT_TRUE(board.answer(first, kReading, now()));
  EXPECT_EQ(page->look(), kReading);
  page->put(at("the door"));
  EXPECT_FALSE(page->look()) << "the answer was to the question before";
  EXPECT_NE(asked_id(), first);
}

TEST_F(PageQuestionTest, AnAnswerGivenElsewhereIsShownThere) {
  page->put(at("the desk"));
  EXPECT_EQ(page->settle(kReading), kReading) << "before the page has asked";
  ASSERT_TRUE(board.present(now()));
  EXPECT_EQ(board.present(now())->answer, kReading);
  EXPECT_FALSE(board.answer(asked_id(), kAnotherPlace, now()));
}

TEST_F(PageQuestionTest, OfTwoAnswersTheFirstCounts) {
  page->put(at("the desk"));
  EXPECT_FALSE(page->look());
  ASSERT_TRUE(board.answer(asked_id(), kAnotherPlace, now()));
  EXPECT_EQ(page->settle(kReading), kAnotherPlace);
  EXPECT_EQ(board.present(now())->answer, kAnotherPlace);
}

TEST_F(PageQuestionTest, LeavesNothingBehind) {
  page->put(at("the desk"));
  EXPECT_FALSE(page->look());
  EXPECT_TRUE(board.present(now()));
  page.reset();
  EXPECT_FALSE(board.present(now()));
}

TEST_F(PageQuestionTest, WhatThePageCannotAskIsAskedElsewhere) {
  page->put(at("a place\nin two lines"));
  EXPECT_FALSE(page->look());
  EXPECT_NE(page->why_not().find("\"text\""), std::string::npos) << page->why_not();
  EXPECT_EQ(page->settle(kReading), kReading);
  EXPECT_FALSE(board.present(now()));
  api->stop();
  EXPECT_FALSE(page->look());
  EXPECT_EQ(page->settle(kReading), kReading);
}

}  // namespace
}  // namespace luxrig
