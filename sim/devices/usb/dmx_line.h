#pragma once
/// A DMX receiver at the end of a serial line: break, mark after break, start code, slots.
/// Source: ANSI E1.11 section 8: break at least 88 µs, mark after break at least 8 µs, 250 kbit/s, 8 data bits, 2 stop
/// bits; a packet that a break cuts short ends there; data is lost after 1 s without a packet.

#include "sim/devices/usb/ftdi_chip.h"

namespace luxrig::sim {

class DmxLine final : public SerialPeer {
 public:
  void power_on(Time now) override;
  void receive(Time start, Duration slot, const LineSettings& settings, std::span<const std::uint8_t> bytes) override;
  void set_break(Time at, bool asserted) override;
  [[nodiscard]] std::optional<UsbDmxLook> line(Time now) override;

  [[nodiscard]] std::uint64_t packets() const { return packets_; }   ///< whole ones, start code 0
  [[nodiscard]] std::uint64_t short_ones() const { return short_; }  ///< cut short by a break
  [[nodiscard]] std::uint64_t spoiled() const {
    return spoiled_;
  }  ///< bytes at the wrong rate, in a break, or without one
  [[nodiscard]] Duration shortest_break() const { return shortest_break_; }
  [[nodiscard]] Duration shortest_mark() const { return shortest_mark_; }

 private:
  enum class State { idle, in_break, after_break, in_packet };
  State state_ = State::idle;
  Time break_at_{}, break_end_{}, packet_end_{};
  std::optional<Time> last_packet_;
  std::optional<UsbDmxLook> look_;
  std::uint64_t packets_ = 0, short_ = 0, spoiled_ = 0;
  Duration shortest_break_ = Duration::max(), shortest_mark_ = Duration::max();
};

}  // namespace luxrig::sim
