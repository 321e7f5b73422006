#include "drivers/can/cia402/axis.h"

#include <fmt/format.h>

#include <cmath>

#include "drivers/can/canopen/cob_id.h"
#include "drivers/can/canopen/pdo_setup.h"
#include "drivers/can/cia402/drive_objects.h"

namespace luxrig::cia402 {
namespace {

using canopen::little_endian;
using canopen::NmtCommand;
using canopen::NmtState;
using std::chrono::milliseconds;

constexpr Duration kStartAgain = milliseconds(500), kStartTimeout = milliseconds(3000);
constexpr Duration kResetPause = milliseconds(1000), kResetPulse = milliseconds(200);
constexpr Duration kTryRefusedAgain = milliseconds(5000);
constexpr Duration kForgiveAfter = milliseconds(30000);
constexpr int kHomingAnswers = 3;      ///< statuswords skipped after the start, as the first may be older
constexpr int kEndedAnswers = 3;       ///< in a row that report the end: every later move depends on the home position
constexpr double kHomeSlack_s = 0.05;  ///< as a distance at full speed

void append(std::vector<std::uint8_t>& to, std::uint32_t value, int bytes) {
  const auto more = little_endian(value, bytes);
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

Axis::Axis(const AxisSettings& settings)
    : settings_(settings), sdo_(settings.node), heartbeat_(heartbeat_timeout(settings)), reports_(settings) {}

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
  rereading_.reset();
  other_entry_.reset();
  target_told_.reset();
  told_.clear();
  telling_.reset();
}

void Axis::lost(Time now, std::string why) {
  enter(now, Phase::absent);
  why_ = std::move(why);
  status_at_.reset();
  pdo_at_.reset();
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
  pdo_at_.reset();
  reports_.forget();
  doubt_counted_ = false;
  steps_ = {{{kDeviceType, {}}, false}, {{kDeviceName, {}}, true}, {{kSupportedModes, {}}, false}};
  for (SetupStep& step : setup_steps(settings_)) steps_.push_back(std::move(step));
  limits_by_sdo_ = false;  // it may be another drive now
  step_ = 0;
  nmt_due_ = true;
}

bool Axis::sound() const {
  if (phase_ != Phase::running || !status_at_ || reports_.doubted()) return false;
  const DriveState state = state_of(statusword_);
  return state != DriveState::fault && state != DriveState::fault_reaction_active && state != DriveState::unknown;
}

bool Axis::ready() const {
  return sound() && !stands_still_ && referenced_ && mode_ == kProfilePosition &&
         state_of(statusword_) == DriveState::operation_enabled;
}

// --- frames to the bus ---

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
    if (now - std::max(since_, pdo_at_.value_or(since_)) > heartbeat_timeout(settings_))
      return lost(now, fmt::format("no statusword for {} ms", patience_ms));
  } else if (phase_ == Phase::failed && refused_ && now - since_ > kTryRefusedAgain) {
    lost(now, why_);
  }
}

void Axis::step(Time now, bool stand_still, bool asked, bool together, Frames& out) {
  asked_ = asked;
  stands_still_ = stand_still;
  watch(now);
  switch (phase_) {
    case Phase::absent:
      if (sdo_.idle()) sdo_.start({kDeviceType, {}});
      [[fallthrough]];
    case Phase::checking:
      if (set_up_once_) send_pdos(safe_word(now, kQuickStop), out);  // it may hear us although we do not hear it
      break;
    case Phase::setting_up:
      next_setup_step(now, out);
      break;
    case Phase::starting:
      if (now - nmt_sent_ >= kStartAgain) {
        nmt_sent_ = now;
        out.push_back(canopen::nmt_frame(NmtCommand::start, settings_.node));
      }
      send_pdos(safe_word(now, kQuickStop), out);
      break;
    case Phase::running:
      if (status_at_ || reports_.doubted()) send_pdos(safe_word(now, control(now, stand_still, asked, together)), out);
      break;
    case Phase::failed:
      if (set_up_once_) send_pdos(safe_word(now, kQuickStop), out);
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
  if (order && handshake_.limits_due() && !limits_by_sdo_) {
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

std::uint16_t Axis::control(Time now, bool stand_still, bool asked, bool together) {
  const DriveState state = state_of(statusword_);
  const bool enabled = state == DriveState::operation_enabled;
  const bool doubted = reports_.doubted();
  if (!enabled || stand_still || doubted) {
    handshake_.forget();
    homing_since_.reset();
    ready_since_.reset();
  }
  if (doubted) {
    settle_doubt(now);
    return kQuickStop;
  }
  if (state == DriveState::fault) return reset_fault(now);
  reset_at_.reset();
  if (stand_still) return kQuickStop;
  if (!enabled) return towards_operation(state, settings_.hold_on_stop);
  if (!referenced_) {
    if (settings_.home == HomeRule::when_needed && !asked) return kEnableOperation;
    return go_home(now);
  }
  if (!in_mode(kProfilePosition)) return kEnableOperation;
  if (!ready_since_) ready_since_ = now;
  if (now - *ready_since_ > kForgiveAfter) failures_ = 0;
  const std::uint16_t word = handshake_.step(now, statusword_, fresh_, together);
  tell_limits(now);
  read_target_back();
  return word;
}

bool Axis::has_stopped(Time now) const { return told_to_stop_ && now - *told_to_stop_ >= stops_within(settings_); }

std::uint16_t Axis::safe_word(Time now, std::uint16_t word) {
  if ((word & kEnableOperation) == kEnableOperation) {
    told_to_stop_.reset();
    return word;
  }
  if (!told_to_stop_) told_to_stop_ = now;
  return has_stopped(now) ? word : kQuickStop;
}

void Axis::settle_doubt(Time now) {
  if (!doubt_counted_) {
    doubt_counted_ = true;
    count_failure(now, "says what cannot be: " + reports_.why());
    return;
  }
  if (!reports_.settled() || !has_stopped(now) || rereading_ || !sdo_.idle()) return;
  rereading_ = kActualPosition;
  sdo_.start({kActualPosition, {}});
}

void Axis::read_target_back() {
  const auto& order = handshake_.current();
  if (!order || !handshake_.idle() || target_told_ == order->position || rereading_ || !sdo_.idle()) return;
  target_told_ = order->position;
  rereading_ = kTargetPosition;
  sdo_.start({kTargetPosition, {}});
}

bool Axis::in_mode(int mode) {
  if (mode_ == mode) return true;
  if (sdo_.idle()) sdo_.start({{0x6060, 0}, {static_cast<std::uint8_t>(mode)}});
  return false;
}

std::uint16_t Axis::go_home(Time now) {
  if (!in_mode(kHoming)) return kEnableOperation;
  if (!homing_since_) {  // one cycle with bit 4 low, so that the drive sees it rise
    homing_since_ = now;
    homing_answers_ = ended_answers_ = 0;
    return kEnableOperation;
  }
  if (now - *homing_since_ > settings_.homing_timeout) {
    failed(now, fmt::format("did not find its home position in {:.0f} s: a switch or the motor does not work",
                            to_seconds(settings_.homing_timeout)));
    return kQuickStop;
  }
  if (fresh_ && ++homing_answers_ > kHomingAnswers) {
    const bool error = (statusword_ & kHomingError) != 0;
    const bool attained = (statusword_ & kHomingAttained) != 0 && (statusword_ & kTargetReached) != 0;
    const int ended = error ? -1 : attained ? 1 : 0;
    ended_answers_ = ended * ended_answers_ > 0 ? ended_answers_ + ended : ended;
    if (std::abs(ended_answers_) >= kEndedAnswers) {
      homing_since_.reset();
      if (error) {
        count_failure(now, "homing failed");
      } else if (std::abs(static_cast<double>(position_)) > kHomeSlack_s * settings_.speed + 2) {
        count_failure(now, fmt::format("has ended homing at {} counts, where home is 0", position_));
      } else {
        referenced_ = true;
      }
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
  return now >= *reset_at_ ? kFaultReset : kQuickStop;
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
  if (reports_.doubted()) return fmt::format("{} is stopped, as it says what cannot be: {}", who, reports_.why());
  const DriveState state = state_of(statusword_);
  if (state == DriveState::fault || state == DriveState::fault_reaction_active)
    return fmt::format("{} has a fault: {}", who, canopen::error_text(error_code_));
  if (stands_still_) return who + " stands still because the other axis of its head is out of service";
  if (state != DriveState::operation_enabled) return fmt::format("{} is {}", who, name_of(state));
  if (referenced_) return mode_ == kProfilePosition ? "" : who + " changes its mode";
  if (settings_.home == HomeRule::when_needed && !asked_) return "";
  // No growing figure in the text, as each new text is an alarm of its own.
  return who + (homing_since_ ? " is on its way to its home position" : " does not know its position");
}

}  // namespace luxrig::cia402
