// A lighting desk that turns a head through a keep-out zone, with the real programs. The lamp is judged by the
// simulator's truth.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tools/programs/live_desk.h"
#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

constexpr double kPan_deg = -90;  ///< towards the audience of tests/rigs/parking
constexpr double kTilt_deg = 60;

/// The head of tests/rigs/parking: slots 1 to 5, ranges 540 and 270 degrees. The lamp stays dark.
test::DeskSlots aims(double pan_deg, double tilt_deg, int dimmer_dmx) {
  const auto coarse_and_fine = [](double share) { return static_cast<int>(std::lround(share * 65535)); };
  const int pan = coarse_and_fine((pan_deg + 270) / 540), tilt = coarse_and_fine((tilt_deg + 135) / 270);
  test::DeskSlots slots(512, 0);
  slots[0] = static_cast<std::uint8_t>(pan >> 8);
  slots[1] = static_cast<std::uint8_t>(pan);
  slots[2] = static_cast<std::uint8_t>(tilt >> 8);
  slots[3] = static_cast<std::uint8_t>(tilt);
  slots[4] = static_cast<std::uint8_t>(dimmer_dmx);
  return slots;
}

/// tests/rigs/parking with a desk that takes over, and seats in the audience whose light the simulator reports.
std::string rig_with_desk(const Folder& folder, const std::string& protocol, int port, bool guarded) {
  std::string text = text_of(source("tests/rigs/parking/rig.toml"));
  text = with_line(text, "driver = \"sacn\"",
                   "driver = \"" + protocol + "\"\ninput = \"takeover\"\ninput_port = " + std::to_string(port));
  if (!guarded) text = text.substr(0, text.find("[[keep_out]]")) + text.substr(text.find("[control]"));
  for (const char* seat : {"[3.2, -1, 1.8]", "[4.5, -1, 1.2]", "[6.5, -1, 0.5]", "[4, -3.5, 1]", "[4, 2, 1]"})
    text +=
        "\n[[point]]\nname = \"seat at " + std::string(seat) + "\"\nposition_m = " + seat + "\nnormal = [-1, 0, 1]\n";
  const auto file = folder / "rig.toml";
  std::ofstream(file) << text;
  return file.string();
}

struct HeadSample {
  double at_s = 0, pan_deg = 0, tilt_deg = 0, level = 0;
};

struct ZoneBench {
  explicit ZoneBench(const std::string& protocol, bool guarded = true)
      : desk(protocol), rig(rig_with_desk(folder, protocol, desk.port(), guarded)) {}

  HeadSample look() {
    const json truth = rig.truth();
    for (const json& f : truth.at("fixtures"))
      if (f["name"] == "head") return {truth["time_s"], f["pan_deg"], f["tilt_deg"], f["level"]};
    return {};
  }
  double max_at_a_seat_lx() {
    double most = 0;
    const json truth = rig.truth();
    for (const json& p : truth.at("points"))
      if (p["name"].get<std::string>().starts_with("seat")) most = std::max(most, p["max_lux_seen"].get<double>());
    return most;
  }
  bool arrives(double pan_deg, double tilt_deg, double level) {
    return wait_for(
        [&] {
          const HeadSample now = look();
          return std::abs(now.pan_deg - pan_deg) < 2 && std::abs(now.tilt_deg - tilt_deg) < 2 &&
                 std::abs(now.level - level) < 0.15;
        },
        15s);
  }
  std::vector<HeadSample> watch(std::chrono::milliseconds how_long) {
    std::vector<HeadSample> samples;
    const auto end = std::chrono::steady_clock::now() + how_long;
    while (std::chrono::steady_clock::now() < end) samples.push_back(look());
    return samples;
  }

  Folder folder;
  LiveDesk desk;
  LiveRig rig;
};

/// Whether the beam's axis is within the field's half angle (10 degrees) of the audience, on a grid of places.
bool lights_the_audience(const HeadSample& head) {
  const auto rad = [](double deg) { return deg * std::numbers::pi / 180; };
  // Pan 0 and tilt 0 point down. Tilt turns towards +y, then pan about the vertical.
  const double out = std::sin(rad(head.tilt_deg));
  const double axis[] = {-out * std::sin(rad(head.pan_deg)), out * std::cos(rad(head.pan_deg)),
                         -std::cos(rad(head.tilt_deg))};
  for (double x = 3; x <= 8; x += 0.25)
    for (double y = -6; y <= 4; y += 0.25)
      for (double z = 0; z <= 2; z += 0.25) {
        const double to[] = {x, y + 1, z - 4};
        const double length = std::hypot(to[0], to[1], to[2]);
        if ((axis[0] * to[0] + axis[1] * to[1] + axis[2] * to[2]) / length > std::cos(rad(10))) return true;
      }
  return false;
}

/// 8-bit steps, and the rest of a lamp's afterglow.
constexpr double kDark = 0.03;

class DeskAndZone : public ::testing::TestWithParam<const char*> {};

TEST_P(DeskAndZone, AHeadTurnedThroughAZoneIsDarkWhileItCrosses) {
  // Light on the seats with an unguarded head: shows that this test can fail.
  double unguarded_lx = 0;
  {
    ZoneBench open(GetParam(), false);
    ASSERT_TRUE(open.rig.wait_phase("holding", 60s)) << open.rig.daemon().output();
    open.desk.set(aims(kPan_deg + 80, kTilt_deg, 255));
    open.desk.appear();
    ASSERT_TRUE(open.arrives(kPan_deg + 80, kTilt_deg, 0.95)) << open.rig.truth();
    open.rig.reset_peaks();
    open.desk.set(aims(kPan_deg - 80, kTilt_deg, 255));
    ASSERT_TRUE(open.arrives(kPan_deg - 80, kTilt_deg, 0.95)) << open.rig.truth();
    unguarded_lx = open.max_at_a_seat_lx();
    ASSERT_GT(unguarded_lx, 50);
  }
  ZoneBench bench(GetParam());
  ASSERT_TRUE(bench.rig.wait_phase("holding", 60s)) << bench.rig.daemon().output();
  bench.desk.set(aims(kPan_deg + 80, kTilt_deg, 255));
  bench.desk.appear();
  ASSERT_TRUE(bench.arrives(kPan_deg + 80, kTilt_deg, 0.95)) << bench.rig.truth();
  bench.rig.reset_peaks();
  double side = -1;
  for (const bool step_by_step : {false, true, false}) {
    const double from_deg = kPan_deg - side * 80, to_deg = kPan_deg + side * 80;
    std::vector<HeadSample> samples;
    for (int step = 1; step_by_step && step < 60; ++step) {
      bench.desk.set(aims(from_deg + (to_deg - from_deg) * step / 60, kTilt_deg, 255));
      const auto some = bench.watch(50ms);
      samples.insert(samples.end(), some.begin(), some.end());
    }
    bench.desk.set(aims(to_deg, kTilt_deg, 255));
    const auto rest = bench.watch(5s);
    samples.insert(samples.end(), rest.begin(), rest.end());
    int crossing = 0;
    for (const HeadSample& now : samples) {
      if (!lights_the_audience(now)) continue;
      ++crossing;
      EXPECT_LT(now.level, kDark) << "at " << now.pan_deg << " deg, " << now.at_s << " s";
    }
    EXPECT_GT(crossing, 3) << "it must have crossed";
    EXPECT_NEAR(samples.back().pan_deg, to_deg, 1);
    EXPECT_GT(samples.back().level, 0.8) << "light comes back";
    side = -side;
  }
  EXPECT_LT(bench.max_at_a_seat_lx(), 0.12 * unguarded_lx) << "of " << unguarded_lx;
}

TEST_P(DeskAndZone, AHeadThatADeskKeepsAimedIntoAZoneStaysDark) {
  ZoneBench bench(GetParam());
  ASSERT_TRUE(bench.rig.wait_phase("holding", 60s)) << bench.rig.daemon().output();
  // Near a zone, the head lights up only once it can be nowhere but at its aim.
  ASSERT_TRUE(wait_for([&] { return bench.look().level > 0.01; }, 10s)) << bench.rig.truth();
  std::this_thread::sleep_for(1s);
  const HeadSample planned = bench.look();
  // The desk appears already aiming into the zone.
  bench.rig.reset_peaks();
  bench.desk.set(aims(kPan_deg, kTilt_deg, 255));
  bench.desk.appear();
  ASSERT_TRUE(bench.arrives(kPan_deg, kTilt_deg, 0)) << bench.rig.truth();
  for (const HeadSample& now : bench.watch(3s)) EXPECT_LT(now.level, kDark) << now.at_s;
  const auto reported = [](const json& s) {
    const json& head = s["fixtures"][0];
    const bool kept = head.value("kept_dark", false) &&
                      head.value("waits_for", "") == "another aim: it looks into keep-out zone \"audience\"";
    return kept && std::any_of(s["alarms"].begin(), s["alarms"].end(), [](const json& alarm) {
             return alarm["text"] == "head looks into keep-out zone \"audience\" and stays dark; turn it elsewhere";
           });
  };
  EXPECT_TRUE(bench.rig.wait_status(reported, 3s)) << bench.rig.last();
  // At another aim it is lit.
  bench.desk.set(aims(kPan_deg + 80, kTilt_deg, 255));
  EXPECT_TRUE(bench.arrives(kPan_deg + 80, kTilt_deg, 0.95)) << bench.rig.truth();
  EXPECT_TRUE(bench.rig.wait_status([&](const json& s) { return !reported(s) && s["alarms"].empty(); }, 3s))
      << bench.rig.last();
  // Back into the zone, then the desk is lost: Luxrig turns the head to its own aim and lights it there.
  bench.desk.set(aims(kPan_deg, kTilt_deg, 255));
  ASSERT_TRUE(bench.arrives(kPan_deg, kTilt_deg, 0)) << bench.rig.truth();
  bench.desk.vanish();
  const auto own = [&] {
    const HeadSample now = bench.look();
    EXPECT_FALSE(lights_the_audience(now) && now.level > kDark) << now.pan_deg << " at " << now.at_s;
    return std::abs(now.pan_deg - planned.pan_deg) < 2 && std::abs(now.tilt_deg - planned.tilt_deg) < 2 &&
           now.level > 0.8 * planned.level;
  };
  EXPECT_TRUE(wait_for(own, 25s)) << bench.rig.truth();
  // The daemon dies while a desk aims there: the guardian's hold and fade light no zone.
  bench.desk.appear();
  ASSERT_TRUE(bench.arrives(kPan_deg, kTilt_deg, 0)) << bench.rig.truth();
  bench.rig.daemon().signal(SIGKILL);
  for (const HeadSample& now : bench.watch(4s)) EXPECT_LT(now.level, kDark) << now.at_s;
}

INSTANTIATE_TEST_SUITE_P(Protocols, DeskAndZone, ::testing::Values("sacn", "artnet"),
                         [](const auto& which) { return std::string(which.param); });

}  // namespace
}  // namespace luxrig::testing
