/// Plugs the simulated uDMX into this kernel: vhci_hcd gets one end of a socket pair, the model answers at the other.
///   udmx_on_vhci PORT                     stays until it is killed, which unplugs the device
/// Writes to stdout: "plugged", then "slot 1: N" on each change.

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "sim/devices/usb/udmx_widget.h"
#include "sim/wire/usb/usbip_session.h"

int main(int argc, char** argv) {
  using namespace luxrig;
  using namespace luxrig::sim;
  setvbuf(stdout, nullptr, _IOLBF, 0);
  const int port = argc > 1 ? std::atoi(argv[1]) : 0;
  int pair[2];
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0) return perror("socketpair"), 1;
  const int attach = open("/sys/devices/platform/vhci_hcd.0/attach", O_WRONLY);
  // Port, socket, device number, low speed.
  if (attach < 0 || dprintf(attach, "%d %d %d 1", port, pair[1], 65538) < 0) return perror("attach"), 1;
  close(attach);
  close(pair[1]);

  const auto now = [] {
    return Time{} + std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch());
  };
  UdmxWidget widget;
  widget.power_on(now());
  UsbipSession session(widget, UsbipSession::Beginning::attached);
  std::printf("plugged\n");
  int shown = -1;
  while (!session.is_broken()) {
    pollfd ready{pair[0], POLLIN, 0};
    poll(&ready, 1, 1);
    std::array<std::uint8_t, 4096> bytes;
    const auto got = recv(pair[0], bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (got == 0) break;
    if (got > 0) session.receive(now(), {bytes.data(), static_cast<std::size_t>(got)});
    session.serve(now());
    const auto said = session.take_output();
    if (!said.empty() && send(pair[0], said.data(), said.size(), MSG_NOSIGNAL) < 0) break;
    const auto look = widget.line(now());
    const int slot = look ? look->at(0) : -1;
    if (slot != shown) std::printf("slot 1: %d\n", slot);
    shown = slot;
  }
  return 0;
}
