#include "tools/bench/hold/held_rig.h"

#include <algorithm>
#include <utility>

#include "core/output/dimming.h"

namespace luxrig {

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

void HeldRig::tick() {
  now_ += sim::kTick;
  if ((now_ - Time{}) / sim::kTick % 2 != 0) return;
  if (auto readings = (reads_knocked_ ? *knocked_ : devices_).read(now_))
    for (LuxReading& reading : *readings) {
      if (as_read) as_read(reading);
      show_.reading(now_, reading);
    }
  if ((now_ - Time{}) / sim::kTick % 10 == 0) show_.health(now_, devices_.health(now_));
  show_.step(now_);
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
