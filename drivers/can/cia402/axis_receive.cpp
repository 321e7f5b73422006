// An axis's handling of frames from its node.
#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "drivers/can/canopen/cob_id.h"
#include "drivers/can/cia402/axis.h"
#include "drivers/can/cia402/drive_objects.h"

namespace luxrig::cia402 {
namespace {

using canopen::NmtState;

constexpr std::uint32_t kDriveProfile = 402;
constexpr double kTargetSlack_s = 0.005, kRereadSlack_s = 0.02;  ///< as a distance at full speed

}  // namespace

void Axis::heartbeat_heard(Time now, NmtState state) {
  const bool reset = state == NmtState::boot_up;
  heartbeat_.heard(now, state);
  if (reset) {  // it has forgotten everything, including its position
    failures_ = 0;
    begin_setup(now);
    return;
  }
  switch (phase_) {
    case Phase::absent:
      if (set_up_once_ && state == NmtState::operational) {
        enter(now, Phase::checking);
        sdo_.start({kConsumer, {}});
      } else {
        begin_setup(now);
      }
      break;
    case Phase::running:
      if (state != NmtState::operational) begin_setup(now);  // reset unseen, or stopped by another master
      break;
    default:
      break;
  }
}

void Axis::receive(Time now, const can::CanFrame& frame) {
  if (frame.error || frame.extended || frame.remote) return;
  const auto node = static_cast<std::uint32_t>(settings_.node);
  const auto& data = frame.data;
  if (frame.id == canopen::kHeartbeat + node) {
    if (const auto state = canopen::decode_heartbeat(frame)) heartbeat_heard(now, *state);
  } else if (frame.id == canopen::kSdoToClient + node) {
    sdo_.receive(frame);
    take_sdo_result(now);
  } else if (frame.id == canopen::kTransmitPdo1 + node) {
    if (phase_ == Phase::setting_up) return;
    pdo_at_ = now;
    const auto report = reports_.take(now, frame.payload(), referenced_);
    if (!report) return;
    statusword_ = report->statusword;
    position_ = report->position;
    mode_ = report->mode;
    status_at_ = now;
    fresh_ = true;
  } else if (frame.id == canopen::kTransmitPdo1 + canopen::kNextPdo + node) {
    if (frame.size < 2) return;
    error_code_ = static_cast<std::uint16_t>(data[0] | data[1] << 8);
    velocity_ = frame.size < 6 ? 0 : static_cast<std::int32_t>(number_in({data.begin() + 2, data.begin() + 6}));
  } else if (frame.id == canopen::kEmergency + node) {
    if (const auto message = canopen::decode_emergency(frame); message && message->code != 0)
      error_code_ = message->code;
  }
}

void Axis::take_sdo_result(Time now) {
  const auto result = sdo_.take_result();
  if (!result) return;
  switch (phase_) {
    case Phase::absent:  // the probe was answered
      if (!result->has_value() && !result->error().abort_code) break;
      if (set_up_once_) {
        enter(now, Phase::checking);
        sdo_.start({kConsumer, {}});
      } else {
        begin_setup(now);
      }
      break;
    case Phase::checking: {
      // If it is still operational and still listens to us, it was not reset while away, so its position is valid.
      // Evidence of a reset must come twice, identically.
      if (!result->has_value() && !result->error().abort_code) return lost(now, "does not answer");
      const std::uint32_t entry = result->has_value() ? number_in(**result) : *result->error().abort_code;
      const bool same = result->has_value() && entry == consumer_entry(settings_);
      const auto state = heartbeat_.state(now);
      if (same && state == NmtState::operational) {
        enter(now, Phase::running);
      } else if (same ? !state && now - since_ < heartbeat_timeout(settings_) : other_entry_ != entry) {
        if (!same) other_entry_ = entry;
        sdo_.start({kConsumer, {}});  // wait for its heartbeat
      } else {
        begin_setup(now);
      }
      break;
    }
    case Phase::setting_up:
      take_setup_result(now, *result);
      break;
    case Phase::running:
      if (telling_) return take_told(now, *result);
      if (rereading_) take_reread(now, *result);  // else the mode of operation was written; its display shows it
      break;
    case Phase::starting:
    case Phase::failed:
      break;
  }
}

void Axis::take_setup_result(Time now, const canopen::SdoResult& result) {
  const SetupStep& step = steps_[step_];
  if (!result) {
    if (!result.error().abort_code) return lost(now, "does not answer");
    if (limits_go_by_sdo(step.request, *result.error().abort_code)) return;
    if (!step.optional) {
      return failed(now, fmt::format("refuses object {}: {}", canopen::text_of(step.request.object),
                                     canopen::abort_text(*result.error().abort_code)));
    }
  } else if (step.request.object == kDeviceType) {
    if ((number_in(*result) & 0xFFFF) != kDriveProfile) {
      return failed(now, fmt::format("is no CiA 402 drive: its device type is {:08X}", number_in(*result)));
    }
  } else if (step.request.object == kDeviceName) {
    drive_name_.clear();
    for (const std::uint8_t byte : *result) {
      if (byte >= 0x20 && byte < 0x7F && drive_name_.size() < 40) drive_name_ += static_cast<char>(byte);
    }
  } else if (step.request.object == kControlword) {
    if (!told_to_stop_) told_to_stop_ = now;
  } else if (step.request.object == kSupportedModes) {
    const std::uint32_t modes = number_in(*result);
    const auto has = [modes](int mode) { return (modes >> (mode - 1) & 1) != 0; };
    if (!has(kProfilePosition)) return failed(now, "has no profile position mode (object 6502)");
    if (settings_.home != HomeRule::never && !has(kHoming)) return failed(now, "has no homing mode (object 6502)");
  }
  ++step_;
}

void Axis::take_reread(Time now, const canopen::SdoResult& result) {
  const canopen::ObjectAddress object = *std::exchange(rereading_, std::nullopt);
  const bool refused = !result && result.error().abort_code;
  const auto off = [&](std::int32_t from) {
    return std::abs(static_cast<double>(static_cast<std::int32_t>(number_in(*result))) - from);
  };
  if (object == kTargetPosition) {
    const auto& order = handshake_.current();
    if (!result || !order || order->position != target_told_ || !handshake_.idle()) return;
    if (off(order->position) > kTargetSlack_s * settings_.speed + 2)
      reports_.doubt(now, fmt::format("its target was set to {} counts and is another", order->position));
    return;
  }
  if (!reports_.doubted()) return;
  if (!refused && (!result || off(position_) > kRereadSlack_s * settings_.speed + 2)) return reports_.unsettle();
  if (!reports_.kept_its_place()) {
    if (settings_.home == HomeRule::never)
      return failed(now, "stands where it cannot have come to: look at its encoder, then switch it off and on");
    referenced_ = false;
  }
  reports_.believe();
  doubt_counted_ = false;
}

}  // namespace luxrig::cia402
