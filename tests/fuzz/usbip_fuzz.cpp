/// Answers of a USB/IP server, decoded by the driver's side.
#include <algorithm>
#include <array>
#include <cstdlib>

#include "drivers/usb/usbip_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig::usbip;
  (void)imported({data, size});
  std::array<std::uint8_t, kHeaderBytes> header{};
  std::copy_n(data, std::min(size, header.size()), header.begin());
  if (const auto answer = decode_answer(header)) {
    if (answer->length > kMaxBytes) std::abort();
    (void)status_of(answer->status);
  }
  return 0;
}
