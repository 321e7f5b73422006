#include "drivers/dmx/sacn/sacn_source.h"

#include <algorithm>

#include "drivers/dmx/sequence.h"
#include "drivers/io/host_id.h"

namespace luxrig::sacn {
namespace {

// Clause 6.6.2: three packets of unchanged data, then one every 800…1000 ms. 880 ms leaves both ends room for a late
// 44 Hz cycle.
constexpr int kRepeatsAfterChange = 3;
constexpr Duration kKeepAlive = std::chrono::milliseconds(880);

// Clause 4.3, E131_UNIVERSE_DISCOVERY_INTERVAL.
constexpr Duration kDiscoveryInterval = std::chrono::seconds(10);

}  // namespace

Cid derive_cid(std::string_view host, std::string_view rig, std::string_view bus) {
  const std::string_view parts[] = {"luxrig sacn", host, rig, bus};
  Cid cid = hashed_id(parts);
  cid[6] = static_cast<std::uint8_t>((cid[6] & 0x0F) | 0x80);  // version 8
  cid[8] = static_cast<std::uint8_t>((cid[8] & 0x3F) | 0x80);  // variant of RFC 9562
  return cid;
}

std::optional<Cid> parse_cid(std::string_view text) {
  if (text.size() != 36) return std::nullopt;
  Cid cid{};
  std::size_t digits = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (i == 8 || i == 13 || i == 18 || i == 23) {
      if (letter != '-') return std::nullopt;
      continue;
    }
    int value = 0;
    if (letter >= '0' && letter <= '9') {
      value = letter - '0';
    } else if (letter >= 'a' && letter <= 'f') {
      value = letter - 'a' + 10;
    } else if (letter >= 'A' && letter <= 'F') {
      value = letter - 'A' + 10;
    } else {
      return std::nullopt;
    }
    std::uint8_t& byte = cid[digits / 2];
    byte = static_cast<std::uint8_t>(byte << 4 | value);
    ++digits;
  }
  return cid;
}

std::vector<std::uint8_t> Source::next_packet(int universe, Stream& stream, std::uint8_t start_code, bool terminated) {
  const DmxSlots& slots = start_code == kSlotPriority ? *stream.priorities : stream.slots;
  DataPacket packet;
  packet.cid = settings_.cid;
  packet.source_name = settings_.source_name;
  packet.priority = static_cast<std::uint8_t>(settings_.priority);
  packet.sync_universe = static_cast<std::uint16_t>(settings_.sync_universe);
  packet.force_sync = settings_.sync_universe != 0;
  packet.sequence = stream.sequence;
  packet.preview = settings_.preview;
  packet.terminated = terminated;
  packet.universe = static_cast<std::uint16_t>(universe);
  packet.start_code = start_code;
  packet.slots.assign(slots.begin(), slots.end());
  stream.sequence = static_cast<std::uint8_t>(stream.sequence + (stream.packets == 0 ? kJumpAfterFirstPacket : 1));
  ++stream.packets;
  owes_sync_ = owes_sync_ || settings_.sync_universe != 0;
  return encode(packet);
}

std::optional<std::vector<std::uint8_t>> Source::due(Time now, int universe, const DmxSlots& slots) {
  Stream& stream = streams_[universe];
  if (!stream.sending || slots != stream.slots) {
    stream.repeats_left = 1 + kRepeatsAfterChange;
    stream.slots = slots;
    stream.sending = true;
  }
  // Priorities go first, so a receiver knows them with the first levels. They replace a packet of levels, since the
  // rate counts all packets of a universe (clause 6.6.1).
  if (stream.priorities && (!stream.priorities_sent || now - *stream.priorities_sent >= kKeepAlive)) {
    if (!stream.rate.take(now)) return std::nullopt;
    stream.priorities_sent = now;
    return next_packet(universe, stream, kSlotPriority, false);
  }
  const bool wanted = settings_.continuous || stream.repeats_left > 0 || now - stream.last >= kKeepAlive;
  if (!wanted || !stream.rate.take(now)) return std::nullopt;
  if (stream.repeats_left > 0) --stream.repeats_left;
  stream.last = now;
  return next_packet(universe, stream, kLevels, false);
}

bool Source::is_sent(int universe, const DmxSlots& slots) const {
  const auto found = streams_.find(universe);
  return found != streams_.end() && found->second.sending && found->second.slots == slots &&
         found->second.repeats_left <= kRepeatsAfterChange;
}

std::optional<std::vector<std::uint8_t>> Source::goodbye(int universe) {
  const auto found = streams_.find(universe);
  if (found == streams_.end() || !found->second.sending) return std::nullopt;
  return next_packet(universe, found->second, kLevels, true);
}

std::optional<std::vector<std::uint8_t>> Source::sync_due() {
  if (!owes_sync_) return std::nullopt;
  owes_sync_ = false;
  const SyncPacket packet{settings_.cid, sync_sequence_, static_cast<std::uint16_t>(settings_.sync_universe)};
  sync_sequence_ = static_cast<std::uint8_t>(sync_sequence_ + (syncs_ == 0 ? kJumpAfterFirstPacket : 1));
  ++syncs_;
  return encode(packet);
}

std::vector<std::vector<std::uint8_t>> Source::discovery_due(Time now) {
  if (!listed_) listed_ = now;  // the first list goes out after one interval, when the universes are known
  if (now - *listed_ < kDiscoveryInterval) return {};
  listed_ = now;
  std::vector<std::uint16_t> universes;
  for (const auto& [universe, stream] : streams_) {
    if (stream.sending) universes.push_back(static_cast<std::uint16_t>(universe));
  }
  if (universes.empty()) return {};
  std::vector<std::vector<std::uint8_t>> pages;
  const std::size_t last_page = (universes.size() - 1) / kUniversesPerPage;
  for (std::size_t page = 0; page <= last_page; ++page) {
    const auto begin = universes.begin() + static_cast<std::ptrdiff_t>(page * kUniversesPerPage);
    const auto left = static_cast<std::size_t>(universes.end() - begin);
    const auto end = begin + static_cast<std::ptrdiff_t>(std::min(left, kUniversesPerPage));
    pages.push_back(encode(DiscoveryPacket{settings_.cid,
                                           settings_.source_name,
                                           static_cast<std::uint8_t>(page),
                                           static_cast<std::uint8_t>(last_page),
                                           {begin, end}}));
  }
  return pages;
}

void Source::rest(int universe) {
  const auto found = streams_.find(universe);
  if (found == streams_.end()) return;
  found->second.sending = false;
  found->second.priorities_sent.reset();
}

void Source::rest() {
  for (const auto& entry : streams_) rest(entry.first);
  owes_sync_ = false;
  listed_.reset();
}

}  // namespace luxrig::sacn
