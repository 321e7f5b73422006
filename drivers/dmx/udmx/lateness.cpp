#include "drivers/dmx/udmx/lateness.h"

#include <algorithm>

namespace luxrig::udmx {
namespace {

constexpr Duration kMaxBetweenSteps = std::chrono::milliseconds(100);

}  // namespace

void Lateness::step(Time now, bool up_to_date) {
  const Duration passed = std::clamp(now - last_.value_or(now), Duration{}, kMaxBetweenSteps);
  last_ = now;
  const auto before = clock_ / kPart;
  clock_ += passed;
  if (clock_ / kPart != before) part() = {};  // its old content has left the window
  if (up_to_date) {
    behind_since_.reset();
  } else if (!behind_since_) {
    behind_since_ = clock_;
  }
  if (behind_since_ && clock_ - *behind_since_ > kUdmxLateAfter) {
    part().late += std::min(passed, clock_ - *behind_since_ - kUdmxLateAfter);
    late_at_ = clock_;
  }
  known_ = known_ ? clock_ - late_at_ < kUdmxInTimeFor : late_at_ == clock_ && late_for() >= kUdmxLateFor;
}

void Lateness::sent() {
  sent_at_ = clock_;
  ++part().transfers;
}

void Lateness::arrived() {
  if (behind_since_) behind_since_ = std::max(*behind_since_, sent_at_);
}

void Lateness::went_wrong() { ++part().failures; }

Duration Lateness::late_for() const {
  Duration sum{};
  for (const Part& part : parts_) sum += part.late;
  return sum;
}

std::uint32_t Lateness::transfers() const {
  std::uint32_t sum = 0;
  for (const Part& part : parts_) sum += part.transfers;
  return sum;
}

std::uint32_t Lateness::failures() const {
  std::uint32_t sum = 0;
  for (const Part& part : parts_) sum += part.failures;
  return sum;
}

}  // namespace luxrig::udmx
