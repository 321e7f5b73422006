#include "tests/conformance/broken_driver.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <thread>
#include <vector>

namespace luxrig {
namespace {

constexpr std::array kBreakages{
    Breakage{"opens a descriptor before it is activated", "sacn",
             "ConstructsWithoutTouchingADeviceOrLeakingThreadsAndDescriptors"},
    Breakage{"states no bound", "sacn", "StatesWorkableTimeBounds"},
    Breakage{"sends another level", "sacn", "MovesItsPeerToTheSetpointAndReadsItBack"},
    Breakage{"reads another lux", "modbus_tcp", "MovesItsPeerToTheSetpointAndReadsItBack"},
    Breakage{"takes anything", "sacn", "RefusesImpossibleSetpointsAndSendsNothing"},
    Breakage{"blocks", "sacn", "ReturnsWithinItsBoundUnderEveryPeerFault"},
    Breakage{"is never faulted", "modbus_tcp", "FaultsInTimeWhenItsPeerGoesAndRecoversWithTheCurrentSetpoint"},
    Breakage{"sends what it could not send before", "modbus_tcp",
             "FaultsInTimeWhenItsPeerGoesAndRecoversWithTheCurrentSetpoint"},
    Breakage{"gives up for good", "modbus_tcp", "StartsWithoutItsPeerAndFindsItByItself"},
    Breakage{"gives up for good", "modbus_tcp", "ResumesAfterGarbledAnswers"},
    Breakage{"goes dark when it stops", "artnet", "LeavesTheAgreedStateWhenItStopsAndRestarts"},
    Breakage{"shares its setpoint with others of its kind", "sacn", "KeepsTwoInstancesIndependent"},
    Breakage{"is silent while nothing changes", "sacn", "KeepsToItsRateAndSendsKeepAlives"},
    Breakage{"is not the same twice", "sacn", "SendsTheSameBytesForTheSameInputsUnderASteppedClock"},
    Breakage{"sends before it is activated", "sacn", "DoesNothingWhileInactive"},
};

class BrokenDriver final : public Driver, public LevelOutput, public LuxReader {
 public:
  BrokenDriver(std::unique_ptr<Driver> whole, std::string_view breakage)
      : whole_(std::move(whole)), breakage_(breakage), number_(made_++) {
    if (is("opens a descriptor before it is activated")) descriptor_ = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  }
  ~BrokenDriver() override {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  BrokenDriver(const BrokenDriver&) = delete;
  BrokenDriver& operator=(const BrokenDriver&) = delete;

  DriverBounds bounds() const override {
    DriverBounds bounds = whole_->bounds();
    if (is("states no bound")) bounds.write = {};
    return bounds;
  }
  Result<void> activate(Time now) override { return whole_->activate(now); }
  void deactivate(Time now) override {
    if (is("goes dark when it stops")) (void)whole_->level_output()->write(now, dark());
    whole_->deactivate(now);
  }
  std::vector<Health> health(Time now) const override {
    std::vector<Health> health = whole_->health(now);
    if (is("is never faulted")) {
      for (Health& one : health)
        if (one.life == Life::faulted) one.life = Life::active;
    }
    return health;
  }
  std::vector<CarriedUniverse> carried() const override { return whole_->carried(); }
  std::optional<Contact> contact(Time now) const override { return whole_->contact(now); }
  LevelOutput* level_output() override { return whole_->level_output() != nullptr ? this : nullptr; }
  Mover* mover() override { return whole_->mover(); }
  LuxReader* lux_reader() override { return whole_->lux_reader() != nullptr ? this : nullptr; }
  LevelInput* level_input() override { return whole_->level_input(); }

  Result<void> write(Time now, std::span<const LevelCommand> commands) override {
    std::vector<LevelCommand> sent(commands.begin(), commands.end());
    if (is("sends another level"))
      for (LevelCommand& command : sent) command.drive = std::min(1.0, command.drive + 0.02);
    if (is("is not the same twice"))
      for (LevelCommand& command : sent) command.drive = std::min(1.0, command.drive + 0.1 * (number_ % 2));
    if (is("blocks") && !blocked_) {
      blocked_ = true;
      std::this_thread::sleep_for(whole_->bounds().write + std::chrono::milliseconds(400));
    }
    if (is("sends what it could not send before") && !unsent_.empty()) sent = unsent_.front();
    if (is("shares its setpoint with others of its kind") && !sent.empty()) {
      const double other = shared_.exchange(sent.front().drive);
      for (LevelCommand& command : sent) command.drive = other;
    }
    if (is("sends before it is activated")) (void)whole_->activate(now);
    const bool same = std::equal(
        commands.begin(), commands.end(), before_.begin(), before_.end(),
        [](const LevelCommand& a, const LevelCommand& b) { return a.fixture == b.fixture && a.drive == b.drive; });
    before_.assign(commands.begin(), commands.end());
    if (is("is silent while nothing changes") && same) return {};
    if (is("gives up for good") && lost_) return tl::unexpected(*lost_);
    auto written = whole_->level_output()->write(now, sent);
    if (!written && is("takes anything")) return {};
    if (!written && is("gives up for good")) lost_ = written.error();
    if (written && !unsent_.empty()) unsent_.pop_front();
    if (!written) unsent_.emplace_back(commands.begin(), commands.end());
    return written;
  }
  bool settled() const override { return whole_->level_output()->settled(); }

  Result<std::vector<LuxReading>> read(Time now) override {
    auto readings = whole_->lux_reader()->read(now);
    if (readings && is("reads another lux"))
      for (LuxReading& reading : *readings) reading.lux *= 1.01;
    return readings;
  }

 private:
  [[nodiscard]] bool is(std::string_view breakage) const { return breakage_ == breakage; }
  [[nodiscard]] std::vector<LevelCommand> dark() const {
    std::vector<LevelCommand> all = before_;
    for (LevelCommand& command : all) command.drive = 0;
    return all;
  }

  static inline std::atomic<int> made_ = 0;
  static inline std::atomic<double> shared_ = 0;
  std::unique_ptr<Driver> whole_;
  std::string_view breakage_;
  int number_;
  int descriptor_ = -1;
  bool blocked_ = false;
  std::vector<LevelCommand> before_;
  std::deque<std::vector<LevelCommand>> unsent_;
  std::optional<Fault> lost_;
};

}  // namespace

std::span<const Breakage> breakages() { return kBreakages; }

std::unique_ptr<Driver> broken(std::unique_ptr<Driver> whole, std::string_view breakage) {
  const auto known =
      std::find_if(kBreakages.begin(), kBreakages.end(), [&](const Breakage& one) { return one.name == breakage; });
  if (known == kBreakages.end()) return whole;
  return std::make_unique<BrokenDriver>(std::move(whole), known->name);
}

}  // namespace luxrig
