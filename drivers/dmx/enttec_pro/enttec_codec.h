#pragma once
/// Messages of the ENTTEC DMX USB Pro and compatible widgets. Pure.
/// Source: ENTTEC, DMX USB Pro Widget API Specification 1.44: 0x7E, label, length LSB, length MSB, data, 0xE7.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/dmx/dmx_patch.h"

namespace luxrig::enttec {

inline constexpr std::size_t kMaxData = 600;

/// The labels that Luxrig sends or understands; a widget has more.
enum class Label : std::uint8_t {
  get_parameters = 3,
  set_parameters = 4,
  received_dmx = 5,
  output_dmx = 6,
  send_rdm = 7,
  serial_number = 10,
  send_rdm_discovery = 11,
  rdm_timeout = 12,
  manufacturer = 77,  ///< community extension, as is device_name; original widgets do not answer
  device_name = 78,
};

struct Message {
  std::uint8_t label = 0;
  std::vector<std::uint8_t> data;
  friend bool operator==(const Message&, const Message&) = default;
};

/// requires at most kMaxData bytes.
[[nodiscard]] std::vector<std::uint8_t> encode(Label label, std::span<const std::uint8_t> data);
[[nodiscard]] std::vector<std::uint8_t> encode_output(const DmxSlots& slots);

/// Splits a stream into messages. Data may contain 0x7E and 0xE7, so it relies on the length. If that leads to a wrong
/// end byte, it drops the start byte and searches for the next.
class StreamDecoder {
 public:
  void add(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  /// The next whole message, if any. After each add(), call it until it is empty.
  [[nodiscard]] std::optional<Message> next();
  /// Drops a message whose rest does not arrive, and searches for the next start.
  void give_up();
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }  ///< bytes that belonged to no message
  void clear() { bytes_.clear(); }

 private:
  std::vector<std::uint8_t> bytes_;
  std::uint64_t dropped_ = 0;
};

/// break and mark after break in units of 10.67 µs (32/3 µs).
struct Parameters {
  int firmware = 0;  ///< high byte, low byte: 0x0144 = 1.68
  int break_units = 9, mark_units = 1;
  int rate_hz = 40;  ///< 0…40; 0 = as fast as possible
};
[[nodiscard]] int units_of_us(int us);

/// Empty if it is truncated or a value is outside its range.
[[nodiscard]] std::optional<Parameters> decode_parameters(std::span<const std::uint8_t> data);
[[nodiscard]] std::vector<std::uint8_t> encode_set_parameters(const Parameters& parameters);
/// 4 bytes BCD, least significant first: 12 34 56 02 -> "02563412".
[[nodiscard]] std::optional<std::string> decode_serial(std::span<const std::uint8_t> data);
/// Labels 77 and 78: an id, then text; control characters become '?'.
[[nodiscard]] std::optional<std::string> decode_name(std::span<const std::uint8_t> data);

}  // namespace luxrig::enttec
