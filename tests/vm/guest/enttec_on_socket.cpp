/// The simulated ENTTEC widget behind qemu's FTDI chip: its serial side is a socket that qemu connects to.
///   enttec_on_socket SOCKET LOG
/// LOG gets a line "slot 1: N" on each change, and at the end a summary of the widget.

#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>

#include "sim/devices/usb/enttec_widget.h"

namespace {
volatile sig_atomic_t g_stop = 0;
}

int main(int argc, char** argv) {
  using namespace luxrig;
  using namespace luxrig::sim;
  if (argc != 3) return 2;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (std::strlen(argv[1]) >= sizeof address.sun_path) return 2;
  std::strcpy(address.sun_path, argv[1]);
  std::FILE* log = std::fopen(argv[2], "w");
  if (log == nullptr) return perror(argv[2]), 1;
  setvbuf(log, nullptr, _IOLBF, 0);
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  unlink(argv[1]);
  if (bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || listen(listener, 1) != 0) {
    return perror(argv[1]), 1;
  }
  struct sigaction end {};
  end.sa_handler = [](int) { g_stop = 1; };
  sigaction(SIGTERM, &end, nullptr);

  EnttecWidget widget;
  int client = -1, shown = -1;
  while (g_stop == 0) {
    pollfd ready[2] = {{listener, POLLIN, 0}, {client, POLLIN, 0}};
    if (poll(ready, 2, 1000) < 0) continue;
    if ((ready[0].revents & POLLIN) != 0) {
      if (client >= 0) close(client);
      client = accept(listener, nullptr, nullptr);
      widget.power_on(Time{});
      continue;
    }
    if (client < 0 || ready[1].revents == 0) continue;
    std::array<std::uint8_t, 4096> bytes;
    const auto got = recv(client, bytes.data(), bytes.size(), 0);
    if (got <= 0) {
      close(client);
      client = -1;
      continue;
    }
    widget.receive(Time{}, {}, {}, {bytes.data(), static_cast<std::size_t>(got)});
    const auto said = widget.take(Time{}, 100000);
    if (!said.empty()) send(client, said.data(), said.size(), MSG_NOSIGNAL);
    const auto look = widget.line(Time{});
    const int slot = look ? look->at(0) : -1;
    if (slot != shown) std::fprintf(log, "slot 1: %d\n", slot);
    shown = slot;
  }
  std::fprintf(log, "frames %llu, dropped %llu, stops %llu\n", static_cast<unsigned long long>(widget.frames()),
               static_cast<unsigned long long>(widget.dropped()), static_cast<unsigned long long>(widget.stops()));
  std::fclose(log);
  return 0;
}
