#include "core/tasks/stage.h"

#include <algorithm>
#include <chrono>

namespace luxrig {
namespace {

constexpr double kLongest_s = 1e8;  // a condition variable can still wait this long

}  // namespace

Stage::Stage(const Watch& watch, std::string name, std::string first, std::optional<double> seconds)
    : tell_(watch.tell),
      name_(std::move(name)),
      can_be_taken_(watch.stop.stop_possible()),
      asked_(watch.stop, [this] { source_.request_stop(); }) {
  say(std::move(first));
  if (!seconds) return;
  const std::chrono::duration<double> time(std::clamp(*seconds, 0.0, kLongest_s));
  timer_ = std::thread([this, time] {
    std::unique_lock lock(mutex_);
    if (changed_.wait_for(lock, time, [this] { return ended_; })) return;
    time_is_up_ = true;
    lock.unlock();  // a callback of the token may query this stage
    source_.request_stop();
  });
}

Stage::~Stage() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_one();
  if (timer_.joinable()) timer_.join();
  if (tell_) tell_({name_, "", true, can_be_taken_});
}

bool Stage::time_is_up() const {
  const std::lock_guard lock(mutex_);
  return time_is_up_;
}

void Stage::say(std::string what) const {
  if (tell_) tell_({name_, std::move(what), false, can_be_taken_});
}

}  // namespace luxrig
