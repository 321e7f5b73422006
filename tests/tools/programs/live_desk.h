#pragma once
/// A lighting desk that sends, at a desk's rate, beside running programs; and the rig file text needed to hear it.

#include <mutex>

#include "tests/loopback_desk.h"
#include "tests/tools/programs/process.h"

namespace luxrig::testing {

class LiveDesk {
 public:
  /// protocol: "sacn" or "artnet".
  explicit LiveDesk(std::string protocol, int universe = 1)
      : protocol_(std::move(protocol)), universe_(universe), desk_("127.0.0.2"), slots_(512, 0) {}
  ~LiveDesk() { vanish(); }
  LiveDesk(const LiveDesk&) = delete;
  LiveDesk& operator=(const LiveDesk&) = delete;

  /// Port on which Luxrig hears it: `input_port`.
  [[nodiscard]] int port() const { return desk_.port(); }
  /// Adds a receiver: lamps that the desk drives itself.
  void also_send_to(int port) { further_ports_.push_back(port); }
  void set(test::DeskSlots slots) {
    const std::lock_guard lock(mutex_);
    slots_ = std::move(slots);
  }
  /// Sends from now on, once per period.
  void appear(std::chrono::milliseconds period = 25ms) {
    thread_ = std::jthread([this, period](const std::stop_token& stop) {
      auto next = std::chrono::steady_clock::now();
      while (!stop.stop_requested()) {
        send_once();
        next += period;
        while (!stop.stop_requested() && std::chrono::steady_clock::now() < next)
          std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(
              20ms, std::max<std::chrono::nanoseconds>(0ns, next - std::chrono::steady_clock::now())));
      }
    });
  }
  /// Stops without a goodbye.
  void vanish() { thread_ = {}; }

 private:
  void send_once() {
    ++sequence_;
    if (sequence_ == 0) ++sequence_;
    test::DeskPacket packet;
    {
      const std::lock_guard lock(mutex_);
      packet = protocol_ == "sacn" ? test::sacn_packet(universe_, sequence_, slots_)
                                   : test::artdmx_packet(universe_, sequence_, slots_);
    }
    desk_.send(packet);
    for (const int port : further_ports_) desk_.send_to(port, packet);
  }

  std::string protocol_;
  int universe_;
  test::LoopbackDesk desk_;
  std::vector<int> further_ports_;
  std::mutex mutex_;
  test::DeskSlots slots_;
  std::uint8_t sequence_ = 0;
  std::jthread thread_;
};

/// The rig file's text with one line replaced, such as by another driver and further options of its bus.
inline std::string with_line(std::string text, const std::string& line, const std::string& instead) {
  const auto at = text.find(line + "\n");
  EXPECT_NE(at, std::string::npos) << line;
  return at == std::string::npos ? text : text.replace(at, line.size(), instead);
}

}  // namespace luxrig::testing
