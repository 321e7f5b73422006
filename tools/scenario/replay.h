#pragma once
/// A recording of a real rig, played into a tested show: what its desks sent, and what its luxmeters showed.
///
/// Datagrams go through the receivers of the drivers, with their rules: a source of sACN counts 1.5 s after its first
/// packet, the highest priority wins, a source that falls silent is lost. Luxrig's own packets are left out.

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "core/output/devices.h"
#include "drivers/dmx/artnet/artnet_receiver.h"
#include "drivers/dmx/dmx_patch.h"
#include "drivers/dmx/sacn/sacn_receiver.h"
#include "tools/recording/of_rig.h"

namespace luxrig::scenario {

class Replay {
 public:
  /// The first packet comes at `begin`. requires a rig whose buses were checked.
  Replay(const Rig& rig, std::shared_ptr<const recording::Recording> recording, Time begin);

  /// It has something that a desk sent to the rig, or a reading of one of its luxmeters.
  [[nodiscard]] bool concerns_the_rig() const { return concerns_; }
  [[nodiscard]] bool is_over(Time now) const { return now > begin_ + recording_->length; }

  /// Fixtures that a desk of the recording could send for.
  [[nodiscard]] const std::vector<std::size_t>& fixtures() const { return fixtures_; }
  /// What desks send for these fixtures at `now`, which must not go back.
  [[nodiscard]] std::vector<DeskCommand> desk(Time now);

  /// Luxmeters that it has readings of.
  [[nodiscard]] std::vector<std::size_t> luxmeters() const;
  /// The newest reading of such a luxmeter at `now`; before the first one none.
  [[nodiscard]] std::optional<double> reading_lx(std::size_t luxmeter, Time now) const;

 private:
  struct Ear {
    recording::DeskBus bus;
    DmxPatchbay bay;
    std::optional<sacn::Receiver> sacn;
    std::optional<artnet::Receiver> artnet;
    std::map<int, int> numbers;  ///< OLA: by universe, the number of the next packet
  };
  [[nodiscard]] static HeardUniverse heard(Ear& ear, Time now, int universe);

  std::shared_ptr<const recording::Recording> recording_;
  Time begin_;
  bool concerns_ = false;
  std::vector<bool> own_;  ///< per source: Luxrig itself
  std::vector<Ear> ears_;
  std::vector<std::size_t> fixtures_;
  std::vector<std::vector<recording::MeterReading>> readings_;  ///< per luxmeter
  std::size_t next_ = 0;                                        ///< of the packets
};

}  // namespace luxrig::scenario
