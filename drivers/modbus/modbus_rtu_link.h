#pragma once
/// A serial line with Modbus RTU on it. libmodbus opens and sets the port up; frames are sent and found here, since its
/// receiver gives up where line noise comes before an answer, and takes a late answer for the next one.

#include <string>

#include "drivers/modbus/modbus_link.h"

struct _modbus;

namespace luxrig::modbus {

enum class Parity { none, even, odd };

struct SerialSettings {
  std::string device;  ///< "/dev/ttyUSB0", or better a name from /dev/serial/by-id, which stays
  int baud = 19200;
  Parity parity = Parity::even;
  int stop_bits = 1;   ///< 1 or 2
  bool rs485 = false;  ///< ask the kernel to switch the transceiver; ports that cannot do so go on without
};

class RtuLink final : public Link {
 public:
  explicit RtuLink(SerialSettings settings);
  ~RtuLink() override { shut(); }

  [[nodiscard]] bool connected() const override { return context_ != nullptr; }
  Result<void> connect(std::chrono::milliseconds timeout) override;
  void close() override { shut(); }
  /// Waits for a silence of 3.5 characters, sends, and looks for an answer with the right checksum among what comes.
  Result<std::vector<std::uint16_t>> exchange(const Request& request, std::chrono::milliseconds timeout) override;
  /// The adapter was pulled out.
  bool found_closed() override;
  [[nodiscard]] std::chrono::milliseconds longest_on_wire() const override;
  [[nodiscard]] bool answers_are_numbered() const override { return false; }

 private:
  void shut();
  [[nodiscard]] std::chrono::milliseconds on_wire(std::size_t bytes) const;
  [[nodiscard]] Fault lost(const std::string& doing, int error);
  [[nodiscard]] Fault absent(int error) const;
  /// libmodbus does not notice a port that ignores them.
  [[nodiscard]] bool settings_taken() const;
  /// Throws away what nobody waits for, until the line is silent.
  Result<void> wait_for_silence();
  /// What has come, appended; true when there was something.
  Result<bool> take(std::vector<std::uint8_t>& into);
  /// True when something may be read.
  bool wait_readable(std::chrono::milliseconds timeout) const;

  SerialSettings settings_;
  std::chrono::milliseconds silence_{};  ///< that ends a frame
  ::_modbus* context_ = nullptr;
  int fd_ = -1;
};

}  // namespace luxrig::modbus
