#include "tools/luxrigd/bus_thread.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

#include "core/output/dimming.h"
#include "core/output/head_travel.h"
#include "tools/luxrigd/scheduling.h"
#include "tools/process/clock.h"

namespace luxrig {
namespace {

constexpr int kOutputPriority = 50;
constexpr Duration kHealthPeriod = std::chrono::milliseconds(200);
constexpr std::size_t kMaxUnsentReadings = 1000;
/// A desk does not say from which side a head comes.
constexpr Approach kBetween{0, 0};
constexpr Duration kDarkAgain = std::chrono::milliseconds(5);

}  // namespace

BusThread::BusThread(const Rig& rig, std::size_t bus, std::unique_ptr<Driver> driver, ProgramMailbox& programs,
                     std::size_t first_desk, OutputOrders orders)
    : rig_(rig),
      bus_(bus),
      driver_(std::move(driver)),
      programs_(programs),
      orders_(std::move(orders)),
      bounds_(driver_->bounds()),
      wake_fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      first_desk_(first_desk),
      statistics_(bounds_.write_period),
      levels_(rig.fixtures.size()),
      joints_(rig.fixtures.size()),
      return_(rig.fixtures.size(), bounds_.write_period) {
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    if (rig.fixtures[i].bus == bus) level_commands_.push_back({i, 0});
    const Fixture& fixture = rig.fixtures[i];
    const bool zooms_here = fixture.axes && fixture.range.zooms() && fixture.bus == bus;
    if (fixture.moves && (fixture.motion_bus() == bus || zooms_here)) aim_commands_.push_back({i, fixture.joints});
  }
  senders_.resize(aim_commands_.size());
  writes_ = (driver_->level_output() != nullptr && !level_commands_.empty()) ||
            (driver_->mover() != nullptr && !aim_commands_.empty());
  if (LevelInput* input = driver_->level_input()) desks_ = input->parts().size();
  has_contact_ = driver_->contact(Time{}).has_value();
}

BusThread::~BusThread() {
  stop();
  if (wake_fd_ >= 0) ::close(wake_fd_);
}

void BusThread::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void BusThread::stop() {
  if (thread_.joinable()) {
    thread_.request_stop();
    wake();
    thread_.join();
  }
  if (active_) driver_->deactivate(now());
  active_ = false;
}

void BusThread::wake() {
  const std::uint64_t one = 1;
  if (wake_fd_ >= 0) (void)!::write(wake_fd_, &one, sizeof one);
}

void BusThread::pause_until(Time wake_at) {
  if (wake_fd_ < 0) return sleep_until(wake_at);
  const Duration left = std::max(wake_at - now(), Duration{});
  const timespec timeout{left.count() / 1'000'000'000, left.count() % 1'000'000'000};
  pollfd wait{wake_fd_, POLLIN, 0};
  if (::ppoll(&wait, 1, &timeout, nullptr) != 1) return;
  std::uint64_t count = 0;
  (void)!::read(wake_fd_, &count, sizeof count);
}

void BusThread::run(const std::stop_token& stop) {
  // Fast, non-blocking buses get real-time scheduling. A bus that waits for a device's answer would gain nothing.
  if (bounds_.write_period > Duration::zero() && bounds_.write_period < std::chrono::milliseconds(60)) {
    realtime_ = make_realtime(kOutputPriority);
  }
  const Duration cycle =
      writes_ ? bounds_.write_period : std::max(bounds_.read_period, Duration(std::chrono::milliseconds(20)));
  Time next = now();
  Time last_start{};
  bool in_turn = true;
  while (!stop.stop_requested()) {
    const Time at = now();
    if (writes_ && in_turn) {  // an extra frame for a blackout does not count as an interval
      if (last_start != Time{}) statistics_.record(at - last_start);
      last_start = at;
    }
    turn(at);
    if (in_turn) next += cycle;
    // After a stall, continue from now: a burst of old frames is useless.
    if (const Time late = now(); late > next + cycle) next = late;
    const Time due = std::max(next, now());
    pause_until(is_to_be_dark() ? std::min(next, now() + kDarkAgain) : next);
    in_turn = now() >= next;  // else wake() was called
    if (in_turn) lateness_.record(due, now());
  }
}

/// A blackout was ordered and has not reached every lamp: a device has a minimum time between two writes.
bool BusThread::is_to_be_dark() const {
  return orders_.blackout != nullptr && lights() && orders_.blackout->dark() && dark_order() < orders_.blackout->number();
}

void BusThread::turn(Time at) {
  if (!active_) {
    // A fault of activation shows in the health report, and the driver keeps trying.
    (void)driver_->activate(at);
    active_ = true;
    next_read_ = next_health_ = at;
  }
  if (writes_) {
    listen(at);
    write(at);
    if (orders_.guarded != nullptr) orders_.guarded->beat(LastLookMemory::Beat::output);
  }
  if (driver_->lux_reader() != nullptr && at >= next_read_) {
    read(now());
    next_read_ = std::max(next_read_ + bounds_.read_period, now());
  }
  if (has_contact_) look_at_contact(now());
  if (at >= next_health_) {
    publish_health(now());
    next_health_ = at + kHealthPeriod;
  }
}

void BusThread::listen(Time at) {
  LevelInput* input = driver_->level_input();
  if (input == nullptr) return;
  const std::span<const DeskFrame> frames = input->listen(at);
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;
  desk_frames_.assign(frames.begin(), frames.end());
  for (DeskFrame& frame : desk_frames_)
    for (DeskCommand& command : frame.commands)
      if (const auto& map = rig_.fixtures[command.fixture].joint_map; map && command.joints)
        command.joints = map->reached_by(*command.joints, kBetween);
}

void BusThread::write(Time at) {
  // The guardian sends, so the last frame is unknown to the return from a stall.
  if (orders_.guarded != nullptr && orders_.guarded->guardian_has_the_light()) return return_.forget();
  // Read the number before the order itself, and both before the program that may undo it.
  const std::uint64_t order = orders_.blackout != nullptr ? orders_.blackout->number() : 0;
  const bool dark = orders_.blackout != nullptr && orders_.blackout->dark();
  programs_.take(program_);
  if (program_.revision == 0 && !dark) {  // no program yet: leave the light as it is
    // Axes are set up, and perhaps homed, while there is no program.
    if (driver_->level_output() == nullptr) (void)driver_->mover()->move(at, {});
    return;
  }
  if (dark) {
    std::fill(levels_.begin(), levels_.end(), 0.0);
  } else {
    program_.levels_at(at, levels_);
  }
  return_.apply(at, program_, dark || program_.blackout, levels_);
  for (LevelCommand& command : level_commands_) {
    command.drive = drive_for(rig_.fixtures[command.fixture], levels_[command.fixture]);
  }
  if (program_.revision != 0) aim(at);
  if (LevelInput* input = driver_->level_input()) {
    for (std::size_t part = 0; part < desks_ && first_desk_ + part < program_.desks.size(); ++part) {
      // In a blackout we also send, dark, the lamps that a desk drives itself.
      input->set_silent(at, part, program_.desks[first_desk_ + part].silent && !dark && !program_.blackout);
    }
  }
  // Faults show in the health report.
  if (Mover* mover = driver_->mover(); mover != nullptr && !aim_commands_.empty()) (void)mover->move(at, aim_commands_);
  LevelOutput* output = driver_->level_output();
  if (output == nullptr) return;
  const bool written = output->write(at, level_commands_).has_value() && output->settled();
  if (written && dark) dark_order_.store(order, std::memory_order_release);
}

/// The only place where true joints become those that are sent.
void BusThread::aim(Time at) {
  program_.joints_at(at, joints_);
  for (std::size_t k = 0; k < aim_commands_.size(); ++k) {
    AimCommand& command = aim_commands_[k];
    const Fixture& fixture = rig_.fixtures[command.fixture];
    command.joints = joints_[command.fixture];
    if (!fixture.joint_map) continue;
    Sender& sender = senders_[k];
    if (!sender.whence_known) sender.whence_known = at + from_seconds(travel_s(fixture, std::nullopt, command.joints));
    command.joints = at < *sender.whence_known ? sender.joints.send_beside(*fixture.joint_map, command.joints)
                                               : sender.joints.send(*fixture.joint_map, command.joints);
  }
}

void BusThread::read(Time at) {
  auto fresh = driver_->lux_reader()->read(at);
  if (fresh) unsent_readings_.insert(unsent_readings_.end(), fresh->begin(), fresh->end());
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;
  readings_.insert(readings_.end(), unsent_readings_.begin(), unsent_readings_.end());
  if (readings_.size() > kMaxUnsentReadings) readings_.erase(readings_.begin(), readings_.end() - kMaxUnsentReadings);
  unsent_readings_.clear();
}

void BusThread::look_at_contact(Time at) {
  const Contact contact = driver_->contact(at).value_or(Contact::unknown);
  if (contact_.exchange(contact) != contact && contact == Contact::pressed && orders_.pressed) orders_.pressed();
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
