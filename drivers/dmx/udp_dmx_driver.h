#pragma once
/// Common base of drivers that carry DMX universes over UDP: life cycle, reopening, network errors and recovery. A
/// derived driver decides what to send when, and handles received datagrams.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/dmx/desk_options.h"
#include "drivers/dmx/dmx_patch.h"
#include "drivers/driver.h"
#include "drivers/io/datagram.h"
#include "drivers/life.h"

namespace luxrig {

class UdpDmxDriver : public Driver, public LevelOutput, public Mover, public LevelInput {
 public:
  UdpDmxDriver(const UdpDmxDriver&) = delete;
  UdpDmxDriver& operator=(const UdpDmxDriver&) = delete;

  Result<void> activate(Time now) final;
  void deactivate(Time now) final;
  [[nodiscard]] std::vector<Health> health(Time) const override { return {life_.health()}; }
  [[nodiscard]] std::vector<CarriedUniverse> carried() const final;
  LevelOutput* level_output() final { return this; }
  Mover* mover() final { return bay_.has_heads() ? this : nullptr; }
  Result<void> move(Time now, std::span<const AimCommand> commands) final;
  Result<void> write(Time now, std::span<const LevelCommand> commands) final;
  [[nodiscard]] bool settled() const final;

  /// One part for each universe.
  LevelInput* level_input() final { return desk_.rules ? this : nullptr; }
  [[nodiscard]] DeskRules rules() const final { return desk_.rules.value_or(DeskRules{}); }
  [[nodiscard]] std::vector<DeskPart> parts() const final;
  std::span<const DeskFrame> listen(Time now) final;
  void set_silent(Time now, std::size_t part, bool silent) final;

 protected:
  /// One channel, or one for each network interface; every packet goes out on all of them.
  UdpDmxDriver(std::vector<std::unique_ptr<DatagramChannel>> channels, const Rig& rig, std::size_t bus,
               DeskOptions desk);

  // Implemented by a derived driver.
  virtual void begin(Time) {}                                       ///< activated; the channels are not open yet
  virtual void opened(DatagramChannel&) {}                          ///< a channel has just been opened
  virtual void hear(Time, const Datagram&) {}                       ///< a datagram has arrived
  virtual void send_frame(Time now) = 0;                            ///< sends the packets that are due
  [[nodiscard]] virtual bool is_sent(const DmxUniverse& universe) const = 0;  ///< its slots as they are now
  virtual void say_goodbye(Time) {}                                 ///< about to close
  virtual void fall_silent(Time, const DmxUniverse&) {}             ///< this universe is not sent for now
  virtual HeardUniverse heard(Time, int) { return {}; }             ///< of one of the desk's universes
  virtual void rest() {}                                            ///< closed; the next activation starts over
  [[nodiscard]] virtual bool has_answers() const { return false; }  ///< peers answer, so a send alone is no proof
  /// A reason why data does not reach a lamp although the network reports no error; empty if all is well.
  [[nodiscard]] virtual std::optional<std::string> missing(Time) const { return std::nullopt; }

  /// Sends on all channels, and counts.
  void send(Time now, const SocketAddress& to, std::span<const std::uint8_t> bytes);
  /// Says goodbye and closes. A derived destructor must call it: the base's is too late for overridden functions.
  void close();
  [[nodiscard]] const std::vector<std::unique_ptr<DatagramChannel>>& channels() const { return channels_; }
  [[nodiscard]] Duration write_bound() const;  ///< sends never block; allows 0.1 ms each, ten times the real cost

  /// Takes received datagrams, and network errors about earlier packets.
  void listen_to_network(Time now);

  /// Whether a universe is left out of the frame; index as in bay_.universes().
  [[nodiscard]] bool is_silent(std::size_t universe) const { return silent_[universe] != 0; }
  [[nodiscard]] const DeskOptions& desk() const { return desk_; }
  [[nodiscard]] std::vector<int> desk_universes() const;
  void note_error(Time now, const Fault& fault);

  DmxPatchbay bay_;
  LifeRecord life_;

 private:
  [[nodiscard]] Fault inactive() const;
  [[nodiscard]] bool any_open() const;
  void open(Time now);
  void update_life(Time now);

  std::vector<std::unique_ptr<DatagramChannel>> channels_;
  DeskOptions desk_;
  std::vector<DeskFrame> frames_;
  std::vector<std::uint8_t> silent_;
  std::optional<Time> last_error_;
  Time reopen_at_{}, latest_{};
};

}  // namespace luxrig
