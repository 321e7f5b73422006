#include "tools/luxrig/calibrate/hand_answer.h"

#include <gtest/gtest.h>

namespace luxrig {
namespace {

TEST(HandAnswer, IsAReadingInAnyOfTheUsualForms) {
  for (const char* typed : {"182.5", " 182.5\r", "182,5", "182.5 lx", "182.5lux", "1.825e2"}) {
    const auto answer = hand_answer(typed);
    ASSERT_TRUE(answer) << typed;
    EXPECT_EQ(answer->what, HandAnswer::What::reading) << typed;
    EXPECT_DOUBLE_EQ(answer->lux, 182.5) << typed;
  }
  EXPECT_EQ(hand_answer("0")->lux, 0);
}

TEST(HandAnswer, WhatIsNoLightIsNoReading) {
  for (const char* typed :
       {"-1", "nan", "inf", "1e9", "12 13", "1,000.5", "1,2,3", "lx", "+5", "0x10", "182.5 cd", "quiet"})
    EXPECT_FALSE(hand_answer(typed)) << typed;
}

TEST(HandAnswer, ALetterOrNothingSaysWhatToDo) {
  EXPECT_EQ(hand_answer("")->what, HandAnswer::What::from_file);
  EXPECT_EQ(hand_answer(" s ")->what, HandAnswer::What::skip);
  EXPECT_EQ(hand_answer("n")->what, HandAnswer::What::other_place);
  EXPECT_EQ(hand_answer("q")->what, HandAnswer::What::done);
}

TEST(LastReading, IsTheLastNumberOfTheLastLine) {
  EXPECT_EQ(last_reading("12\n182.5\n\n"), 182.5);
  EXPECT_EQ(last_reading("2026-11-28 12:01:07;E;182.4 lx\n2026-11-28 12:01:08;E;182.6 lx\n"), 182.6);
  EXPECT_EQ(last_reading("12:01:08\t182,6"), 182.6);
  EXPECT_EQ(last_reading("12:01:08 E= 182.6 lx"), 182.6);
  EXPECT_EQ(last_reading(""), std::nullopt);
  EXPECT_EQ(last_reading("182.6\noverload\n"), std::nullopt) << "an old reading is not the present one";
}

}  // namespace
}  // namespace luxrig
