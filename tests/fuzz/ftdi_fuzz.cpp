/// The contents of an FTDI chip's bulk transfer, and a string descriptor: never more than came in, and nothing is read
/// past its end. First byte: the packet size.
#include <cstdlib>

#include "drivers/dmx/usb/ftdi.h"
#include "drivers/usb/usb_strings.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t packet = 3 + data[0];
  const std::vector<std::uint8_t> transfer(data + 1, data + size);
  const auto bytes = luxrig::ftdi::received_bytes(transfer, packet);
  const std::size_t packets = (transfer.size() + packet - 1) / packet;
  if (bytes.size() > transfer.size() || bytes.size() + 2 * packets < transfer.size()) std::abort();
  (void)luxrig::ftdi::transmitter_is_empty(transfer);
  if (luxrig::text_of_string_descriptor(transfer).size() > 3 * 127) std::abort();
  return 0;
}
