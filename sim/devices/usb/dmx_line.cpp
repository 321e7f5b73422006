#include "sim/devices/usb/dmx_line.h"

#include <algorithm>

namespace luxrig::sim {
namespace {

constexpr Duration kMinBreak = std::chrono::microseconds(88), kMinMark = std::chrono::microseconds(8);
constexpr Duration kDataLost = std::chrono::seconds(1);
constexpr std::uint16_t kEightNTwo = 0x1008, kFormatBits = 0x1fff;
constexpr std::uint16_t kDivisor250k = 12;

}  // namespace

void DmxLine::power_on(Time) {
  state_ = State::idle;
  look_.reset();
  last_packet_.reset();
}

void DmxLine::set_break(Time at, bool asserted) {
  if (asserted) {
    if (state_ == State::in_packet && at < packet_end_) {
      ++short_;
      look_.reset();  // it is unknown which slots of it arrived
    }
    state_ = State::in_break;
    break_at_ = at;
    return;
  }
  if (state_ != State::in_break) return;
  shortest_break_ = std::min(shortest_break_, at - break_at_);
  break_end_ = at;
  state_ = at - break_at_ >= kMinBreak ? State::after_break : State::idle;
}

void DmxLine::receive(Time start, Duration slot, const LineSettings& settings, std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return;
  const bool is_dmx =
      (settings.format & kFormatBits) == kEightNTwo && settings.divisor == kDivisor250k && settings.rts_low;
  if (!is_dmx || state_ != State::after_break || start - break_end_ < kMinMark || bytes.size() > 1 + kDmxSlots) {
    spoiled_ += bytes.size();
    if (state_ == State::after_break) state_ = State::idle;
    return;
  }
  shortest_mark_ = std::min(shortest_mark_, start - break_end_);
  state_ = State::in_packet;
  packet_end_ = start + slot * static_cast<std::int64_t>(bytes.size());
  if (bytes[0] != 0) return;  // a dimmer ignores other start codes
  UsbDmxLook look = look_.value_or(UsbDmxLook{});
  std::copy(bytes.begin() + 1, bytes.end(), look.begin());
  look_ = look;
  last_packet_ = start;
  if (bytes.size() == 1 + kDmxSlots) ++packets_;
}

std::optional<UsbDmxLook> DmxLine::line(Time now) {
  if (!last_packet_ || now - *last_packet_ > kDataLost) return std::nullopt;
  return look_;
}

}  // namespace luxrig::sim
