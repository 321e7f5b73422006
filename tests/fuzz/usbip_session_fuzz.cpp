/// The simulated USB widgets behind their USB/IP server: whatever a client sends, the session ends or stays within its
/// bounds, and sends only whole answers. First byte: which widget, and the size of the pieces.
#include <algorithm>
#include <cstdlib>

#include "sim/devices/usb/usb_widgets.h"
#include "sim/wire/usb/usbip_session.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  using namespace luxrig::sim;
  if (size == 0) return 0;
  constexpr const char* kWidgets[] = {"enttec_pro", "open_dmx", "udmx"};
  const auto device = make_usb_widget(kWidgets[data[0] % 3]);
  device->power_on(Time{});
  UsbipSession session(*device,
                       (data[0] & 0x80) != 0 ? UsbipSession::Beginning::handshake : UsbipSession::Beginning::attached);
  const std::size_t piece = 1 + (data[0] >> 2 & 0x1f) * 16;
  const std::span<const std::uint8_t> stream(data + 1, size - 1);
  Time now{};
  std::vector<std::uint8_t> said;
  for (std::size_t at = 0; at < stream.size() && !session.is_broken(); at += piece) {
    session.receive(now, stream.subspan(at, std::min(piece, stream.size() - at)));
    now += std::chrono::milliseconds(7);
    session.serve(now);
    const auto more = session.take_output();
    said.insert(said.end(), more.begin(), more.end());
    (void)device->line(now);
  }
  now += std::chrono::hours(1);
  session.serve(now);
  (void)device->line(now);
  if ((data[0] & 0x80) == 0 && !said.empty() && (said.size() < 48 || said[3] < 3 || said[3] > 4)) std::abort();
  return 0;
}
