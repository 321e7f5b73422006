#pragma once
/// A serial line with Modbus RTU. libmodbus only opens and configures the port; frames are sent and found here. Its own
/// receiver gives up if line noise precedes an answer, and takes a late answer for the next one.

#include <string>

#include "drivers/modbus/modbus_link.h"

struct _modbus;

namespace luxrig::modbus {

enum class Parity { none, even, odd };

struct SerialSettings {
  std::string device;  ///< "/dev/ttyUSB0"; better a persistent name from /dev/serial/by-id
  int baud = 19200;
  Parity parity = Parity::even;
  int stop_bits = 1;   ///< 1 or 2
  bool rs485 = false;  ///< ask the kernel to switch the transceiver; ports that cannot do so work without
};

class RtuLink final : public Link {
 public:
  explicit RtuLink(SerialSettings settings);
  ~RtuLink() override { shut(); }

  [[nodiscard]] bool connected() const override { return context_ != nullptr; }
  Result<void> connect(std::chrono::milliseconds timeout) override;
  void close() override { shut(); }
  /// Waits for a silence of 3.5 characters, sends, and searches the received bytes for an answer with a right checksum.
  Result<std::vector<std::uint16_t>> exchange(const Request& request, std::chrono::milliseconds timeout) override;
  /// True after the adapter was pulled out.
  bool found_closed() override;
  [[nodiscard]] std::chrono::milliseconds longest_on_wire() const override;
  [[nodiscard]] bool answers_are_numbered() const override { return false; }

 private:
  void shut();
  [[nodiscard]] std::chrono::milliseconds on_wire(std::size_t bytes) const;
  [[nodiscard]] Fault lost(const std::string& doing, int error);
  [[nodiscard]] Fault absent(int error) const;
  /// Checks the port's settings: libmodbus does not notice a port that ignores them.
  [[nodiscard]] bool settings_taken() const;
  /// Discards unexpected bytes until the line is silent.
  Result<void> wait_for_silence();
  /// Appends the bytes received; true if there were any.
  Result<bool> take(std::vector<std::uint8_t>& into);
  /// True if bytes can be read.
  bool wait_readable(std::chrono::milliseconds timeout) const;

  SerialSettings settings_;
  std::chrono::milliseconds silence_{};  ///< that ends a frame
  ::_modbus* context_ = nullptr;
  int fd_ = -1;
};

}  // namespace luxrig::modbus
