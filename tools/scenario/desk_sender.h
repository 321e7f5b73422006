#pragma once
/// A lighting desk on loopback: it sends sACN or Art-Net to the daemon, at the rate of a desk, for chosen fixtures. In
/// standby it also sends to the lamps. When it sends for no fixture it is silent, as if its cable were pulled.
///
/// sACN tells by slot which values a desk has (start code 0xDD), so it commands these fixtures alone. Art-Net cannot:
/// all other fixtures of the universe get 0 from it.

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/output/devices.h"
#include "core/result.h"
#include "core/rig/rig.h"
#include "drivers/dmx/desk_options.h"

namespace luxrig::scenario {

class DeskSender {
 public:
  /// For the buses that listen. lamps: per bus the port of its lamps, where in standby the desk sends too.
  [[nodiscard]] static Result<DeskSender> open(const Rig& rig, const std::map<std::string, int>& lamps);
  ~DeskSender();
  DeskSender(DeskSender&& other) noexcept;
  DeskSender& operator=(DeskSender&&) = delete;

  /// UDP port on which the daemon is to hear it, by bus.
  [[nodiscard]] const std::map<std::string, int>& daemon_ports() const { return daemon_ports_; }
  void set(std::size_t fixture, const std::optional<DeskCommand>& command) { commands_[fixture] = command; }
  /// Call at every tick.
  void send(Time now);

 private:
  DeskSender(const Rig& rig, int socket) : rig_(&rig), socket_(socket), commands_(rig.fixtures.size()) {}
  void send_bus(std::size_t bus);
  void send_to(int port, const std::vector<std::uint8_t>& packet) const;

  const Rig* rig_;
  int socket_;
  std::map<std::string, int> daemon_ports_, lamp_ports_;
  std::vector<std::optional<DeskCommand>> commands_;  ///< per fixture
  std::map<int, std::uint8_t> sequence_;              ///< by universe
  std::optional<Time> due_;
};

}  // namespace luxrig::scenario
