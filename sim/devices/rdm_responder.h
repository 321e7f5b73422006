#pragma once
/// The RDM side of a DMX fixture: discovery, parameters, sensors. Pure: bytes from the line and the time in, bytes for
/// the line out. Source: ANSI E1.20-2010.
///
/// - Takes part in discovery until it is muted; answers no broadcast.
/// - Slow: LAMP_HOURS, which its ballast must supply: ACK_TIMER, then QUEUED_MESSAGE.
/// - Long: SLOT_INFO of more than 46 slots comes in parts (ACK_OVERFLOW); a request for anything but the next part ends
///   it.
/// - The start address can move within the universe as far as the footprint fits; the label lasts as long as the
///   process.
/// - One sensor: the temperature of its housing, which follows its light within minutes.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.h"
#include "sim/devices/rdm_frame.h"

namespace luxrig::sim {

struct RdmSlot {
  std::uint8_t type = 0;    ///< 0 primary, 1 fine
  std::uint16_t label = 1;  ///< primary: 0x0001 intensity …; fine: offset of its coarse slot
};

struct RdmIdentity {
  std::uint64_t uid = 0;  ///< 48 bits
  std::string manufacturer, model, label;
  int model_id = 1;
  int category = 0x0101;
  int address = 1;             ///< 1…512
  std::vector<RdmSlot> slots;  ///< its footprint
  std::uint32_t lamp_hours = 0;
  bool write_protected = false;  ///< locked at its panel: NACK to every SET but IDENTIFY_DEVICE
};

class RdmResponder {
 public:
  explicit RdmResponder(RdmIdentity identity);

  /// A packet from the line, from its start code on. Returns its answer; empty = none.
  std::vector<std::uint8_t> receive(Time now, std::span<const std::uint8_t> bytes);
  /// Output of its lamp, 0…1, from the last call until now.
  void shine(Time now, double level);

  [[nodiscard]] std::uint64_t uid() const { return identity_.uid; }
  [[nodiscard]] int address() const { return identity_.address; }  ///< present start address
  [[nodiscard]] bool identifies() const { return identifies_; }
  [[nodiscard]] bool muted() const { return muted_; }
  [[nodiscard]] const std::string& label() const { return identity_.label; }
  /// Power returns: the mute state and the queue are lost.
  void power_up();

 private:
  using Bytes = std::vector<std::uint8_t>;
  /// Its answer to a request, before it is cut into parts.
  struct Reply {
    int type = 0;
    Bytes data;
  };

  std::vector<std::uint8_t> discover(const RdmFrame& request);
  Reply get(const RdmFrame& request);
  Reply set(const RdmFrame& request);
  Reply personality_description(int number) const;
  Reply sensor(const RdmFrame& request) const;
  Bytes device_info() const;
  Bytes slot_info() const;
  Bytes hours(double since_start_h, std::uint32_t before) const;
  std::optional<RdmFrame> queued(Time now, const RdmFrame& request);
  [[nodiscard]] int footprint() const { return static_cast<int>(identity_.slots.size()); }

  RdmIdentity identity_;
  bool muted_ = false, identifies_ = false;
  double level_ = 0;
  std::optional<Time> shone_;
  double on_h_ = 0, lit_h_ = 0;  ///< since the start
  double temperature_c_, lowest_c_, highest_c_;
  struct Waiting {
    Time ready;
    RdmFrame answer;
  };
  std::vector<Waiting> queue_;
  std::optional<RdmFrame> last_queued_;
  std::optional<int> overflow_pid_;  ///< parts of this parameter are being sent …
  Bytes overflow_;                   ///< … and these are left
};

}  // namespace luxrig::sim
