#include "tools/scenario/replay.h"

#include <algorithm>

namespace luxrig::scenario {
namespace {

/// Longer than a receiver needs to be sure that nobody sends: it has listened before the replay begins.
constexpr Duration kListenedBefore = std::chrono::seconds(5);

}  // namespace

Replay::Replay(const Rig& rig, std::shared_ptr<const recording::Recording> recording, Time begin)
    : recording_(std::move(recording)),
      begin_(begin),
      own_(recording::own_sources(*recording_, rig)),
      readings_(recording::meter_readings(*recording_, rig)) {
  for (recording::DeskBus& bus : recording::desk_buses(rig)) {
    const bool hears = std::any_of(recording_->dmx.begin(), recording_->dmx.end(), [&](const auto& packet) {
      return packet.universe && !own_[packet.source] && recording::hears(bus, *recording_, packet);
    });
    if (!hears) continue;
    Ear ear{std::move(bus), DmxPatchbay(rig, bus.bus), {}, {}, {}};
    const std::vector<int> universes(ear.bus.universes.begin(), ear.bus.universes.end());
    if (ear.bus.protocol == recording::Protocol::sacn)
      ear.sacn.emplace(sacn::ReceiverSettings{universes, std::nullopt, ear.bus.desk.merge, ear.bus.lowest_priority});
    else
      ear.artnet.emplace(artnet::ReceiverSettings{universes, ear.bus.desk.merge, {}, {}, {}, {}});
    for (const int universe : universes) (void)heard(ear, begin - kListenedBefore, universe);
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
      if (rig.fixtures[f].bus == ear.bus.bus) fixtures_.push_back(f);
    ears_.push_back(std::move(ear));
  }
  concerns_ = !ears_.empty() || !luxmeters().empty();
}

HeardUniverse Replay::heard(Ear& ear, Time now, int universe) {
  return ear.sacn ? ear.sacn->heard(now, universe) : ear.artnet->heard(now, universe);
}

std::vector<DeskCommand> Replay::desk(Time now) {
  for (; next_ < recording_->dmx.size() && begin_ + recording_->dmx[next_].at <= now; ++next_) {
    const recording::DmxPacket& packet = recording_->dmx[next_];
    const recording::Source& source = recording_->sources[packet.source];
    if (own_[packet.source]) continue;
    const Time at = begin_ + packet.at;
    for (Ear& ear : ears_) {
      if (!recording::hears(ear.bus, *recording_, packet)) continue;
      const bool of_ola = source.protocol == recording::Protocol::ola;
      const std::vector<std::uint8_t> bytes =
          of_ola ? datagram_of(*recording_, packet, ear.bus.protocol, ear.numbers[*packet.universe]++) : packet.bytes;
      if (ear.sacn)
        (void)ear.sacn->receive(at, bytes);
      else
        (void)ear.artnet->receive(at, source.address, bytes);
    }
  }
  std::vector<DeskCommand> commands;
  for (Ear& ear : ears_) {
    const auto universes = ear.bay.universes();
    for (std::size_t u = 0; u < universes.size(); ++u) {
      const HeardUniverse universe = heard(ear, now, universes[u].number + ear.bus.desk.offset);
      if (universe.presence != DeskPresence::present) continue;
      const auto decoded = ear.bay.decode(u, universe.levels.slots, universe.levels.given);
      commands.insert(commands.end(), decoded.begin(), decoded.end());
    }
  }
  return commands;
}

std::vector<std::size_t> Replay::luxmeters() const {
  std::vector<std::size_t> meters;
  for (std::size_t m = 0; m < readings_.size(); ++m)
    if (!readings_[m].empty()) meters.push_back(m);
  return meters;
}

std::optional<double> Replay::reading_lx(std::size_t luxmeter, Time now) const {
  const auto& all = readings_[luxmeter];
  const auto after = std::upper_bound(all.begin(), all.end(), now - begin_,
                                      [](Duration at, const recording::MeterReading& one) { return at < one.at; });
  return after == all.begin() ? std::nullopt : std::optional(std::prev(after)->lux);
}

}  // namespace luxrig::scenario
