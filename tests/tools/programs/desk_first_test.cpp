// A daemon that starts beside a lighting desk which already drives the lamps, with the real programs. In the
// simulator's truth the lamps never leave the desk's values. And a daemon that starts without a desk.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tools/programs/live_desk.h"
#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

/// tests/rigs/parking with a desk in standby, or one that takes over, and without keep-out zones.
std::string room_with_desk(const Folder& folder, const std::string& protocol, const std::string& input, int port) {
  const std::string text =
      with_line(text_of(source("tests/rigs/parking/rig.toml")), "driver = \"sacn\"",
                "driver = \"" + protocol + "\"\ninput = \"" + input + "\"\ninput_port = " + std::to_string(port));
  const auto file = folder / "rig.toml";
  std::ofstream(file) << text.substr(0, text.find("[[keep_out]]")) + text.substr(text.find("[control]"));
  return file.string();
}

struct DeskFirst {
  DeskFirst(const std::string& protocol, const std::string& input, std::vector<std::string> options)
      : desk(protocol), rig(room_with_desk(folder, protocol, input, desk.port()), std::move(options)) {}
  double bulb() {
    const json truth = rig.truth();
    for (const json& f : truth.value("fixtures", json::array()))
      if (f["name"] == "bulb") return f["level"];
    return -1;
  }
  /// Extremes of the lamp until the status condition holds, and for one second more.
  struct Extremes {
    double least = 1, most = 0, largest_step = 0, first_lit_s = -1;
    bool reached = false;
  };
  Extremes watch(const std::function<bool(const json&)>& until, std::chrono::seconds bound) {
    using clock = std::chrono::steady_clock;
    Extremes seen;
    const auto begun = clock::now();
    auto end = begun + bound, asked = begun, looked = begun;
    double last = bulb();
    while (clock::now() < end) {
      const double level = bulb();
      const auto at = clock::now();
      seen.least = std::min(seen.least, level);
      seen.most = std::max(seen.most, level);
      // A machine that stalls for a while sees much of a fade at once.
      if (at - looked < 50ms) seen.largest_step = std::max(seen.largest_step, std::abs(level - last));
      if (seen.first_lit_s < 0 && level > 0.004) seen.first_lit_s = std::chrono::duration<double>(at - begun).count();
      last = level;
      looked = at;
      if (!seen.reached && at - asked > 100ms) {
        asked = at;
        const json status = rig.status();
        seen.reached = status.is_object() && status.contains("desks") && until(status);
        if (seen.reached) end = std::min(end, at + 1s);
      }
      std::this_thread::sleep_for(4ms);
    }
    return seen;
  }

  Folder folder;
  LiveDesk desk;
  LiveRig rig;
};

bool follows(const json& status) {
  return status["phase"] != "idle" && status["desks"][0]["phase"] == "following" && status["desks"][0]["heard"];
}

class DeskThere : public ::testing::TestWithParam<const char*> {};

/// The desk sends to the lamps and to Luxrig, as a multicast would.
TEST_P(DeskThere, ANewDaemonInStandbySendsNoFrameBesideADesk) {
  for (const bool guarded : {false, true}) {
    DeskFirst bench(GetParam(), "standby",
                    guarded ? std::vector<std::string>{} : std::vector{std::string("--no-guardian")});
    ASSERT_TRUE(bench.rig.wait_phase("holding", 60s)) << bench.rig.daemon().output();
    const double own = bench.bulb();
    ASSERT_GT(own, 0.3);
    test::DeskSlots slots(512, 0);
    slots[19] = 51;
    bench.desk.set(slots);
    bench.desk.also_send_to(bench.rig.bus_port("dmx"));
    // At full frame rate, then at the slow rate at which a desk repeats an unchanged frame.
    for (const auto period : {25ms, 900ms}) {
      bench.desk.appear(period);
      ASSERT_TRUE(
          bench.rig.wait_status([](const json& s) { return follows(s) && s["desks"][0]["silent"].get<bool>(); }, 10s))
          << bench.rig.last();
      ASSERT_TRUE(wait_for([&] { return bench.bulb() < 0.25; }, 15s)) << bench.rig.truth();
      std::this_thread::sleep_for(300ms);
      const double desks = bench.bulb();
      ASSERT_GT(desks, 0.1);
      bench.rig.daemon().signal(SIGKILL);
      std::this_thread::sleep_for(500ms);
      bench.rig.start_daemon();
      const auto seen = bench.watch(follows, 30s);
      EXPECT_TRUE(seen.reached) << bench.rig.last();
      EXPECT_NEAR(seen.least, desks, 0.01) << guarded;
      EXPECT_NEAR(seen.most, desks, 0.01) << guarded << ", its own light is " << own;
      bench.desk.vanish();
      if (period == 25ms) {
        ASSERT_TRUE(wait_for([&] { return std::abs(bench.bulb() - own) < 0.03; }, 25s)) << bench.rig.truth();
      }
    }
  }
}

/// The desk sends only to Luxrig: a new daemon sends nothing until it knows the desk's values.
TEST_P(DeskThere, ADeskThatTookOverKeepsTheLightAcrossADaemonRestart) {
  DeskFirst bench(GetParam(), "takeover", {});
  ASSERT_TRUE(bench.rig.wait_phase("holding", 60s)) << bench.rig.daemon().output();
  test::DeskSlots slots(512, 0);
  slots[19] = 51;
  bench.desk.set(slots);
  bench.desk.appear();
  ASSERT_TRUE(bench.rig.wait_status(follows, 10s)) << bench.rig.last();
  ASSERT_TRUE(wait_for([&] { return bench.bulb() < 0.25; }, 10s)) << bench.rig.truth();
  std::this_thread::sleep_for(700ms);
  const double desks = bench.bulb();
  bench.rig.daemon().signal(SIGKILL);
  bench.rig.start_daemon();
  const auto seen = bench.watch(follows, 30s);
  EXPECT_TRUE(seen.reached) << bench.rig.last();
  EXPECT_GT(seen.least, 0.8 * desks);
  EXPECT_LT(seen.largest_step, 0.15);
  EXPECT_NEAR(bench.bulb(), desks, 0.01);
}

TEST_P(DeskThere, TheLightFadesInAfterListeningWithoutADesk) {
  DeskFirst bench(GetParam(), "standby", {"--no-guardian"});
  const auto seen = bench.watch([](const json& s) { return s["phase"] == "holding"; }, 60s);
  ASSERT_TRUE(seen.reached) << bench.rig.daemon().output();
  EXPECT_GT(seen.most, 0.3);
  EXPECT_LT(seen.largest_step, 0.2) << "a fade of half a second, seen every 50 ms";
  // It listens for 2.5 s (sACN) or 4 s (Art-Net) from the first cycle on.
  EXPECT_GT(seen.first_lit_s, std::string(GetParam()) == "sacn" ? 2.4 : 3.9);
}

INSTANTIATE_TEST_SUITE_P(Protocols, DeskThere, ::testing::Values("sacn", "artnet"),
                         [](const auto& which) { return std::string(which.param); });

}  // namespace
}  // namespace luxrig::testing
