#include "drivers/can/cia402/axis.h"

#include <fmt/format.h>

#include "drivers/can/canopen/cob_id.h"
#include "drivers/can/canopen/pdo_setup.h"

namespace luxrig::cia402 {
namespace {

using canopen::little_endian;
using canopen::NmtCommand;
using canopen::NmtState;
using std::chrono::milliseconds;

constexpr int kProfilePosition = 1, kHoming = 6;
constexpr std::uint32_t kDriveProfile = 402;
constexpr Duration kStartAgain = milliseconds(500), kStartTimeout = milliseconds(3000);
constexpr Duration kResetPause = milliseconds(1000), kResetPulse = milliseconds(200);
constexpr Duration kTryRefusedAgain = milliseconds(5000);
constexpr Duration kForgiveAfter = milliseconds(30000);
constexpr int kHomingAnswers = 3;  ///< statuswords after the start before one is believed: the first may be older

/// What is read before the first write.
constexpr canopen::ObjectAddress kDeviceType{0x1000, 0}, kDeviceName{0x1008, 0}, kSupportedModes{0x6502, 0},
    kConsumer{0x1016, 1};

std::uint32_t number_in(const std::vector<std::uint8_t>& bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size() && i < 4; ++i) value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  return value;
}

void append(std::vector<std::uint8_t>& to, std::uint32_t value, int bytes) {
  const auto more = little_endian(value, bytes);
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

Axis::Axis(const AxisSettings& settings)
    : settings_(settings), sdo_(settings.node), heartbeat_(heartbeat_timeout(settings)) {
  steps_ = {{{kDeviceType, {}}, false}, {{kDeviceName, {}}, true}, {{kSupportedModes, {}}, false}};
  for (SetupStep& step : setup_steps(settings)) steps_.push_back(std::move(step));
}

void Axis::activate(Time now) {
  *this = Axis(settings_);
  since_ = now;
  why_ = "has not answered yet";
}

void Axis::enter(Time now, Phase phase) {
  phase_ = phase;
  since_ = now;
  sdo_.cancel();
  handshake_.forget();
  homing_since_.reset();
  reset_at_.reset();
  ready_since_.reset();
}

void Axis::lost(Time now, std::string why) {
  enter(now, Phase::absent);
  why_ = std::move(why);
  status_at_.reset();
  heartbeat_.forget();
}

void Axis::failed(Time now, std::string why) {
  refused_ = phase_ == Phase::setting_up;
  enter(now, Phase::failed);
  why_ = std::move(why);
}

void Axis::begin_setup(Time now) {
  enter(now, Phase::setting_up);
  referenced_ = settings_.home == HomeRule::never;
  status_at_.reset();
  step_ = 0;
  nmt_due_ = true;
}

bool Axis::sound() const {
  if (phase_ != Phase::running || !status_at_) return false;
  const DriveState state = state_of(statusword_);
  return state != DriveState::fault && state != DriveState::fault_reaction_active && state != DriveState::unknown;
}

bool Axis::ready() const {
  return sound() && !stands_still_ && referenced_ && mode_ == kProfilePosition &&
         state_of(statusword_) == DriveState::operation_enabled;
}

// --- what comes from the bus ---

void Axis::heartbeat_heard(Time now, NmtState state) {
  const bool reset = state == NmtState::boot_up;
  heartbeat_.heard(now, state);
  if (reset) {  // it has forgotten everything, its position included
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
      if (state != NmtState::operational) begin_setup(now);  // reset unseen, or taken out of service by another
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
    if (frame.size < 7 || phase_ == Phase::setting_up) return;
    statusword_ = static_cast<std::uint16_t>(data[0] | data[1] << 8);
    position_ = static_cast<std::int32_t>(number_in({data.begin() + 2, data.begin() + 6}));
    mode_ = static_cast<std::int8_t>(data[6]);
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
      // Still operational and still listening to us: it has not been reset while it was away, so its position holds.
      if (!result->has_value() && !result->error().abort_code) return lost(now, "does not answer");
      const bool same = result->has_value() && number_in(**result) == consumer_entry(settings_);
      const auto state = heartbeat_.state(now);
      if (same && state == NmtState::operational) {
        enter(now, Phase::running);
      } else if (same && !state && now - since_ < heartbeat_timeout(settings_)) {
        sdo_.start({kConsumer, {}});  // its heartbeat is still to come
      } else {
        begin_setup(now);
      }
      break;
    }
    case Phase::setting_up:
      take_setup_result(now, *result);
      break;
    case Phase::running:  // the mode of operation: its display tells
    case Phase::starting:
    case Phase::failed:
      break;
  }
}

void Axis::take_setup_result(Time now, const canopen::SdoResult& result) {
  const SetupStep& step = steps_[step_];
  if (!result) {
    if (!result.error().abort_code) return lost(now, "does not answer");
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
  } else if (step.request.object == kSupportedModes) {
    const std::uint32_t modes = number_in(*result);
    const auto has = [modes](int mode) { return (modes >> (mode - 1) & 1) != 0; };
    if (!has(kProfilePosition)) return failed(now, "has no profile position mode (object 6502)");
    if (settings_.home != HomeRule::never && !has(kHoming)) return failed(now, "has no homing mode (object 6502)");
  }
  ++step_;
}

// --- what goes to the bus ---

void Axis::next_setup_step(Time now, Frames& out) {
  if (nmt_due_) {
    nmt_due_ = false;
    out.push_back(canopen::nmt_frame(NmtCommand::pre_operational, settings_.node));
  }
  if (!sdo_.idle()) return;
  if (step_ < steps_.size()) return sdo_.start(steps_[step_].request);
  enter(now, Phase::starting);
  set_up_once_ = true;
  nmt_sent_ = now - kStartAgain;
}

void Axis::watch(Time now) {
  if (phase_ == Phase::starting) {
    if (heartbeat_.state(now) == NmtState::operational && status_at_) enter(now, Phase::running);
    if (now - since_ > kStartTimeout) lost(now, "does not become operational");
  } else if (phase_ == Phase::running) {
    const auto patience_ms = std::chrono::duration_cast<milliseconds>(heartbeat_timeout(settings_)).count();
    if (!heartbeat_.state(now)) return lost(now, fmt::format("no heartbeat for {} ms", patience_ms));
    if (now - std::max(since_, status_at_.value_or(since_)) > heartbeat_timeout(settings_))
      return lost(now, fmt::format("no statusword for {} ms", patience_ms));
  } else if (phase_ == Phase::failed && refused_ && now - since_ > kTryRefusedAgain) {
    lost(now, why_);
  }
}

void Axis::step(Time now, bool stand_still, bool asked, Frames& out) {
  asked_ = asked;
  stands_still_ = stand_still;
  watch(now);
  switch (phase_) {
    case Phase::absent:
      if (sdo_.idle()) sdo_.start({kDeviceType, {}});
      break;
    case Phase::checking:
      break;
    case Phase::setting_up:
      next_setup_step(now, out);
      break;
    case Phase::starting:
      if (now - nmt_sent_ >= kStartAgain) {
        nmt_sent_ = now;
        out.push_back(canopen::nmt_frame(NmtCommand::start, settings_.node));
      }
      send_pdos(kDisableVoltage, out);
      break;
    case Phase::running:
      if (status_at_) send_pdos(control(now, stand_still, asked), out);
      break;
    case Phase::failed:
      if (set_up_once_) send_pdos(kQuickStop, out);
      break;
  }
  fresh_ = false;
  while (const auto frame = sdo_.to_send(now)) out.push_back(*frame);
  take_sdo_result(now);
}

void Axis::stop(Frames& out) const {
  if (set_up_once_) send_pdos(kQuickStop, out);
}

void Axis::send_pdos(std::uint16_t controlword, Frames& out) const {
  const auto node = static_cast<std::uint32_t>(settings_.node);
  const auto& order = handshake_.current();
  std::vector<std::uint8_t> bytes;
  if (order && handshake_.limits_due()) {
    append(bytes, order->speed, 4);
    append(bytes, order->acceleration, 4);
    out.push_back(can::data_frame(canopen::kReceivePdo1 + canopen::kNextPdo + node, bytes));
    out.push_back(
        can::data_frame(canopen::kReceivePdo1 + 2 * canopen::kNextPdo + node, little_endian(order->acceleration, 4)));
    bytes.clear();
  }
  append(bytes, controlword, 2);
  append(bytes, static_cast<std::uint32_t>(order ? order->position : position_), 4);
  out.push_back(can::data_frame(canopen::kReceivePdo1 + node, bytes));
}

// --- the drive ---

std::uint16_t Axis::control(Time now, bool stand_still, bool asked) {
  const DriveState state = state_of(statusword_);
  const bool enabled = state == DriveState::operation_enabled;
  if (!enabled || stand_still) {
    handshake_.forget();
    homing_since_.reset();
    ready_since_.reset();
  }
  if (state == DriveState::fault) return reset_fault(now);
  reset_at_.reset();
  if (stand_still) return enabled || state == DriveState::quick_stop_active ? kQuickStop : kDisableVoltage;
  if (!enabled) return towards_operation(state, settings_.hold_on_stop);
  if (!referenced_) {
    if (settings_.home == HomeRule::when_needed && !asked) return kEnableOperation;
    return go_home(now);
  }
  if (!in_mode(kProfilePosition)) return kEnableOperation;
  if (!ready_since_) ready_since_ = now;
  if (now - *ready_since_ > kForgiveAfter) failures_ = 0;
  return handshake_.step(now, statusword_, fresh_);
}

bool Axis::in_mode(int mode) {
  if (mode_ == mode) return true;
  if (sdo_.idle()) sdo_.start({{0x6060, 0}, {static_cast<std::uint8_t>(mode)}});
  return false;
}

std::uint16_t Axis::go_home(Time now) {
  if (!in_mode(kHoming)) return kEnableOperation;
  if (!homing_since_) {  // a cycle with bit 4 low, so that the drive sees it rise
    homing_since_ = now;
    homing_answers_ = 0;
    return kEnableOperation;
  }
  if (now - *homing_since_ > settings_.homing_timeout) {
    failed(now, fmt::format("did not find its home position in {:.0f} s: a switch or the motor does not work",
                            to_seconds(settings_.homing_timeout)));
    return kQuickStop;
  }
  if (fresh_ && ++homing_answers_ > kHomingAnswers) {
    if ((statusword_ & kHomingError) != 0) {
      count_failure(now, "homing failed");
      homing_since_.reset();
      return kEnableOperation;
    }
    if ((statusword_ & kHomingAttained) != 0 && (statusword_ & kTargetReached) != 0) {
      referenced_ = true;
      homing_since_.reset();
      return kEnableOperation;
    }
  }
  return kEnableOperation | kNewSetPoint;
}

std::uint16_t Axis::reset_fault(Time now) {
  if (error_code_ >> 8 == 0x73 && settings_.home != HomeRule::never) referenced_ = false;  // an encoder lost count
  if (!reset_at_ || now - *reset_at_ > kResetPulse) {
    reset_at_ = now + kResetPause;
    count_failure(now, canopen::error_text(error_code_));
  }
  return now >= *reset_at_ ? kFaultReset : kDisableVoltage;
}

void Axis::count_failure(Time now, const std::string& why) {
  if (++failures_ <= settings_.fault_resets) return;
  failed(now, fmt::format("{}, {} times in a row: look at the drive, then switch it off and on", why, failures_));
}

std::string Axis::trouble() const {
  const std::string who = fmt::format("node {}{}", settings_.node, drive_name_.empty() ? "" : " (" + drive_name_ + ")");
  switch (phase_) {
    case Phase::absent:
    case Phase::failed:
      return who + ": " + why_;
    case Phase::checking:
    case Phase::setting_up:
      return who + " is being set up";
    case Phase::starting:
      return who + " is being started";
    case Phase::running:
      break;
  }
  const DriveState state = state_of(statusword_);
  if (state == DriveState::fault || state == DriveState::fault_reaction_active)
    return fmt::format("{} has a fault: {}", who, canopen::error_text(error_code_));
  if (stands_still_) return who + " stands still because the other axis of its head is out of service";
  if (state != DriveState::operation_enabled) return fmt::format("{} is {}", who, name_of(state));
  if (referenced_) return mode_ == kProfilePosition ? "" : who + " changes its mode";
  if (settings_.home == HomeRule::when_needed && !asked_) return "";
  // Without a figure that grows: each text is an alarm of its own.
  return who + (homing_since_ ? " is on its way to its home position" : " does not know its position");
}

}  // namespace luxrig::cia402
