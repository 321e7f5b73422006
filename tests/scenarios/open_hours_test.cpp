// Calibrating while visitors are there (core/calibration/open_run.h): the show holds the look, and in the truth of a rig
// that is not as its file says no step changes the light anywhere by more than 2 %.
#include <gtest/gtest.h>

#include "core/calibration/open_run.h"
#include "tests/scenarios/closed_loop.h"

namespace luxrig::scenarios {
namespace {

constexpr double kFade_s = 1, kDwell_s = 3.3, kHalfAnHour_s = 30 * 60;

Hall hall_with_fine_channels(std::uint64_t seed) {
  Hall hall = make_hall(seed);
  for (Fixture& fixture : hall.rig.fixtures)
    if (std::holds_alternative<DmxPatch>(fixture.patch))
      fixture.patch = DmxPatch{1, 1, {DmxSlot{SlotUse::dimmer}, DmxSlot{SlotUse::dimmer_fine}}};
  return hall;
}

/// Dimmers and luxmeters of the field, and nobody in the room: what moves the light is the rig.
sim::Deviations real_curves(std::uint64_t seed) {
  const sim::Deviations real = sim::Deviations::real();
  sim::Deviations deviations = seeded(seed);
  deviations.drive_exponent_min = real.drive_exponent_min;
  deviations.drive_exponent_max = real.drive_exponent_max;
  deviations.dead_band = real.dead_band;
  deviations.tail = real.tail;
  deviations.warm_up_share = real.warm_up_share;
  deviations.meter_noise = real.meter_noise;
  deviations.meter_latency_min_s = real.meter_latency_min_s;
  deviations.meter_latency_max_s = real.meter_latency_max_s;
  return deviations;
}

std::vector<double> true_lux(ClosedLoop& loop) {
  std::vector<double> lux;
  for (const sim::PointTruth& point : loop.devices.world().points()) lux.push_back(point.lux);
  return lux;
}

std::vector<ByHand> all_at(const ClosedLoop& loop, const std::vector<double>& level) {
  std::vector<ByHand> held;
  for (std::size_t f = 0; f < level.size(); ++f) {
    ByHand one;
    one.index = f;
    one.value = level[f];
    one.since = loop.now;
    one.until = loop.now + from_seconds(45);
    held.push_back(one);
  }
  return held;
}

/// Such dimmers are so far from what the file says that these shows correct all the time, by tens of percent. A limit
/// comes first: where it takes light, the run goes on from what is left, as `luxrig calibrate --hours open` does.
TEST(OpenHours, InTruthNoStepChangesTheLightByMoreThanTwoPercentAndTheShowKeepsStill) {
  constexpr int kRounds = 24;
  int told = 0, undisturbed = 0;
  double most = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    ClosedLoop loop(hall_with_fine_channels(seed), real_curves(seed));
    loop.apply();
    ASSERT_TRUE(loop.run_until(Phase::holding, 60)) << loop.describe();
    loop.run(20);
    const double begun_s = loop.seconds();
    std::vector<double> before = true_lux(loop), sent_before = loop.levels();
    std::vector<OpenRun> runs{OpenRun(loop.hall.rig, sent_before, kRounds)};
    const std::size_t steps = runs.front().plan().size();
    for (std::size_t k = 0; k < steps && loop.seconds() - begun_s + 3 * kDwell_s < kHalfAnHour_s; ++k) {
      OpenRun& run = runs.back();
      if (run.plan().empty()) break;
      ASSERT_TRUE(loop.show.hold(loop.now, all_at(loop, run.plan()[run.steps_taken()]), {{}, kFade_s, true}));
      // The way there counts, too, until a limit takes more than a hair.
      double largest = 0;
      const bool limited = loop.run_until(
          [&] {
            if (!run.is_small_step(sent_before, loop.levels())) return true;
            const std::vector<double> now = true_lux(loop);
            for (std::size_t p = 0; p < now.size(); ++p)
              if (before[p] > 0) largest = std::max(largest, std::abs(now[p] / before[p] - 1));
            return false;
          },
          kFade_s + kDwell_s);
      if (limited) {
        ASSERT_TRUE(loop.run_until([&] { return loop.show.program().done(loop.now); }, 5));
        ASSERT_TRUE(loop.show.hold(loop.now, all_at(loop, loop.levels()), {{}, kFade_s, true}));
        loop.run(kFade_s + kDwell_s);
        runs.emplace_back(loop.hall.rig, loop.levels(), kRounds);
      }
      sent_before = loop.levels();
      before = true_lux(loop);
      if (limited) continue;
      ASSERT_LE(largest, OpenRun::kLargestStep) << "seed " << seed << ", step " << k << "\n" << loop.describe();
      most = std::max(most, largest);
      std::vector<std::optional<SteadyReading>> readings;
      for (const auto& shown : loop.status().shown)
        readings.push_back(shown ? std::optional(SteadyReading{shown->lux, 0.02 * shown->lux}) : std::nullopt);
      run.take(loop.levels(), readings);
    }
    EXPECT_LE(loop.seconds() - begun_s, kHalfAnHour_s);
    undisturbed += runs.size() == 1;
    told += std::any_of(runs.begin(), runs.end(), [](const OpenRun& run) { return !run.readings(0).empty(); });
  }
  EXPECT_GE(undisturbed, 3);  // the rest is limited by what its meters seem to say
  EXPECT_EQ(told, 10);
  EXPECT_GT(most, 0.5 * OpenRun::kLargestStep);
}

}  // namespace
}  // namespace luxrig::scenarios
