#pragma once
/// A CAN bus of simulated axes without a socket, under a stepped clock.

#include <cstdint>
#include <deque>
#include <optional>

#include "drivers/can/can_channel.h"
#include "drivers/can/can_datagrams.h"
#include "sim/wire/can/axis_bus.h"

namespace luxrig {

/// The bus as the driver sees it: frames go straight to the simulated axes.
class AxesWire final : public can::CanChannel {
 public:
  /// `down`: the interface is absent at present.
  AxesWire(sim::AxisBus& axes, const Time& now, const bool& down) : axes_(axes), now_(now), down_(down) {}
  Result<void> open() override {
    if (down_) return tl::unexpected(gone());
    open_ = true;
    return {};
  }
  void close() override { open_ = false; }
  [[nodiscard]] bool is_open() const override { return open_; }
  Result<can::Sent> send(const can::CanFrame& frame) override {
    if (down_) {
      open_ = false;
      return tl::unexpected(gone());
    }
    ++frames;
    axes_.receive(now_, sim::bus_frame(frame.id, frame.payload()));
    return can::Sent::yes;
  }
  std::optional<can::CanFrame> receive() override {
    for (const sim::BusFrame& frame : axes_.take_sent()) arrived_.push_back(frame);
    if (!open_ || down_) arrived_.clear();
    if (arrived_.empty()) return std::nullopt;
    ++frames;
    const auto frame = can::from_bytes(sim::packed(arrived_.front()));
    arrived_.pop_front();
    return frame;
  }
  std::optional<Fault> take_error() override { return std::nullopt; }

  std::uint64_t frames = 0;  ///< both directions

 private:
  static Fault gone() { return {Cause::network, {}, "no such interface", {}}; }
  sim::AxisBus& axes_;
  const Time& now_;
  const bool& down_;
  bool open_ = false;
  std::deque<sim::BusFrame> arrived_;
};

}  // namespace luxrig
