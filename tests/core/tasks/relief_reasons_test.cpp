#include "core/tasks/relief_reasons.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace luxrig {
namespace {

AimScore score_of(double fine, double form, double lit, double edge) {
  AimScore score;
  score.seen = SeenScore{};
  score.seen->fine = fine;
  score.seen->form = form;
  score.seen->lit_share = lit;
  score.seen->edge = edge;
  score.mean_lx = 100;
  return score;
}

/// Without the first 0.3 of the lit share goes, without the second 0.1, and 0.02 of the outline comes.
ReliefReasons two_lights() {
  ReliefReasons reasons;
  reasons.task = "look";
  reasons.seen = true;
  reasons.score = score_of(0.2, 0.1, 0.8, 0.3);
  const AimScore without_key = score_of(0.05, 0.1, 0.5, 0.3), without_fill = score_of(0.2, 0.04, 0.7, 0.32);
  reasons.lights = services_of(reasons.score, {{"key", 1, &without_key}, {"fill", 0.2, &without_fill}});
  return reasons;
}

TEST(ReliefReasons, ServicesAreSharesOfWhatGoes) {
  const ReliefReasons reasons = two_lights();
  const LightService &key = reasons.lights[0], &fill = reasons.lights[1];
  EXPECT_NEAR(key.lit, 0.75, 1e-9);
  EXPECT_NEAR(fill.lit, 0.25, 1e-9);
  EXPECT_NEAR(key.fine, 1, 1e-9);
  EXPECT_NEAR(fill.fine, 0, 1e-9);
  EXPECT_NEAR(fill.form, 1, 1e-9);
  EXPECT_EQ(key.edge, 0);  // nothing of it goes with either
  EXPECT_EQ(fill.edge, 0);
}

TEST(ReliefReasons, TwoSentencesNameTheFigures) {
  ReliefReasons reasons = two_lights();
  reasons.before = score_of(0.1, 0.1, 0.7, 0.3);
  EXPECT_EQ(
      in_two_sentences(reasons),
      "80 % of what is seen is lit and 0 % is burnt or black (70 % and 0 % before); most changed is fine relief, by "
      "+100 %. key serves fine relief (100 %) and lit surface (75 %) and fill serves broad form (100 %) and lit "
      "surface (25 %).");
}

TEST(ReliefReasons, OfDimmedLightsSayNothingOfWhatWasSeenUndimmed) {
  ReliefReasons reasons = two_lights();
  reasons.dimmed_to = 0.43;
  reasons.score.seen.reset();
  reasons.score.local_contrast_lx = 12.3;
  reasons.score.coverage = 0.5;
  const std::string words = in_two_sentences(reasons);
  EXPECT_EQ(words.substr(0, words.find(". ")),
            "A limit dims these lights to 43 % of the levels that they were judged at: recessed places differ from "
            "what is beside them by 12.3 lx, and 50 % of the features have a shadow's edge");
}

TEST(ReliefReasons, DarkLightsAreSaidWithTheirFigure) {
  ReliefReasons reasons = two_lights();
  EXPECT_EQ(dark_in_words(reasons), "");
  reasons.dark = 1;
  reasons.gain_of_dark = -0.0123;
  EXPECT_EQ(
      dark_in_words(reasons),
      "2 lights are enough, 1 stays dark: lit in the best of the ways tried, one more would change what is seen by "
      "-0.0123");
  reasons.gain_of_dark.reset();
  EXPECT_EQ(dark_in_words(reasons), "2 lights are enough, 1 stays dark: the limits leave more of them no light");
}

}  // namespace
}  // namespace luxrig
