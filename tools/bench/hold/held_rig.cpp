#include "tools/bench/hold/held_rig.h"

#include <algorithm>
#include <utility>

#include "core/output/dimming.h"

namespace luxrig {
namespace {

/// A show is stepped at 50 Hz while its light fades, and at the pace of its meters while it stands still.
constexpr Duration kStep = std::chrono::milliseconds(20), kStillStep = std::chrono::milliseconds(200);
/// The slowest meter's latency, and a sample of it.
constexpr Duration kSlowestMeter = std::chrono::milliseconds(2300);

}  // namespace

HeldRig::HeldRig(const Rig& rig, const LightModel& model, std::unique_ptr<sim::World> world)
    : rig_(rig), devices_(rig, std::move(world)), show_(rig, model) {}

void HeldRig::knock(std::unique_ptr<sim::World> knocked) {
  knocked_ = std::make_unique<sim::InProcessRig>(rig_, std::move(knocked));
}

std::vector<double> HeldRig::levels() const {
  std::vector<double> level(rig_.fixtures.size());
  show_.program().levels_at(now_, level);
  return level;
}

bool HeldRig::run(double seconds, const std::function<bool()>& so) {
  for (const Time end = now_ + from_seconds(seconds); now_ < end;) {
    tick();
    if (so && so()) return true;
  }
  return so && so();
}

std::optional<double> HeldRig::told(double within_s, const std::vector<std::string>& parts) {
  const Time begun = now_;
  const auto told = [&] {
    if ((now_ - begun) % std::chrono::milliseconds(500) != Duration{}) return false;
    const ShowStatus now = status();
    return std::any_of(now.alarms.begin(), now.alarms.end(), [&](const Alarm& alarm) {
      return std::all_of(parts.begin(), parts.end(),
                         [&](const std::string& part) { return alarm.text.find(part) != std::string::npos; });
    });
  };
  if (!run(within_s, told)) return std::nullopt;
  return to_seconds(now_ - begun);
}

void HeldRig::rest(double seconds) {
  now_ += from_seconds(seconds);
  devices_.stride(now_);
}

void HeldRig::wake() {
  now_ += kSlowestMeter;
  devices_.advance(now_);
}

void HeldRig::tick() {
  now_ += sim::kTick;
  const bool still = show_.program().done(now_);
  if (now_ - stepped_ < (still ? kStillStep : kStep)) return;
  stepped_ = now_;
  if (auto readings = (reads_knocked_ ? *knocked_ : devices_).read(now_))
    for (LuxReading& reading : *readings) {
      if (as_read) as_read(reading);
      show_.reading(now_, reading);
    }
  if (now_ - told_ >= kStillStep) {
    show_.health(now_, devices_.health(now_));
    told_ = now_;
  }
  const Phase before = show_.phase();
  show_.step(now_);
  corrections_ += before != Phase::correcting && show_.phase() == Phase::correcting;
  const std::vector<double> level = levels();
  std::vector<LevelCommand> commands;
  for (std::size_t f = 0; f < level.size(); ++f) commands.push_back({f, drive_for(rig_.fixtures[f], level[f])});
  if (on_the_way) on_the_way(commands);
  (void)devices_.write(now_, commands);
  if (!knocked_) return;
  (void)knocked_->write(now_, commands);
  if (!reads_knocked_) (void)knocked_->read(now_);
}

}  // namespace luxrig
