// Speed and acceleration of a move, for a drive that cannot receive them by PDO.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "drivers/can/canopen/pdo_setup.h"
#include "drivers/can/cia402/axis.h"
#include "drivers/can/cia402/drive_objects.h"

namespace luxrig::cia402 {
namespace {

// CiA 301, SDO abort codes: cannot be mapped, would be too long, value out of range.
constexpr std::uint32_t kNotMappable = 0x06040041, kPdoTooLong = 0x06040042, kValueOutOfRange = 0x06090030;
constexpr std::uint16_t kLimitsMapping = 0x1601, kBrakingMapping = 0x1602;  ///< of RPDO 2 and 3
constexpr Duration kTellAgain = std::chrono::milliseconds(1000);

bool is_of_limits_pdos(const SetupStep& step) {
  const std::uint16_t index = step.request.object.index;
  return index == kLimitsMapping || index == kBrakingMapping || index == kLimitsMapping - 0x200 ||
         index == kBrakingMapping - 0x200;
}

}  // namespace

/// Skips the rest of the set-up of those two PDOs. A mapping of the maker's own may be active; it must not receive our
/// data.
bool Axis::limits_go_by_sdo(const canopen::SdoRequest& refused, std::uint32_t abort_code) {
  if (refused.object.index != kLimitsMapping && refused.object.index != kBrakingMapping) return false;
  if (abort_code != kNotMappable && abort_code != kPdoTooLong && abort_code != kValueOutOfRange) return false;
  limits_by_sdo_ = true;
  ++step_;
  const auto next = steps_.begin() + static_cast<std::ptrdiff_t>(step_);
  steps_.erase(std::remove_if(next, steps_.end(), is_of_limits_pdos), steps_.end());
  for (const int number : {3, 2})
    steps_.insert(steps_.begin() + static_cast<std::ptrdiff_t>(step_),
                  {canopen::pdo_off(canopen::PdoDirection::to_node, number, settings_.node), true});
  return true;
}

/// Accelerations come first, so a drive that applies a new speed at once has its ramp already.
std::optional<canopen::SdoRequest> Axis::limit_to_tell() const {
  const auto& order = handshake_.current();
  if (!order) return std::nullopt;
  const std::pair<canopen::ObjectAddress, std::uint32_t> wanted[] = {
      {kAcceleration, order->acceleration}, {kDeceleration, order->acceleration}, {kProfileSpeed, order->speed}};
  for (const auto& [object, value] : wanted) {
    const auto told = told_.find(object.index);
    if (told == told_.end() || told->second != value)
      return canopen::SdoRequest{object, canopen::little_endian(value, 4)};
  }
  return std::nullopt;
}

bool Axis::limits_told() const {
  if (!limits_by_sdo_) return true;
  return !handshake_.pending() && (!handshake_.prepared() || !limit_to_tell());
}

void Axis::tell_limits(Time now) {
  if (!limits_by_sdo_ || !handshake_.prepared() || rereading_ || !sdo_.idle() || now < tell_again_at_) return;
  telling_ = limit_to_tell();
  if (!telling_) return;
  told_.erase(telling_->object.index);  // whatever the outcome
  sdo_.start(*telling_);
}

void Axis::take_told(Time now, const canopen::SdoResult& result) {
  const canopen::SdoRequest request = *std::exchange(telling_, std::nullopt);
  if (result) {
    told_[request.object.index] = number_in(request.value);
    return;
  }
  tell_again_at_ = now + kTellAgain;
  const std::string object = canopen::text_of(request.object);
  count_failure(now, result.error().abort_code
                         ? fmt::format("refuses object {}: {}", object, canopen::abort_text(*result.error().abort_code))
                         : fmt::format("does not answer to object {}", object));
}

std::string Axis::remark() const {
  if (!limits_by_sdo_) return {};
  return fmt::format(
      "node {} cannot be told speed and acceleration by PDO: they are written by SDO before each move, which begins "
      "some cycles later",
      settings_.node);
}

}  // namespace luxrig::cia402
