// The CAN channel at a controller with states: slcan on a pseudo-terminal, where this program plays the adapter at the
// other end. Exits 0 if the channel saw all states.
#include <fcntl.h>
#include <fmt/format.h>
#include <net/if.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <thread>

#include "drivers/can/bus_state.h"
#include "drivers/can/can_socket.h"

namespace {

using namespace luxrig;
using can::ControllerState;

int failures = 0;
void check(bool so, std::string_view what) {
  fmt::print("{} {}\n", so ? "ok    " : "FAILED", what);
  std::fflush(stdout);
  failures += !so;
}

/// Reads what the kernel sends to the adapter, unless reads is false.
struct Adapter {
  explicit Adapter(int fd) : master(fd) {}
  int master;
  std::atomic<bool> reads{true}, ends{false};
  std::mutex mutex;
  std::string heard;
  std::thread thread{[this] {
    while (!ends) {
      char buffer[256];
      if (!reads) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        continue;
      }
      const auto got = ::read(master, buffer, sizeof buffer);
      if (got <= 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      const std::lock_guard lock(mutex);
      heard.append(buffer, static_cast<std::size_t>(got));
    }
  }};
  bool has(const std::string& text) {
    for (int i = 0; i < 200; ++i) {
      {
        const std::lock_guard lock(mutex);
        if (heard.find(text) != std::string::npos) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  void say(std::string_view text) const {
    if (::write(master, text.data(), text.size()) < 0) std::perror("adapter");
  }
};

bool run(const std::string& command) { return std::system(command.c_str()) == 0; }

}  // namespace

int main() {
  int master = -1, slave = -1;
  termios raw{};
  ::cfmakeraw(&raw);
  if (::openpty(&master, &slave, nullptr, &raw, nullptr) != 0) return 2;
  ::fcntl(master, F_SETFL, O_NONBLOCK);
  Adapter adapter(master);
  int discipline = 17;  // N_SLCAN
  if (::ioctl(slave, TIOCSETD, &discipline) != 0) return 2;
  char name[IFNAMSIZ] = {};
  ::ioctl(slave, SIOCGIFNAME, name);
  const std::string link = name;

  auto absent = can::make_can_socket({"nocan9", {0x705}});
  const auto refused = absent->open();
  check(!refused && refused.error().detail.find("nocan9") != std::string::npos, "no such interface is said by name");
  auto channel = can::make_can_socket({link, {0x705, 0x185}});
  const auto down = channel->open();
  check(!down && down.error().cause == Cause::network, "an interface that is down cannot be used");
  check(run("/bin/ip link set " + link + " type can bitrate 500000") && run("/bin/ip link set " + link + " up"),
        "the interface comes up");
  check(channel->open().has_value() && channel->is_open(), "and is opened");

  can::BusState state;
  std::optional<can::CanFrame> last;
  const auto until = [&](const std::function<bool()>& so) {
    for (int i = 0; i < 300 && !so(); ++i) {
      while (auto frame = channel->receive()) {
        state.heard(*frame);
        last = frame;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return so();
  };
  adapter.say("t70617F\rt705105\r");  // node 6 does not belong to us
  check(until([&] { return last.has_value(); }) && last->id == 0x705 && last->data[0] == 5,
        "a filter lets ours through");
  check(last && last->received && last->received->count() > 0, "with the kernel's time");
  const auto sync = can::data_frame(0x080, {});
  check(channel->send(sync) == can::Sent::yes && adapter.has("t0800\r"), "what is sent reaches the adapter");

  adapter.say("sw100096\r");
  check(until([&] { return state.state() == ControllerState::warning; }), "error-warning");
  adapter.say("sp130128\r");
  check(until([&] { return state.state() == ControllerState::passive; }), "error-passive");
  adapter.say("sb256256\r");
  check(until([&] { return state.state() == ControllerState::off; }), "bus-off");
  (void)run("/bin/ip link set " + link + " down");
  (void)until([&] { return !channel->is_open(); });
  const auto error = channel->take_error();
  check(!channel->is_open() && error && error->cause == Cause::network, "the link goes down: said, and closed");
  check(run("/bin/ip link set " + link + " up") && channel->open().has_value(), "up again, opened again");
  state.reset();
  last.reset();
  adapter.say("t705105\r");
  check(until([&] { return last && last->id == 0x705; }) && state.state() == ControllerState::active, "and hears");

  adapter.reads = false;  // the adapter no longer reads
  bool full = false;
  for (int i = 0; i < 5000 && !full; ++i) {
    const auto sent = channel->send(sync);
    full = sent && *sent == can::Sent::queue_full;
  }
  check(full, "a full queue is said, and the channel stays open");
  check(channel->is_open(), "open");
  adapter.reads = true;
  bool again = false;
  for (int i = 0; i < 300 && !again; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const auto sent = channel->send(sync);
    again = sent && *sent == can::Sent::yes;
  }
  check(again, "and takes frames when it has drained");

  adapter.ends = true;
  adapter.thread.join();
  ::close(slave);
  ::close(master);  // the adapter is pulled out
  const auto gone = [&] {
    if (channel->is_open()) (void)channel->send(sync);
    return !channel->is_open();
  };
  check(until(gone), "the adapter is gone: closed");
  check(!channel->open().has_value(), "and cannot be opened");
  return failures == 0 ? 0 : 1;
}
