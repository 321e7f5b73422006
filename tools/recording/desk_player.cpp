#include "tools/recording/desk_player.h"

#include <algorithm>

#include "drivers/dmx/sacn/sacn_source.h"

namespace luxrig::recording {
namespace {

/// Of both ways to number packets: 0…255 and 1…255.
constexpr int kNumbers = 256 * 255;
/// Between the last packet of a pass and the first of the next: a frame.
constexpr Duration kBetweenPasses = std::chrono::milliseconds(25);
constexpr int kGoodbyes = 3;  // E1.31-2018, 6.2.6

sacn::Cid cid_in_replay(const Source& source) {
  return sacn::derive_cid("replay", source.name, std::string(source.cid.begin(), source.cid.end()));
}

}  // namespace

DeskPlayer::DeskPlayer(const Recording& recording, PlayerSettings settings)
    : recording_(recording), settings_(std::move(settings)) {
  for (std::size_t p = 0; p < recording.dmx.size(); ++p) {
    const DmxPacket& packet = recording.dmx[p];
    if (!settings_.sources[packet.source]) continue;
    const Protocol protocol = recording.sources[packet.source].protocol;
    for (std::size_t r = 0; r < settings_.receivers.size(); ++r) {
      const Receiver& receiver = settings_.receivers[r];
      if (protocol != receiver.protocol && protocol != Protocol::ola) continue;
      if (packet.universe && receiver.universes && !receiver.universes->contains(*packet.universe)) continue;
      chosen_.push_back({p, r});
    }
  }
  if (chosen_.empty()) settings_.repeats = false;
}

Duration DeskPlayer::scaled(Duration recorded) const { return from_seconds(to_seconds(recorded) / settings_.speed); }

std::optional<Duration> DeskPlayer::next() const {
  if (next_ < chosen_.size()) return pass_begins_ + scaled(recording_.dmx[chosen_[next_].packet].at);
  if (!settings_.repeats) return std::nullopt;
  return pass_begins_ + scaled(recording_.length + kBetweenPasses + recording_.dmx[chosen_.front().packet].at);
}

void DeskPlayer::begin_pass() {
  pass_begins_ += scaled(recording_.length + kBetweenPasses);
  next_ = 0;
  for (auto& [key, stream] : streams_) {
    if (!stream.first) continue;
    stream.offset = (stream.offset + *stream.newest - *stream.first + 1 + kNumbers) % kNumbers;
    stream.first.reset();
  }
}

std::vector<DeskPlayer::Outgoing> DeskPlayer::due(Duration at) {
  std::vector<Outgoing> all;
  for (auto when = next(); when && *when <= at; when = next()) {
    if (next_ == chosen_.size()) begin_pass();
    all.push_back(outgoing(chosen_[next_++]));
  }
  return all;
}

DeskPlayer::Outgoing DeskPlayer::outgoing(const Chosen& one) {
  const DmxPacket& packet = recording_.dmx[one.packet];
  const Source& source = recording_.sources[packet.source];
  const Receiver& receiver = settings_.receivers[one.receiver];
  Stream& stream = streams_[{packet.source, one.receiver, packet.universe}];
  const int number = number_of(recording_, packet);
  if (source.protocol == Protocol::ola) stream.offset = (stream.offset + 1) % kNumbers;
  if (!stream.first) stream.first = number;
  stream.newest = number;
  stream.last = datagram_of(recording_, packet, receiver.protocol, stream.offset, cid_in_replay(source));
  // A synchronisation packet goes to the group of the universe that it names.
  int group = packet.universe.value_or(0);
  if (const auto sync = sacn::decode_sync(stream.last)) group = sync->sync_universe;
  stream.to = {receiver.ipv4.value_or(sacn::multicast_group(static_cast<std::uint16_t>(group))), receiver.port};
  return {stream.to, stream.last};
}

std::vector<DeskPlayer::Outgoing> DeskPlayer::goodbyes() const {
  std::vector<Outgoing> all;
  for (const auto& [key, stream] : streams_) {
    auto packet = sacn::decode(stream.last);
    if (!packet || packet->terminated) continue;
    packet->terminated = true;
    for (int i = 0; i < kGoodbyes; ++i) {
      ++packet->sequence;
      all.push_back({stream.to, sacn::encode(*packet)});
    }
  }
  return all;
}

}  // namespace luxrig::recording
