#pragma once
/// One axis as a CANopen node: NMT slave, heartbeat both ways, emergency messages, SDO server, PDOs mapped by SDO,
/// SYNC, around an AxisDrive. Written from CiA 301 and CiA 402-2 without reference to the driver. Pure: time and frames
/// in, frames out, so it can be fuzzed.

#include <memory>
#include <optional>
#include <vector>

#include "core/time.h"
#include "sim/devices/axis_drive.h"
#include "sim/wire/can/bus_frame.h"
#include "sim/wire/can/object_dictionary.h"

namespace luxrig::sim {

class AxisNode {
 public:
  /// Starts switched off. following_window: object 6065 as set by its maker, in counts.
  AxisNode(int node, const AxisTruth& truth, double angle_deg, std::uint32_t following_window);
  AxisNode(const AxisNode&) = delete;
  AxisNode& operator=(const AxisNode&) = delete;

  void set_power(Time now, bool on);
  /// As NMT "reset node" or its watchdog: the electronics restart, the motor runs on by its momentum.
  void reset(Time now);
  /// From now on, and after each boot: ObjectDictionary::refuse_limits_in_pdos().
  void refuse_limits_in_pdos(std::optional<std::uint32_t> abort_code);
  void receive(Time now, const BusFrame& frame);
  /// One millisecond that ends at `now`. stuck: the axis is blocked.
  void step(Time now, bool stuck);
  /// Frames sent since the last call.
  [[nodiscard]] std::vector<BusFrame> take_sent();

  [[nodiscard]] int node() const { return node_; }
  [[nodiscard]] const AxisDrive& drive() const { return drive_; }

 private:
  enum class Nmt : std::uint8_t { stopped = 4, operational = 5, pre_operational = 0x7F };

  void send(std::uint32_t id, std::initializer_list<std::uint8_t> payload);
  void boot(Time now);
  void take_nmt(Time now, const BusFrame& frame);
  void take_sdo(const BusFrame& frame);
  void upload(const BusFrame& frame, const ObjectKey& key);
  void upload_segment(const BusFrame& frame);
  void download(const BusFrame& frame, const ObjectKey& key);
  void abort_sdo(const ObjectKey& key, std::uint32_t code);
  void take_sync();
  void apply_pdo(int number, const BusFrame& frame);
  void send_pdo(int number);
  void applied(const ObjectKey& key);
  [[nodiscard]] std::uint32_t measured(const ObjectKey& key) const;
  void emergency(std::uint16_t code);

  int node_;
  std::uint32_t following_window_;
  std::optional<std::uint32_t> limits_refused_;
  AxisDrive drive_;
  std::unique_ptr<ObjectDictionary> objects_;
  bool powered_ = false;
  Nmt nmt_ = Nmt::pre_operational;
  Time now_{}, heartbeat_due_{};
  std::optional<Time> master_heard_;  ///< while its heartbeat is watched
  std::uint16_t told_error_ = 0, communication_error_ = 0;
  std::optional<BusFrame> waiting_[4];  ///< PDOs to the node that take effect with the next SYNC
  int syncs_[4] = {};
  std::optional<std::size_t> text_at_;  ///< in object 1008, while it is read
  bool toggle_ = false;
  std::vector<BusFrame> sent_;
};

}  // namespace luxrig::sim
