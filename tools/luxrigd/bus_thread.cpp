#include "tools/luxrigd/bus_thread.h"

#include <algorithm>

#include "tools/luxrigd/clock.h"
#include "tools/luxrigd/scheduling.h"

namespace luxrig {
namespace {

constexpr int kOutputPriority = 50;
constexpr Duration kHealthPeriod = std::chrono::milliseconds(200);
constexpr std::size_t kMostUnsentReadings = 1000;

}  // namespace

BusThread::BusThread(const Rig& rig, std::size_t bus, std::unique_ptr<Driver> driver, ProgramMailbox& programs,
                     std::size_t first_desk)
    : rig_(rig),
      bus_(bus),
      driver_(std::move(driver)),
      programs_(programs),
      bounds_(driver_->bounds()),
      first_desk_(first_desk),
      statistics_(bounds_.write_period),
      levels_(rig.fixtures.size()),
      joints_(rig.fixtures.size()) {
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    if (rig.fixtures[i].bus == bus) level_commands_.push_back({i, 0});
    const Fixture& fixture = rig.fixtures[i];
    const bool zooms_here = fixture.axes && fixture.range.zooms() && fixture.bus == bus;
    if (fixture.moves && (fixture.motion_bus() == bus || zooms_here)) aim_commands_.push_back({i, fixture.joints});
  }
  writes_ = (driver_->level_output() != nullptr && !level_commands_.empty()) ||
            (driver_->mover() != nullptr && !aim_commands_.empty());
  if (LevelInput* input = driver_->level_input()) desks_ = input->parts().size();
}

BusThread::~BusThread() { stop(); }

void BusThread::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void BusThread::stop() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void BusThread::run(const std::stop_token& stop) {
  // Fast, non-blocking buses get real-time scheduling; one that waits for a device's answer would gain nothing.
  if (bounds_.write_period > Duration::zero() && bounds_.write_period < std::chrono::milliseconds(60)) {
    realtime_ = make_realtime(kOutputPriority);
  }
  // A fault of activation is in the health report, and the driver goes on trying.
  (void)driver_->activate(now());
  const Duration cycle =
      writes_ ? bounds_.write_period : std::max(bounds_.read_period, Duration(std::chrono::milliseconds(20)));
  Time next = now();
  Time last_start{};
  Time next_read = next, next_health = next;
  while (!stop.stop_requested()) {
    const Time at = now();
    if (writes_) {
      if (last_start != Time{}) statistics_.record(at - last_start);
      last_start = at;
      listen(at);
      write(at);
    }
    if (driver_->lux_reader() != nullptr && at >= next_read) {
      read(now());
      next_read = std::max(next_read + bounds_.read_period, now());
    }
    if (at >= next_health) {
      publish_health(now());
      next_health = at + kHealthPeriod;
    }
    next += cycle;
    // After a stall go on from here: a burst of old frames helps nobody.
    if (const Time late = now(); late > next + cycle) next = late;
    const Time due = std::max(next, now());
    sleep_until(next);
    lateness_.record(due, now());
  }
  driver_->deactivate(now());
}

void BusThread::listen(Time at) {
  LevelInput* input = driver_->level_input();
  if (input == nullptr) return;
  const std::span<const DeskFrame> frames = input->listen(at);
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock) desk_frames_.assign(frames.begin(), frames.end());
}

void BusThread::write(Time at) {
  programs_.take(program_);
  if (program_.revision == 0) {  // nobody has said yet what the light shall be: leave it as it is
    // Axes are set up, and perhaps sent home, meanwhile.
    if (driver_->level_output() == nullptr) (void)driver_->mover()->move(at, {});
    return;
  }
  program_.levels_at(at, levels_);
  for (LevelCommand& command : level_commands_) {
    command.drive = drive_from_level(rig_.fixtures[command.fixture].dimmer_curve, levels_[command.fixture]);
  }
  program_.joints_at(at, joints_);
  for (AimCommand& command : aim_commands_) command.joints = joints_[command.fixture];
  if (LevelInput* input = driver_->level_input()) {
    for (std::size_t part = 0; part < desks_ && first_desk_ + part < program_.desks.size(); ++part) {
      input->set_silent(at, part, program_.desks[first_desk_ + part].silent);
    }
  }
  // Faults show in the health report.
  if (Mover* mover = driver_->mover(); mover != nullptr && !aim_commands_.empty()) (void)mover->move(at, aim_commands_);
  if (LevelOutput* output = driver_->level_output()) (void)output->write(at, level_commands_);
}

void BusThread::read(Time at) {
  auto fresh = driver_->lux_reader()->read(at);
  if (fresh) unsent_readings_.insert(unsent_readings_.end(), fresh->begin(), fresh->end());
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;
  readings_.insert(readings_.end(), unsent_readings_.begin(), unsent_readings_.end());
  if (readings_.size() > kMostUnsentReadings) readings_.erase(readings_.begin(), readings_.end() - kMostUnsentReadings);
  unsent_readings_.clear();
}

void BusThread::publish_health(Time at) {
  auto report = driver_->health(at);
  auto carried = driver_->carried();
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;
  health_ = std::move(report);
  carried_ = std::move(carried);
}

std::vector<CarriedUniverse> BusThread::carried() const {
  const std::lock_guard lock(mutex_);
  return carried_;
}

std::vector<DeskFrame> BusThread::desk_frames() const {
  const std::lock_guard lock(mutex_);
  return desk_frames_;
}

std::vector<LuxReading> BusThread::take_readings() {
  const std::lock_guard lock(mutex_);
  return std::exchange(readings_, {});
}

std::vector<Health> BusThread::health() const {
  const std::lock_guard lock(mutex_);
  return health_;
}

}  // namespace luxrig
