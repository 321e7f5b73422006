// A daemon that is stopped, hung up, cut off and attacked keeps its promises.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

double min_level(const json& truth) {
  double least = 1;
  for (const json& f : truth.at("fixtures")) least = std::min(least, f["level"].get<double>());
  return least;
}

// Silent for 5 s; one of these lamps goes dark after 2 s without data.
TEST(LeftAlone, AFrozenDaemonLeavesTheLightToItsGuardianAndTakesItBack) {
  LiveRig rig(source("tests/rigs/without-data"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1; }, 5s)) << rig.daemon().output();
  const pid_t guardian = rig.guardian_pid();
  std::this_thread::sleep_for(1s);
  const double lit = min_level(rig.truth());
  ASSERT_GT(lit, 0.01);
  rig.daemon().signal(SIGSTOP);
  const auto stopped = std::chrono::steady_clock::now();
  double least = 1;
  while (std::chrono::steady_clock::now() - stopped < 5s) {
    least = std::min(least, min_level(rig.truth()));
    std::this_thread::sleep_for(50ms);
  }
  rig.daemon().signal(SIGCONT);
  EXPECT_GT(least, 0.5 * std::min(lit, 0.1)) << "neither dark nor below the safe look";
  ASSERT_TRUE(rig.wait_status([](const json& s) { return has_alarm(s, "stood still"); }, 10s)) << rig.last().dump(1);
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.last().dump(1);
  EXPECT_TRUE(wait_for([&] { return rig.guardian_pid() > 1 && rig.guardian_pid() != guardian; }, 10s))
      << "it is looked after again";
  EXPECT_FALSE(runs(guardian)) << "only one of them sends";
}

TEST(LeftAlone, AFrozenGuardianIsReplaced) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1; }, 5s)) << rig.daemon().output();
  const pid_t first = rig.guardian_pid();
  std::this_thread::sleep_for(1s);  // it watches by now
  ASSERT_EQ(::kill(first, SIGSTOP), 0);
  EXPECT_TRUE(wait_for([&] { return rig.guardian_pid() > 1 && rig.guardian_pid() != first; }, 15s));
  EXPECT_TRUE(wait_for([&] { return !runs(first); }, 5s));
}

// Each death used to double, for good, the time until the next one was noticed.
TEST(LeftAlone, AGuardianThatDiesRepeatedlyIsReplacedAsFastAsTheFirstTime) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  const auto unguarded = [](const json& s) {
    for (const json& alarm : s["alarms"])
      if (alarm["text"].get<std::string>().find("nobody looks after the light") != std::string::npos) return true;
    return false;
  };
  for (int death = 0; death < 5; ++death) {
    ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1 && runs(rig.guardian_pid()); }, 5s)) << death;
    const pid_t guardian = rig.guardian_pid();
    std::this_thread::sleep_for(3s);  // it has watched for a while
    ASSERT_EQ(::kill(guardian, SIGKILL), 0);
    ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1 && rig.guardian_pid() != guardian; }, 5s)) << death;
    ASSERT_TRUE(rig.wait_status([&](const json& s) { return !unguarded(s); }, 6s)) << rig.last()["alarms"].dump(1);
  }
}

bool listens(int port) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool connected = ::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(fd);
  return connected;
}

// A guardian that inherited the page's sockets kept the port: no daemon came back on it, and clients hung.
TEST(LeftAlone, AKilledDaemonsPortIsFreeWhileItsGuardianHasTheLight) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1; }, 5s)) << rig.daemon().output();
  const pid_t guardian = rig.guardian_pid();
  ASSERT_TRUE(listens(rig.port()));
  rig.daemon().signal(SIGKILL);
  EXPECT_TRUE(wait_for([&] { return !listens(rig.port()); }, 10s));
  EXPECT_TRUE(runs(guardian));
}

TEST(LeftAlone, ASignalTriggersARememberedBlackout) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  rig.daemon().signal(SIGUSR1);
  ASSERT_TRUE(rig.wait_status([](const json& s) { return s["blackout"] == true; }, 5s)) << rig.last().dump(1);
  EXPECT_EQ(rig.level_sum(), 0);
  EXPECT_TRUE(wait_for(
      [&] { return json::parse(text_of(rig.file("state/state.json")), nullptr, false)["blackout"] == true; }, 5s));
}

TEST(LeftAlone, ATerminalHangUpEndsNothing) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1; }, 5s)) << rig.daemon().output();
  const pid_t guardian = rig.guardian_pid();
  rig.daemon().signal(SIGHUP);
  ::kill(guardian, SIGHUP);
  std::this_thread::sleep_for(1s);
  EXPECT_TRUE(rig.wait_phase("holding", 5s));
  EXPECT_EQ(rig.guardian_pid(), guardian);
}

// A log that cannot be written used to stop the daemon; the guardian died just when it was needed.
TEST(LeftAlone, AFullLogStopsNeitherTheDaemonNorItsGuardian) {
  LiveRig rig(source("tests/rigs/without-data"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  rig.daemon().signal(SIGTERM);
  ASSERT_EQ(rig.daemon().wait(20s), 0) << rig.daemon().output();
  std::string command = "exec " + program("luxrig") + " run " + source("tests/rigs/without-data") +
                        " --max-error 0.02 --port 0 --sim-ports " + rig.file("ports.json").string() + " --state " +
                        rig.file("state").string() + " > /dev/full 2>&1";
  Process daemon({"/bin/sh", "-c", command}, rig.file("shell.log"));
  ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1 && min_level(rig.truth()) > 0.1; }, 60s));
  daemon.signal(SIGKILL);
  (void)daemon.wait(5s);
  const auto killed = std::chrono::steady_clock::now();
  double least = 1;
  while (std::chrono::steady_clock::now() - killed < 4s) {
    least = std::min(least, min_level(rig.truth()));
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_GT(least, 0.05) << "the watched lamp goes dark 2 s after the last word";
}

TEST(LeftAlone, ASecondDaemonIsRefusedEvenWhileAGuardianSends) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  ASSERT_TRUE(wait_for([&] { return rig.guardian_pid() > 1; }, 5s)) << rig.daemon().output();
  const auto second = [&](const std::string& state) {
    return luxrig::testing::run({program("luxrig"), "run", source("tests/rigs/room"), "--sim-ports",
                                 rig.file("ports.json").string(), "--port", "0", "--max-error", "0.02", "--state",
                                 rig.file(state).string()},
                                60s);
  };
  const Ran same = second("state");
  EXPECT_EQ(same.code, 1);
  EXPECT_NE(same.output.find("one Luxrig at a time"), std::string::npos) << same.output;
  const Ran other = second("other");
  EXPECT_EQ(other.code, 1);
  EXPECT_NE(other.output.find("two would fight for the light"), std::string::npos) << other.output;
  EXPECT_TRUE(rig.wait_phase("holding", 5s)) << "the first one goes on";
  rig.daemon().signal(SIGKILL);
  const Ran third = second("other");
  EXPECT_NE(third.output.find("two would fight for the light"), std::string::npos) << third.output;
  rig.start_daemon();
  EXPECT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
}

TEST(LeftAlone, ComputedLightIsKeptForTheNextStartAndRecomputedIfDamaged) {
  LiveRig rig(source("tests/rigs/room"));
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  for (const bool damaged : {false, true}) {
    rig.daemon().signal(SIGKILL);
    if (damaged) {
      std::string light = text_of(rig.file("state/light.bin"));
      ASSERT_GT(light.size(), 100u);
      light[light.size() / 2] = static_cast<char>(light[light.size() / 2] ^ 1);
      std::ofstream(rig.file("state/light.bin"), std::ios::binary) << light;
    }
    rig.start_daemon();
    ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
    EXPECT_EQ(rig.daemon().output().find("as it was worked out for this rig before") == std::string::npos, damaged)
        << rig.daemon().output();
  }
}

TEST(LeftAlone, AContactBlackoutLastsUntilReleasedAndLiftedByAPerson) {
  const Folder folder;
  const auto copy = folder / "room";
  std::filesystem::copy(source("tests/rigs/room"), copy, std::filesystem::copy_options::recursive);
  std::string text = text_of(copy / "rig.toml");
  const std::string bus = "driver = \"modbus_tcp\"\n";
  ASSERT_NE(text.find(bus), std::string::npos);
  text.insert(text.find(bus) + bus.size(), "blackout_input = 4\nblackout_unit = 9\n");
  std::ofstream(copy / "rig.toml") << text;
  LiveRig rig(copy.string());
  ASSERT_TRUE(rig.wait_phase("holding", 60s)) << rig.daemon().output();
  rig.fault("field", "pressed", true);
  ASSERT_TRUE(rig.wait_status([](const json& s) { return s["blackout"] == true; }, 5s)) << rig.last().dump(1);
  EXPECT_EQ(rig.level_sum(), 0);
  const std::string port = std::to_string(rig.port());
  const Ran lifted = luxrig::testing::run({program("luxrig"), "blackout", "off", "--port", port});
  EXPECT_NE(lifted.code, 0);
  EXPECT_NE(lifted.output.find("release that first"), std::string::npos) << lifted.output;
  rig.fault("field", "pressed", false);
  std::this_thread::sleep_for(500ms);
  ASSERT_TRUE(rig.wait_status([](const json& s) { return s["blackout"] == true; }, 5s)) << "not by itself";
  EXPECT_EQ(luxrig::testing::run({program("luxrig"), "blackout", "off", "--port", port}).code, 0);
  ASSERT_TRUE(rig.wait_status([](const json& s) { return s["blackout"] == false && s["phase"] == "holding"; }, 30s))
      << rig.last().dump(1);
  rig.fault("field", "silent", true);
  ASSERT_TRUE(rig.wait_status([](const json& s) { return has_alarm(s, "blackout contact"); }, 15s))
      << rig.last().dump(1);
}

}  // namespace
}  // namespace luxrig::testing
