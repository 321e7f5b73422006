// Every driver of the registry with its far end from sim/wire/, by name. A driver without a far end fails.

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>

#include "drivers/registry.h"
#include "sim/wire/modbus/pty_line.h"
#include "tests/conformance/broken_driver.h"
#include "tests/conformance/far_end.h"
#include "tests/conformance/subject.h"
#include "tests/drivers/modbus/scripted_peer.h"
#include "tests/drivers/test_rig.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

/// The driver, broken if this process must show that the suite notices.
std::unique_ptr<Driver> made(const DriverEntry& entry, const Rig& rig, const Redirect& to) {
  const char* breakage = std::getenv(kBreakVariable);
  return broken(entry.make(rig, 0, to), breakage != nullptr ? breakage : "");
}

/// The bus with the required options only.
Bus plain_bus(const DriverEntry& entry) {
  Bus bus = bus_of(std::string(entry.name));
  for (const OptionDoc& doc : entry.options) {
    if (doc.fallback == "required") bus.options[std::string(doc.key)] = {required_value(doc), {}};
  }
  return bus;
}

/// A rig that fills the bus: DMX fixtures and a head in one or two universes, Modbus dimmers and meters, or the axes of
/// a head whose lamp is on another bus.
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

/// True if the bus turns heads and dims nothing.
bool only_turns(const Rig& rig) {
  return std::none_of(rig.fixtures.begin(), rig.fixtures.end(), [](const Fixture& f) { return f.bus == 0; });
}

/// Joint angles that stand for a drive on such a bus. Heads wake at 0.
Joints joints_of(double drive) { return {rad_from_deg(10 * drive), rad_from_deg(8 * drive)}; }

/// Tolerance of the simulated axes: homing turns them 0.025° in a step of 1 ms, friction stops the servo within 0.015°,
/// and half the play of the gear is 0.01°.
constexpr double kAxisTolerance_deg = 0.06;

/// Writes one drive to all fixtures of the bus.
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

/// Largest error of an encoded drive: half a step.
double resolution(const Fixture& fixture) {
  if (const auto* modbus = std::get_if<ModbusPatch>(&fixture.patch)) return 0.5 / modbus->full_scale_raw;
  for (const DmxSlot& slot : std::get<DmxPatch>(fixture.patch).slots) {
    if (slot.use == SlotUse::dimmer_fine) return 0.5 / 65535;
  }
  return 0.5 / 255;
}

class BusSubject final : public Subject {
 public:
  // Axes watch the master by the far end's clock, so it must not run ahead of the master's. Their driver never waits.
  explicit BusSubject(const DriverEntry& entry)
      : entry_(entry),
        rig_(rig_for(entry)),
        far_(rig_, only_turns(rig_) ? Duration(milliseconds(5)) : Duration(std::chrono::hours(1))) {
    driver = made(entry, rig_, far_.redirect());
    bounds = driver->bounds();
  }
  ~BusSubject() override { driver.reset(); }

  Result<void> call(double drive) override {
    if (only_turns(rig_) && now - stepped_ >= milliseconds(10)) far_.step_to(stepped_ = now);  // axes would miss it
    return write_all(*driver, rig_, now, drive);
  }
  void cycle(double drive) override {
    far_.step_to(now);
    timed(bounds.write, [&] { last = write_all(*driver, rig_, now, drive); });
    if (driver->lux_reader() != nullptr) timed(bounds.read, [&] { (void)driver->lux_reader()->read(now); });
    far_.step_to(now);
    now += bounds.write_period;
  }
  Duration period() const override { return bounds.write_period; }
  /// Axes also need time to find their home and to travel.
  void settle(double drive, int obeys_within) override {
    const int most = only_turns(rig_) ? 600 : obeys_within;
    for (int i = 0; i < most && !(only_turns(rig_) && last && at(drive) && i > 2); ++i) cycle(drive);
  }
  bool at(double drive) const override {
    if (only_turns(rig_)) return between(drive, drive);
    const std::vector<double> drives = far_.drives();
    for (std::size_t i = 0; i < drives.size(); ++i) {
      if (std::abs(drives[i] - drive) > resolution(rig_.fixtures[i]) + 1e-9) return false;
    }
    return true;
  }
  bool at_either(double before, double current) const override {
    if (only_turns(rig_)) return between(before, current);
    for (const double drive : far_.drives()) {
      if (std::abs(drive - before) >= 0.003 && std::abs(drive - current) >= 0.003) return false;
    }
    return true;
  }
  bool left_as_agreed(double drive) override {
    for (int i = 0; i < 30; ++i) far_.step_to(now += milliseconds(100));
    if (only_turns(rig_)) return at(drive);  // heads stay where they look
    switch (entry_.when_data_stops(rig_, 0).does) {
      case WithoutData::holds:
        return at(drive);
      case WithoutData::goes_dark:
        return at(0);
      case WithoutData::makers_choice:
        return at(drive) || at(0);
    }
    return false;
  }
  bool untouched() override {
    far_.step_to(now);
    return at(0);
  }
  double outputs() const override { return static_cast<double>(rig_.fixtures.size()); }
  std::uint64_t answers_held_up() const override { return far_.answers_held_up(); }
  void set_fault(sim::FaultKind fault) override { far_.faults().set("the-bus", fault, true); }
  void clear_faults() override { far_.faults().clear(); }

  void try_other_capabilities() override {
    if (LuxReader* reader = driver->lux_reader()) {
      now += bounds.read_period;
      far_.step_to(now);
      const auto readings = reader->read(now);
      ASSERT_TRUE(readings);
      ASSERT_EQ(readings->size(), rig_.luxmeters.size());
      for (const LuxReading& reading : *readings) {
        EXPECT_NEAR(reading.lux, far_.meter_lx(reading.luxmeter), 0.001);
        EXPECT_EQ(reading.taken, now);
      }
    }
    if (Mover* mover = driver->mover()) {
      const Joints wanted{rad_from_deg(-123.4), rad_from_deg(56.7)};
      const AimCommand aim{1, wanted};
      ASSERT_TRUE(mover->move(now, {&aim, 1}));
      for (int i = 0; i < 200; ++i) {
        if (only_turns(rig_)) {  // without further commands
          far_.step_to(now);
          EXPECT_TRUE(mover->move(now, {}));
          now += bounds.write_period;
        } else {
          cycle(0.5);
        }
      }
      const bool axes = only_turns(rig_);
      EXPECT_NEAR(far_.joints()[1].pan_rad, wanted.pan_rad, rad_from_deg(axes ? kAxisTolerance_deg : 540.0 / 65535));
      EXPECT_NEAR(far_.joints()[1].tilt_rad, wanted.tilt_rad, rad_from_deg(axes ? kAxisTolerance_deg : 270.0 / 65535));
    }
  }

  std::vector<std::string> bad_requests_taken() override {
    std::vector<std::string> taken;
    const auto expect_refused = [&](const Result<void>& result, const char* what) {
      if (result || result.error().cause != Cause::invalid || result.error().detail.empty()) taken.emplace_back(what);
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const LevelCommand& bad : {LevelCommand{0, nan}, LevelCommand{0, -0.01}, LevelCommand{0, 1.01},
                                    LevelCommand{0, std::numeric_limits<double>::infinity()}, LevelCommand{99, 0.5}}) {
      if (driver->level_output() != nullptr) expect_refused(driver->level_output()->write(now, {&bad, 1}), "a level");
    }
    if (Mover* mover = driver->mover()) {
      for (const AimCommand& bad : {AimCommand{1, {nan, 0}}, AimCommand{1, {0, nan}}, AimCommand{1, {99, 0}},
                                    AimCommand{1, {0, -99}}, AimCommand{0, {0, 0}}, AimCommand{99, {0, 0}}}) {
        expect_refused(mover->move(now, {&bad, 1}), "an aim");
      }
    }
    return taken;
  }

 private:
  template <class Call>
  void timed(Duration bound, Call call) {
    const auto start = std::chrono::steady_clock::now();
    call();
    const auto took = std::chrono::steady_clock::now() - start;
    worst_over_bound = std::max(worst_over_bound, std::chrono::duration_cast<Duration>(took) - bound);
  }
  /// True if all heads on axes are between the postures of the two drives.
  bool between(double from, double to) const {
    const double slack = rad_from_deg(kAxisTolerance_deg);
    const Joints least = joints_of(from), most = joints_of(to);
    for (std::size_t i = 0; i < rig_.fixtures.size(); ++i) {
      if (!rig_.fixtures[i].axes) continue;
      const Joints joints = far_.joints()[i];
      if (joints.pan_rad < least.pan_rad - slack || joints.pan_rad > most.pan_rad + slack ||
          joints.tilt_rad < least.tilt_rad - slack || joints.tilt_rad > most.tilt_rad + slack) {
        return false;
      }
    }
    return true;
  }

  const DriverEntry& entry_;
  Rig rig_;
  FarEnd far_;
  Time stepped_{};
};

/// Records everything that a driver sends to one loopback port by UDP or TCP, or to a serial port. It never answers.
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

std::vector<std::vector<std::uint8_t>> record_bus(const DriverEntry& entry) {
  const Rig rig = rig_for(entry);
  Recorder recorder;
  const auto driver = made(entry, rig, Redirect{"127.0.0.1", recorder.port(), recorder.path()});
  EXPECT_TRUE(driver->activate(at_ms(0)));
  for (int i = 0; i < 5; ++i) {
    (void)write_all(*driver, rig, at_ms(0) + i * driver->bounds().write_period, 0.1 * i);
  }
  driver->deactivate(at_ms(2000));
  return recorder.all();
}

std::vector<Problem> problems_of_misspelt_bus_option(const DriverEntry& entry, std::string& known) {
  Rig rig = rig_for(entry);
  known = entry.options.front().key;
  rig.buses[0].options[known + "x"] = {std::string("1"), {33, 4}};
  return check_buses(rig);
}

}  // namespace

std::vector<Kind> bus_kinds() {
  std::vector<Kind> kinds;
  for (const DriverEntry& entry : drivers()) {
    Kind kind;
    kind.name = entry.name;
    kind.connected = [&entry] { return std::make_unique<BusSubject>(entry); };
    kind.alone = [&entry] {
      static std::vector<std::unique_ptr<Rig>> rigs;  // drivers may keep a reference
      rigs.push_back(std::make_unique<Rig>(rig_for(entry)));
      return made(entry, *rigs.back(), Redirect{"127.0.0.1", 9, {}});  // the discard port: no peer there
    };
    kind.record = [&entry] { return record_bus(entry); };
    kind.problems_of_misspelt_option = [&entry](std::string& known) {
      return problems_of_misspelt_bus_option(entry, known);
    };
    kinds.push_back(std::move(kind));
  }
  return kinds;
}

}  // namespace luxrig
