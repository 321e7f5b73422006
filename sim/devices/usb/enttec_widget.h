#pragma once
/// The processor of an ENTTEC DMX USB Pro, behind its FTDI chip.
/// Source: ENTTEC, DMX USB Pro Widget API Specification 1.44.
///
/// It repeats the last packet by itself until it gets a request other than 6 and 3. Slots that a short packet leaves
/// out keep their value in the fixtures. Possible faults: deaf, silent, no names (labels 77 and 78) like the original,
/// wrong end byte, noise before each answer.

#include <deque>

#include "sim/devices/usb/ftdi_chip.h"

namespace luxrig::sim {

class EnttecWidget final : public SerialPeer {
 public:
  struct Character {
    bool says_names = true;             ///< labels 77 and 78
    bool wrong_end = false;             ///< of every answer
    bool silent = false;                ///< obeys, but does not answer
    std::vector<std::uint8_t> noise{};  ///< before every answer
  };
  EnttecWidget() = default;
  explicit EnttecWidget(Character character) : character_(std::move(character)) {}
  void set_character(Character character) { character_ = std::move(character); }
  /// From now on it has the firmware with RDM: labels 7 and 11, answered by 5 or, after silence, 12.
  void connect(UsbDevice::LineAnswer answer) { line_answer_ = std::move(answer); }

  void power_on(Time now) override;
  void receive(Time start, Duration slot, const LineSettings& settings, std::span<const std::uint8_t> bytes) override;
  std::vector<std::uint8_t> take(Time now, std::size_t most) override;
  [[nodiscard]] std::optional<UsbDmxLook> line(Time) override { return putting_out_ ? look_ : std::nullopt; }

  // For tests.
  [[nodiscard]] std::uint64_t frames() const { return frames_; }    ///< label 6
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }  ///< bytes that belonged to no message
  [[nodiscard]] std::uint64_t stops() const { return stops_; }      ///< requests that stopped the running output
  [[nodiscard]] int break_units() const { return break_units_; }
  [[nodiscard]] int mark_units() const { return mark_units_; }
  [[nodiscard]] int rate_hz() const { return rate_hz_; }

 private:
  void obey(Time now, std::uint8_t label, std::span<const std::uint8_t> data);
  void ask_line(Time now, std::span<const std::uint8_t> packet);
  void answer(std::uint8_t label, std::span<const std::uint8_t> data);

  Character character_;
  UsbDevice::LineAnswer line_answer_;
  std::vector<std::uint8_t> heard_;
  std::deque<std::uint8_t> said_;
  std::optional<UsbDmxLook> look_;
  bool putting_out_ = false;
  int break_units_ = 9, mark_units_ = 1, rate_hz_ = 40;  // kept without power
  std::uint64_t frames_ = 0, dropped_ = 0, stops_ = 0;
};

}  // namespace luxrig::sim
