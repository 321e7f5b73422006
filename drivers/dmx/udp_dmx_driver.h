#pragma once
/// What every driver that carries DMX universes over UDP has in common: life cycle, reopening, errors of the network
/// and recovery from them. A driver derives from it and says what is sent when, and what it makes of what arrives.

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

  /// A part for each universe.
  LevelInput* level_input() final { return desk_.rules ? this : nullptr; }
  [[nodiscard]] DeskRules rules() const final { return desk_.rules.value_or(DeskRules{}); }
  [[nodiscard]] std::vector<DeskPart> parts() const final;
  std::span<const DeskFrame> listen(Time now) final;
  void set_silent(Time now, std::size_t part, bool silent) final;

 protected:
  /// One channel, or one for each network interface: everything goes out by all of them.
  UdpDmxDriver(std::vector<std::unique_ptr<DatagramChannel>> channels, const Rig& rig, std::size_t bus,
               DeskOptions desk);

  // What a derived driver fills in.
  virtual void begin(Time) {}                                       ///< activated; the channels are not open yet
  virtual void opened(DatagramChannel&) {}                          ///< a channel has just been opened
  virtual void hear(Time, const Datagram&) {}                       ///< something has arrived
  virtual void send_frame(Time now) = 0;                            ///< sends what is due
  [[nodiscard]] virtual bool is_sent(const DmxUniverse& universe) const = 0;  ///< its slots as they are now
  virtual void say_goodbye(Time) {}                                 ///< about to close
  virtual void fall_silent(Time, const DmxUniverse&) {}             ///< this universe is sent no more, for now
  virtual HeardUniverse heard(Time, int) { return {}; }             ///< of a universe of the desk's
  virtual void rest() {}                                            ///< closed; the next activation starts afresh
  [[nodiscard]] virtual bool has_answers() const { return false; }  ///< peers answer, so a send alone proves nothing
  /// What keeps data from reaching a lamp although the network has nothing to say; nothing when all is well.
  [[nodiscard]] virtual std::optional<std::string> missing(Time) const { return std::nullopt; }

  /// Sends by all channels, and counts.
  void send(Time now, const SocketAddress& to, std::span<const std::uint8_t> bytes);
  /// Goodbye and close. A derived destructor calls it: the base's is too late for what it overrides.
  void close();
  [[nodiscard]] const std::vector<std::unique_ptr<DatagramChannel>>& channels() const { return channels_; }
  [[nodiscard]] Duration write_bound() const;  ///< sends never block; 0.1 ms each is ten times what one costs

  /// Takes what has arrived, and what the network says about earlier packets.
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
