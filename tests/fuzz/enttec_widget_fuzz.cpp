/// The simulated ENTTEC widget: it sends only whole messages, and its line shows nothing before a packet.
#include <algorithm>
#include <cstdlib>

#include "sim/devices/usb/enttec_widget.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  using namespace luxrig::sim;
  EnttecWidget widget;
  widget.power_on(Time{});
  widget.connect([](Time, std::span<const std::uint8_t> packet) {
    return packet.size() % 2 ? std::vector<std::uint8_t>(packet.begin(), packet.end()) : std::vector<std::uint8_t>{};
  });
  std::vector<std::uint8_t> said;
  for (std::size_t at = 0; at < size; at += 61) {
    const std::vector<std::uint8_t> piece(data + at, data + std::min(size, at + 61));
    widget.receive(Time{}, {}, {}, piece);
    if (widget.line(Time{}) && widget.frames() == 0) std::abort();
    const auto more = widget.take(Time{}, 100000);
    said.insert(said.end(), more.begin(), more.end());
  }
  for (std::size_t at = 0; at < said.size();) {
    if (said.size() - at < 5 || said[at] != 0x7e) std::abort();
    const std::size_t length = said[at + 2] + 256u * said[at + 3];
    if (at + 5 + length > said.size() || said[at + 4 + length] != 0xe7) std::abort();
    at += 5 + length;
  }
  return 0;
}
