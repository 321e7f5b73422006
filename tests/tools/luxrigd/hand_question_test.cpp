#include "tools/luxrigd/hand_question.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

using namespace std::chrono_literals;

constexpr HandAnswer kSkip{HandAnswer::What::skip};

HandAnswer reading(double lux) { return {HandAnswer::What::reading, lux}; }

HandQuestion question(const std::string& id) {
  HandQuestion one;
  one.id = id;
  one.text = "hold it here";
  return one;
}

class QuestionBoardTest : public ::testing::Test {
 protected:
  Time at{};
  QuestionBoard board;
};

TEST_F(QuestionBoardTest, AnAnswerReachesWhoeverAsksAgain) {
  EXPECT_FALSE(board.present(at));
  EXPECT_FALSE(board.ask(question("a"), 45s, at));
  ASSERT_TRUE(board.present(at));
  EXPECT_FALSE(board.present(at)->answer);
  EXPECT_TRUE(board.answer("a", reading(182.5), at));
  EXPECT_EQ(board.present(at)->answer, reading(182.5));
  EXPECT_EQ(board.ask(question("a"), 45s, at), reading(182.5));
}

TEST_F(QuestionBoardTest, TheFirstAnswerCountsAndTheSameAgainIsNoFault) {
  board.ask(question("a"), 45s, at);
  EXPECT_TRUE(board.answer("a", reading(182.5), at));
  EXPECT_TRUE(board.answer("a", reading(182.5), at));
  for (const HandAnswer& other : {reading(182.4), kSkip}) {
    const auto refused = board.answer("a", other, at);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().detail.find("already"), std::string::npos);
  }
  EXPECT_EQ(board.ask(question("a"), 45s, at), reading(182.5));
}

TEST_F(QuestionBoardTest, AnAnswerToAnOlderQuestionIsRefused) {
  EXPECT_FALSE(board.answer("a", reading(1), at));
  board.ask(question("a"), 45s, at);
  EXPECT_TRUE(board.answer("a", reading(1), at));
  EXPECT_FALSE(board.ask(question("b"), 45s, at)) << "the answer was to the other question";
  EXPECT_FALSE(board.answer("a", reading(1), at));
  EXPECT_FALSE(board.present(at)->answer);
}

TEST_F(QuestionBoardTest, IsGoneByItselfUnlessItIsAskedAgain) {
  board.ask(question("a"), 45s, at);
  EXPECT_TRUE(board.present(at + 44s));
  board.ask(question("a"), 45s, at + 44s);
  EXPECT_TRUE(board.present(at + 88s));
  EXPECT_FALSE(board.present(at + 89s));
  EXPECT_FALSE(board.answer("a", kSkip, at + 89s)) << "nobody waits for it";
}

TEST_F(QuestionBoardTest, AnAnswerThatWasTakenIsNotLostWhenTheClientComesLate) {
  board.ask(question("a"), 45s, at);
  EXPECT_TRUE(board.answer("a", reading(7), at + 44s));
  EXPECT_EQ(board.ask(question("a"), 45s, at + 100s), reading(7));
}

TEST_F(QuestionBoardTest, OnlyItsOwnIdWithdrawsIt) {
  board.ask(question("a"), 45s, at);
  board.withdraw("b");
  EXPECT_TRUE(board.present(at));
  board.withdraw("a");
  EXPECT_FALSE(board.present(at));
}

}  // namespace
}  // namespace luxrig
