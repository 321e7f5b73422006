/// What every driver must show. The suite walks the registry: a new line there is tested without a new test here.
/// Each driver meets the far end that sim/wire/ has for it, by name; a driver without one fails.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include "drivers/registry.h"
#include "sim/wire/modbus/pty_line.h"
#include "tests/conformance/far_end.h"
#include "tests/drivers/modbus/scripted_peer.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

/// How long a busy test machine may keep a thread from running: no driver can state a bound for that.
constexpr Duration kBusyMachine = milliseconds(250);

Time ms(double t) { return Time{} + from_seconds(1 + t / 1000); }

/// The bus as a person would write it: what is required, and nothing else.
Bus plain_bus(const DriverEntry& entry) {
  Bus bus = bus_of(std::string(entry.name));
  for (const OptionDoc& doc : entry.options) {
    if (doc.fallback == "required") bus.options[std::string(doc.key)] = {required_value(doc), {}};
  }
  return bus;
}

/// A rig that fills the bus with what it can carry: DMX fixtures and a head, in two universes or in one, Modbus dimmers
/// and meters, or the axes of a head whose lamp is elsewhere.
Rig rig_for(const DriverEntry& entry) {
  Rig dmx = rig_with(plain_bus(entry));
  add_dmx(dmx, "spot", 1, 5);
  add_head(dmx, "head", 2, 10);
  if (entry.check(dmx, 0).empty()) return dmx;
  Rig one_universe = rig_with(plain_bus(entry));
  add_dmx(one_universe, "spot", 1, 5);
  add_head(one_universe, "head", 1, 10);
  if (entry.check(one_universe, 0).empty()) return one_universe;
  Rig modbus = rig_with(plain_bus(entry));
  add_modbus(modbus, "dimmer-a", 10, 0);
  add_modbus(modbus, "dimmer-b", 10, 1, 255);
  add_modbus(modbus, "dimmer-c", 11, 7, 65535);
  add_meter(modbus, "meter-a", 1, 2);
  Luxmeter& swapped = add_meter(modbus, "meter-b", 2, 2);
  swapped.patch.low_word_first = true;
  swapped.patch.input_registers = true;
  if (entry.check(modbus, 0).empty()) return modbus;
  Rig axes = rig_with(plain_bus(entry));
  axes.buses.push_back(bus_of("sacn"));
  axes.buses[1].name = "lamps";
  add_dmx(axes, "spot", 1, 5).bus = 1;
  add_axes(add_dmx(axes, "head", 1, 6), 5, 6).bus = 1;
  EXPECT_TRUE(entry.check(axes, 0).empty()) << entry.name;
  return axes;
}

/// The bus turns heads and dims nothing.
bool only_turns(const Rig& rig) {
  return std::none_of(rig.fixtures.begin(), rig.fixtures.end(), [](const Fixture& f) { return f.bus == 0; });
}

/// Where such a bus puts a head in place of a drive: 0 is where heads wake.
Joints joints_of(double drive) { return {rad_from_deg(10 * drive), rad_from_deg(8 * drive)}; }

/// How exactly the simulated axes can be: what homing turns them in a step of 1 ms (0.025°), where friction holds the
/// servo (0.015°), half the play of the gear (0.01°).
constexpr double kAxisTolerance_deg = 0.06;

/// All fixtures of the bus at one drive.
Result<void> write_all(Driver& driver, const Rig& rig, Time now, double drive) {
  std::vector<LevelCommand> levels;
  std::vector<AimCommand> aims;
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    if (rig.fixtures[i].bus == 0) levels.push_back({i, drive});
    if (rig.fixtures[i].axes) aims.push_back({i, joints_of(drive)});
  }
  if (LevelOutput* output = driver.level_output()) return output->write(now, levels);
  return driver.mover()->move(now, aims);
}

/// Largest error that the encoding of a fixture's drive may make: half a step.
double resolution(const Fixture& fixture) {
  if (const auto* modbus = std::get_if<ModbusPatch>(&fixture.patch)) return 0.5 / modbus->full_scale_raw;
  for (const DmxSlot& slot : std::get<DmxPatch>(fixture.patch).slots) {
    if (slot.use == SlotUse::dimmer_fine) return 0.5 / 65535;
  }
  return 0.5 / 255;
}

std::size_t entries_in(const char* folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
  return count;
}

class EveryDriver : public ::testing::TestWithParam<std::size_t> {
 protected:
  const DriverEntry& entry() const { return drivers()[GetParam()]; }
  std::unique_ptr<Driver> make(const Rig& rig, int port, const std::string& path = {}) const {
    return entry().make(rig, 0, Redirect{"127.0.0.1", port, path});
  }
};

/// A driver with its far end, and a clock that both follow.
struct Pair {
  // Axes watch the master by its clock, so theirs must not run ahead of it; their driver never waits.
  Pair(const DriverEntry& entry, Rig the_rig)
      : rig(std::move(the_rig)),
        far(rig, only_turns(rig) ? Duration(milliseconds(5)) : Duration(std::chrono::hours(1))) {
    driver = entry.make(rig, 0, far.redirect());
    bounds = driver->bounds();
  }
  Result<void> write(double drive) { return write_all(*driver, rig, now, drive); }
  /// Cycles until a peer that obeys at once has obeyed; axes also have to find their home and to travel.
  void settle(double drive, int obeys_within = 8) {
    const int most = only_turns(rig) ? 600 : obeys_within;
    for (int i = 0; i < most && !(only_turns(rig) && last_write && at(drive) && i > 2); ++i) cycle(drive);
  }
  /// One cycle of the control loop; the slowest call's real duration is kept.
  void cycle(double drive) {
    far.step_to(now);
    timed(bounds.write, [&] { last_write = write(drive); });
    if (driver->lux_reader() != nullptr) {
      timed(bounds.read, [&] { last_read = driver->lux_reader()->read(now); });
    }
    far.step_to(now);
    now += bounds.write_period;
  }
  template <class Call>
  void timed(Duration bound, Call call) {
    const auto start = std::chrono::steady_clock::now();
    call();
    const auto took = std::chrono::steady_clock::now() - start;
    worst_over_bound = std::max(worst_over_bound, std::chrono::duration_cast<Duration>(took) - bound);
  }
  [[nodiscard]] Health bus() const { return driver->health(now).at(0); }
  bool at(double drive) const {
    if (only_turns(rig)) return between(drive, drive);
    const std::vector<double> drives = far.drives();
    for (std::size_t i = 0; i < drives.size(); ++i) {
      if (std::abs(drives[i] - drive) > resolution(rig.fixtures[i]) + 1e-9) return false;
    }
    return true;
  }
  /// Heads on axes: nowhere but between where the two drives put them.
  bool between(double from, double to) const {
    const double slack = rad_from_deg(kAxisTolerance_deg);
    const Joints least = joints_of(from), most = joints_of(to);
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
      if (!rig.fixtures[i].axes) continue;
      const Joints joints = far.joints()[i];
      if (joints.pan_rad < least.pan_rad - slack || joints.pan_rad > most.pan_rad + slack ||
          joints.tilt_rad < least.tilt_rad - slack || joints.tilt_rad > most.tilt_rad + slack) {
        return false;
      }
    }
    return true;
  }

  Rig rig;
  FarEnd far;
  std::unique_ptr<Driver> driver;
  DriverBounds bounds;
  Time now = ms(0);
  Result<void> last_write;
  Result<std::vector<LuxReading>> last_read;
  Duration worst_over_bound = Duration::min();
};

TEST_P(EveryDriver, ConstructsWithoutTouchingADeviceAndLeavesThreadsAndDescriptorsAsFound) {
  const Rig rig = rig_for(entry());
  const std::size_t descriptors = entries_in("/proc/self/fd"), threads = entries_in("/proc/self/task");
  {
    const auto driver = make(rig, 9);  // the discard port: nobody is there
    EXPECT_EQ(entries_in("/proc/self/fd"), descriptors);
    EXPECT_EQ(driver->health(ms(0)).at(0).life, Life::configured);
  }
  for (const bool destroy_while_active : {false, true}) {
    auto driver = make(rig, 9);
    driver->deactivate(ms(0));
    EXPECT_TRUE(driver->activate(ms(1)));
    EXPECT_TRUE(driver->activate(ms(2)));
    driver->deactivate(ms(3));
    driver->deactivate(ms(4));
    EXPECT_EQ(driver->health(ms(4)).at(0).life, Life::configured);
    EXPECT_EQ(entries_in("/proc/self/fd"), descriptors);
    EXPECT_TRUE(driver->activate(ms(5)));
    EXPECT_NE(driver->health(ms(5)).at(0).life, Life::configured);
    if (!destroy_while_active) driver->deactivate(ms(6));
  }
  EXPECT_EQ(entries_in("/proc/self/fd"), descriptors);
  EXPECT_EQ(entries_in("/proc/self/task"), threads);
}

TEST_P(EveryDriver, StatesBoundsThatACycleCanLiveWith) {
  const DriverBounds bounds = make(rig_for(entry()), 9)->bounds();
  EXPECT_GT(bounds.write, Duration{});
  EXPECT_GT(bounds.write_period, Duration{});
  EXPECT_GT(bounds.fault_after, Duration{});
  EXPECT_EQ(bounds.read_period > Duration{}, make(rig_for(entry()), 9)->lux_reader() != nullptr);
}

TEST_P(EveryDriver, MovesItsPeerToTheSetpointAndReadsBackTheSame) {
  Pair pair(entry(), rig_for(entry()));
  ASSERT_TRUE(pair.driver->activate(pair.now));
  for (const double drive : {0.0, 1.0, 0.37, 0.5, 0.001}) {
    pair.settle(drive);
    EXPECT_TRUE(pair.last_write) << (pair.last_write ? "" : pair.last_write.error().detail);
    EXPECT_TRUE(pair.at(drive)) << drive;
  }
  if (LuxReader* reader = pair.driver->lux_reader()) {
    pair.now += pair.bounds.read_period;
    pair.far.step_to(pair.now);
    const auto readings = reader->read(pair.now);
    ASSERT_TRUE(readings);
    ASSERT_EQ(readings->size(), pair.rig.luxmeters.size());
    for (const LuxReading& reading : *readings) {
      EXPECT_NEAR(reading.lux, pair.far.meter_lx(reading.luxmeter), 0.001);
      EXPECT_EQ(reading.taken, pair.now);
    }
  }
  if (Mover* mover = pair.driver->mover()) {
    const Joints wanted{rad_from_deg(-123.4), rad_from_deg(56.7)};
    const AimCommand aim{1, wanted};
    ASSERT_TRUE(mover->move(pair.now, {&aim, 1}));
    for (int i = 0; i < 200; ++i) {
      if (only_turns(pair.rig)) {  // with no more commands
        pair.far.step_to(pair.now);
        EXPECT_TRUE(mover->move(pair.now, {}));
        pair.now += pair.bounds.write_period;
      } else {
        pair.cycle(0.5);
      }
    }
    const bool axes = only_turns(pair.rig);
    EXPECT_NEAR(pair.far.joints()[1].pan_rad, wanted.pan_rad, rad_from_deg(axes ? kAxisTolerance_deg : 540.0 / 65535));
    EXPECT_NEAR(pair.far.joints()[1].tilt_rad, wanted.tilt_rad,
                rad_from_deg(axes ? kAxisTolerance_deg : 270.0 / 65535));
  }
  const Health health = pair.bus();
  EXPECT_EQ(health.life, Life::active);
  EXPECT_GT(health.sent, 0u);
  EXPECT_GT(health.last_ok, ms(0));
  EXPECT_EQ(health.errors, 0u);
}

TEST_P(EveryDriver, RefusesWhatCannotBeSentAndSendsNothing) {
  Pair pair(entry(), rig_for(entry()));
  ASSERT_TRUE(pair.driver->activate(pair.now));
  const std::uint64_t sent = pair.bus().sent;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const LevelCommand& bad : {LevelCommand{0, nan}, LevelCommand{0, -0.01}, LevelCommand{0, 1.01},
                                  LevelCommand{0, std::numeric_limits<double>::infinity()}, LevelCommand{99, 0.5}}) {
    if (pair.driver->level_output() == nullptr) break;
    const auto result = pair.driver->level_output()->write(pair.now, {&bad, 1});
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().cause, Cause::invalid);
    EXPECT_FALSE(result.error().detail.empty());
  }
  if (Mover* mover = pair.driver->mover()) {
    for (const AimCommand& bad : {AimCommand{1, {nan, 0}}, AimCommand{1, {0, nan}}, AimCommand{1, {99, 0}},
                                  AimCommand{1, {0, -99}}, AimCommand{0, {0, 0}}, AimCommand{99, {0, 0}}}) {
      const auto result = mover->move(pair.now, {&bad, 1});
      ASSERT_FALSE(result);
      EXPECT_EQ(result.error().cause, Cause::invalid);
    }
  }
  EXPECT_EQ(pair.bus().sent, sent);
}

TEST_P(EveryDriver, ReturnsWithinItsBoundWhateverItsPeerDoes) {
  for (const sim::FaultKind fault : {sim::FaultKind::silent, sim::FaultKind::slow, sim::FaultKind::garbled,
                                     sim::FaultKind::lost, sim::FaultKind::dead}) {
    // A driver that waits too long does so every time; a machine that is busy for a moment does not.
    Duration least_over_bound = Duration::max();
    for (int attempt = 0; attempt < 3 && least_over_bound > kBusyMachine; ++attempt) {
      Pair pair(entry(), rig_for(entry()));
      ASSERT_TRUE(pair.driver->activate(pair.now));
      pair.cycle(0.2);
      pair.far.faults().set("the-bus", fault, true);
      for (int i = 0; i < 10; ++i) pair.cycle(0.2 + 0.01 * i);
      least_over_bound = std::min(least_over_bound, pair.worst_over_bound);
    }
    EXPECT_LE(least_over_bound, kBusyMachine) << name_of(fault);
  }
}

TEST_P(EveryDriver, IsFaultedInTimeWhenItsPeerGoesAndComesBackByItselfWithTheCurrentSetpoint) {
  Pair pair(entry(), rig_for(entry()));
  if (!pair.bounds.notices_loss) GTEST_SKIP() << "declares that it cannot notice";
  ASSERT_TRUE(pair.driver->activate(pair.now));
  pair.settle(0.25, 10);
  ASSERT_TRUE(pair.at(0.25));

  pair.far.faults().set("the-bus", sim::FaultKind::dead, true);
  const Time gone = pair.now;
  while (pair.bus().life == Life::active && pair.now < gone + std::chrono::minutes(1)) pair.cycle(0.25);
  EXPECT_LE(pair.now - gone, pair.bounds.fault_after + pair.bounds.write_period);
  EXPECT_EQ(pair.bus().life, Life::faulted);
  EXPECT_NE(pair.bus().detail, "");
  EXPECT_GE(pair.bus().since, gone);
  EXPECT_GT(pair.bus().errors, 0u);
  EXPECT_FALSE(pair.last_write);

  for (int i = 0; i < 20; ++i) pair.cycle(0.95);  // never reaches anyone
  pair.far.faults().clear();
  const Time back = pair.now;
  while (pair.bus().life != Life::active && pair.now < back + std::chrono::minutes(1)) {
    pair.cycle(0.75);
    if (only_turns(pair.rig)) {
      EXPECT_TRUE(pair.between(0.25, 0.75));
      continue;
    }
    for (const double drive : pair.far.drives()) {
      EXPECT_TRUE(std::abs(drive - 0.25) < 0.003 || std::abs(drive - 0.75) < 0.003) << drive;
    }
  }
  EXPECT_LE(pair.now - back, std::chrono::seconds(4));
  for (int i = 0; i < 120 && only_turns(pair.rig) && !pair.at(0.75); ++i) {
    pair.cycle(0.75);
    EXPECT_TRUE(pair.between(0.25, 0.75));
  }
  for (int i = 0; i < 3; ++i) pair.cycle(0.75);
  EXPECT_TRUE(pair.at(0.75)) << (pair.last_write ? "" : pair.last_write.error().detail);
  EXPECT_EQ(pair.bus().detail, "");
}

TEST_P(EveryDriver, ResumesAfterGarbledAnswers) {
  Pair pair(entry(), rig_for(entry()));
  ASSERT_TRUE(pair.driver->activate(pair.now));
  pair.settle(0.25, 1);
  pair.far.faults().set("the-bus", sim::FaultKind::garbled, true);
  for (int i = 0; i < 60; ++i) pair.cycle(0.25);
  pair.far.faults().clear();
  for (int i = 0; i < (only_turns(pair.rig) ? 600 : 120) && !(pair.at(0.5) && pair.bus().life == Life::active); ++i)
    pair.cycle(0.5);
  EXPECT_TRUE(pair.at(0.5));
  EXPECT_EQ(pair.bus().life, Life::active) << pair.bus().detail;
}

TEST_P(EveryDriver, KeepsToItsRateAndSendsKeepAlives) {
  Pair pair(entry(), rig_for(entry()));
  ASSERT_TRUE(pair.driver->activate(pair.now));
  pair.settle(0, 1);
  const std::uint64_t before = pair.bus().sent;
  const Time start = pair.now;
  for (int step = 0; step < 1000; ++step) {
    pair.now = start + step * milliseconds(1);
    if (only_turns(pair.rig) && step % 10 == 0) pair.far.step_to(pair.now);  // it would be missed
    ASSERT_TRUE(pair.write(step / 1000.0));
  }
  const double cycles = 1.0 / to_seconds(pair.bounds.write_period);
  const auto outputs = static_cast<double>(pair.rig.fixtures.size());
  EXPECT_LE(static_cast<double>(pair.bus().sent - before), 2 * cycles * outputs + 2);

  Time last = pair.now;
  std::uint64_t sent = pair.bus().sent;
  Duration longest{};
  const Time end = pair.now + std::chrono::seconds(5);
  while (pair.now < end) {
    pair.cycle(0.5);
    if (pair.bus().sent == sent) continue;
    longest = std::max(longest, pair.now - last);
    sent = pair.bus().sent;
    last = pair.now;
  }
  EXPECT_LE(std::max(longest, end - last), std::chrono::milliseconds(1050));
}

/// Everything a driver sends to one loopback port, by UDP or TCP, or to a serial port, whichever it speaks; nobody
/// answers.
class Recorder {
 public:
  Recorder() : tcp_([](const auto&) { return ScriptedAnswer{}; }) {
    udp_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(tcp_.port()));
    EXPECT_EQ(::bind(udp_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    auto line = sim::PtyLine::open("");
    EXPECT_TRUE(line);
    if (line) line_ = std::move(*line);
  }
  ~Recorder() { ::close(udp_); }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  [[nodiscard]] int port() const { return tcp_.port(); }
  [[nodiscard]] std::string path() const { return line_ ? line_->path() : std::string(); }
  std::vector<std::vector<std::uint8_t>> all() {
    auto packets = tcp_.requests();
    std::uint8_t buffer[2048];
    for (ssize_t got = 0; (got = ::recv(udp_, buffer, sizeof(buffer), 0)) >= 0;) {
      packets.emplace_back(buffer, buffer + got);
    }
    if (line_) {
      if (auto sent = line_->take(); !sent.empty()) packets.push_back(std::move(sent));
    }
    return packets;
  }

 private:
  ScriptedPeer tcp_;
  int udp_ = -1;
  std::unique_ptr<sim::PtyLine> line_;
};

TEST_P(EveryDriver, SendsTheSameBytesForTheSameInputsUnderASteppedClock) {
  std::vector<std::vector<std::vector<std::uint8_t>>> runs;
  for (int run = 0; run < 2; ++run) {
    const Rig rig = rig_for(entry());
    Recorder recorder;
    const auto driver = make(rig, recorder.port(), recorder.path());
    ASSERT_TRUE(driver->activate(ms(0)));
    for (int i = 0; i < 5; ++i) {
      (void)write_all(*driver, rig, ms(0) + i * driver->bounds().write_period, 0.1 * i);
    }
    driver->deactivate(ms(2000));
    runs.push_back(recorder.all());
  }
  EXPECT_FALSE(runs[0].empty());
  EXPECT_EQ(runs[0], runs[1]);
}

TEST_P(EveryDriver, RefusesAnUnknownOptionAndNamesTheNearest) {
  Rig rig = rig_for(entry());
  const std::string known(entry().options.front().key);
  rig.buses[0].options[known + "x"] = {std::string("1"), {33, 4}};
  const auto problems = check_buses(rig);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].line, 33);
  EXPECT_EQ(problems[0].column, 4);
  EXPECT_NE(problems[0].mend.find(known), std::string::npos) << problems[0].text();
}

TEST_P(EveryDriver, DoesNothingWhileInactive) {
  Pair pair(entry(), rig_for(entry()));
  EXPECT_EQ(pair.write(1.0).error().cause, Cause::inactive);
  if (pair.driver->lux_reader() != nullptr) {
    EXPECT_EQ(pair.driver->lux_reader()->read(pair.now).error().cause, Cause::inactive);
  }
  pair.far.step_to(pair.now);
  EXPECT_TRUE(pair.at(0));
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryDriver, ::testing::Range(std::size_t{0}, drivers().size()),
                         [](const auto& which) { return std::string(drivers()[which.param].name); });

}  // namespace
}  // namespace luxrig
