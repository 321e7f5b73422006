#pragma once
/// One drive on the bus: found, set up, enabled, homed, moved, and taken back into service after a loss. Pure: `now`
/// and frames in, frames out. One step() each cycle; the SYNC follows it.
///
///   absent -> setting_up -> starting -> running
///   running -> absent (no heartbeat) -> checking -> running or setting_up
///   any -> failed (refused, or faulted too often): stands still until the node boots again
///
/// Only homing (as the rule says) and ordered set-points move the axis. No controlword takes the torque off an axis
/// that may be turning, whatever its statusword says: it would run on by its momentum.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/canopen/emergency.h"
#include "drivers/can/canopen/nmt.h"
#include "drivers/can/canopen/sdo_client.h"
#include "drivers/can/cia402/axis_settings.h"
#include "drivers/can/cia402/drive_state.h"
#include "drivers/can/cia402/report_check.h"
#include "drivers/can/cia402/set_point.h"

namespace luxrig::cia402 {

using Frames = std::vector<can::CanFrame>;

class Axis {
 public:
  explicit Axis(const AxisSettings& settings);

  /// Forgets all state of the drive.
  void activate(Time now);
  /// A data frame; those of other nodes are ignored.
  void receive(Time now, const can::CanFrame& frame);
  /// stand_still  the head's other axis is not sound, so this one stops
  /// asked        the head has a target
  /// together     a set-point may be offered, as the other axis can begin with it
  void step(Time now, bool stand_still, bool asked, bool together, Frames& out);
  /// Frames that stop it before step() is no longer called.
  void stop(Frames& out) const;

  [[nodiscard]] const AxisSettings& settings() const { return settings_; }
  /// It answers, and its drive has no fault.
  [[nodiscard]] bool sound() const;
  /// It accepts orders: enabled, and its position is known.
  [[nodiscard]] bool ready() const;
  /// requires ready().
  void order(const SetPoint& set_point) { handshake_.order(set_point); }
  [[nodiscard]] bool order_taken() const { return handshake_.idle(); }
  /// True if the drive has the order's speed and acceleration, or gets them with it. False while they are still being
  /// written by SDO.
  [[nodiscard]] bool limits_told() const;
  [[nodiscard]] std::int32_t position() const { return position_; }
  [[nodiscard]] std::int32_t velocity() const { return velocity_; }  ///< counts/s
  /// Why it does not follow its orders; empty if it does.
  [[nodiscard]] std::string trouble() const;
  /// Worth knowing although it is in order; may be empty.
  [[nodiscard]] std::string remark() const;

 private:
  enum class Phase { absent, checking, setting_up, starting, running, failed };

  void enter(Time now, Phase phase);
  void lost(Time now, std::string why);
  void failed(Time now, std::string why);
  void begin_setup(Time now);
  void heartbeat_heard(Time now, canopen::NmtState state);
  void take_sdo_result(Time now);
  void take_setup_result(Time now, const canopen::SdoResult& result);
  void next_setup_step(Time now, Frames& out);
  void take_reread(Time now, const canopen::SdoResult& result);
  void watch(Time now);
  [[nodiscard]] std::uint16_t control(Time now, bool stand_still, bool asked, bool together);
  bool limits_go_by_sdo(const canopen::SdoRequest& refused, std::uint32_t abort_code);
  [[nodiscard]] std::optional<canopen::SdoRequest> limit_to_tell() const;
  void tell_limits(Time now);
  void take_told(Time now, const canopen::SdoResult& result);
  [[nodiscard]] std::uint16_t reset_fault(Time now);
  void settle_doubt(Time now);
  void read_target_back();
  [[nodiscard]] bool has_stopped(Time now) const;
  [[nodiscard]] std::uint16_t safe_word(Time now, std::uint16_t word);
  [[nodiscard]] std::uint16_t go_home(Time now);
  [[nodiscard]] bool in_mode(int mode);
  void count_failure(Time now, const std::string& why);
  void send_pdos(std::uint16_t controlword, Frames& out) const;

  AxisSettings settings_;
  std::vector<SetupStep> steps_;
  canopen::SdoClient sdo_;
  canopen::HeartbeatConsumer heartbeat_;
  SetPointHandshake handshake_;
  ReportCheck reports_;

  Phase phase_ = Phase::absent;
  Time since_{};
  std::string why_;         ///< why it is absent or has failed
  std::string drive_name_;  ///< object 1008, if it has one
  std::size_t step_ = 0;
  bool set_up_once_ = false;  ///< since activate()
  bool refused_ = false;      ///< its set-up failed and is tried again
  bool nmt_due_ = false;
  Time nmt_sent_{};
  bool referenced_ = false;
  bool asked_ = false, stands_still_ = false;

  std::optional<Time> status_at_;  ///< time of the newest believed statusword
  std::optional<Time> pdo_at_;     ///< of any TPDO 1, believed or not
  bool fresh_ = false;
  std::uint16_t statusword_ = 0, error_code_ = 0;
  std::int32_t position_ = 0, velocity_ = 0;
  int mode_ = 0;

  std::optional<Time> homing_since_;
  int homing_answers_ = 0, ended_answers_ = 0;  ///< ended_answers_ < 0: ended with an error
  std::optional<std::uint32_t> other_entry_;    ///< read in place of consumer_entry()
  bool doubt_counted_ = false;
  std::optional<Time> told_to_stop_;  ///< nothing that moves it was sent since
  std::optional<canopen::ObjectAddress> rereading_;
  std::optional<std::int32_t> target_told_;      ///< target sent, whose read-back was started
  bool limits_by_sdo_ = false;                   ///< none of its PDOs carries speed and acceleration
  std::map<std::uint16_t, std::uint32_t> told_;  ///< values it has accepted, by object index
  std::optional<canopen::SdoRequest> telling_;
  Time tell_again_at_{};
  std::optional<Time> reset_at_;
  int failures_ = 0;  ///< in a row
  std::optional<Time> ready_since_;
};

}  // namespace luxrig::cia402
