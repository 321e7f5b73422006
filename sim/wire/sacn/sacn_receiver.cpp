#include "sim/wire/sacn/sacn_receiver.h"

#include <algorithm>
#include <cstring>

#include "sim/wire/bytes.h"

namespace luxrig::sim {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Bounds memory against a flood of forged sources or universes.
constexpr std::size_t kMaxSacnSources = 16;
constexpr std::size_t kMaxUniverses = 256;

// Flags are 0x7; the length counts from the field itself to the end of the PDU (E1.31 §4.1, E1.17 §2.2).
bool flags_and_length_fit(Bytes packet, std::size_t offset) {
  const int field = big_endian_16(packet, offset);
  return field >> 12 == 0x7 && static_cast<std::size_t>(field & 0x0fff) == packet.size() - offset;
}

// Root layer, §5: preamble 0x0010, postamble 0, ACN packet identifier, vector.
bool root_layer_fits(Bytes packet, std::uint32_t vector) {
  static constexpr std::uint8_t kAcnId[] = {'A', 'S', 'C', '-', 'E', '1', '.', '1', '7', 0, 0, 0};
  return packet.size() >= 38 && big_endian_16(packet, 0) == 0x0010 && big_endian_16(packet, 2) == 0 &&
         std::equal(std::begin(kAcnId), std::end(kAcnId), packet.begin() + 4) && flags_and_length_fit(packet, 16) &&
         big_endian_32(packet, 18) == vector;
}

template <std::size_t size>
std::array<std::uint8_t, size> copied(Bytes packet, std::size_t offset) {
  std::array<std::uint8_t, size> bytes{};
  std::copy_n(packet.begin() + static_cast<std::ptrdiff_t>(offset), size, bytes.begin());
  return bytes;
}

// §6.7.2: out of order if the distance to the last number is in (-20, 0].
bool sacn_out_of_order(std::uint8_t sequence, std::uint8_t last) {
  const auto distance = static_cast<std::int8_t>(sequence - last);
  return distance <= 0 && distance > -20;
}

}  // namespace

std::optional<SacnData> decode_sacn_data(Bytes packet) {
  constexpr std::size_t kDataHeader = 126;  // including the start code
  if (packet.size() < kDataHeader || packet.size() > kDataHeader + kDmxSlots) return std::nullopt;
  if (!root_layer_fits(packet, 0x00000004)) return std::nullopt;  // VECTOR_ROOT_E131_DATA
  // Framing layer, §6.2: VECTOR_E131_DATA_PACKET.
  if (!flags_and_length_fit(packet, 38) || big_endian_32(packet, 40) != 0x00000002) return std::nullopt;
  SacnData data;
  data.cid = copied<16>(packet, 22);
  const auto* name = reinterpret_cast<const char*>(packet.data() + 44);
  data.source_name.assign(name, ::strnlen(name, 64));
  data.priority = packet[108];
  data.sync_universe = big_endian_16(packet, 109);
  data.sequence = packet[111];
  data.preview = (packet[112] & 0x80) != 0;
  data.terminated = (packet[112] & 0x40) != 0;
  data.force_sync = (packet[112] & 0x20) != 0;
  data.universe = big_endian_16(packet, 113);
  if (data.priority > 200 || data.universe < 1 || data.universe > 63999) return std::nullopt;  // §6.2.3, §6.2.7
  // DMP layer, §7: set property, address type 0xA1, first address 0, increment 1, count = start code and slots.
  if (!flags_and_length_fit(packet, 115) || packet[117] != 0x02 || packet[118] != 0xa1) return std::nullopt;
  if (big_endian_16(packet, 119) != 0 || big_endian_16(packet, 121) != 1) return std::nullopt;
  if (static_cast<std::size_t>(big_endian_16(packet, 123)) != packet.size() - 125) return std::nullopt;
  data.start_code = packet[125];
  data.slots = packet.subspan(kDataHeader);
  return data;
}

std::optional<SacnSync> decode_sacn_sync(Bytes packet) {
  if (packet.size() != 49 || !root_layer_fits(packet, 0x00000008)) return std::nullopt;  // VECTOR_ROOT_E131_EXTENDED
  // §6.3: VECTOR_E131_EXTENDED_SYNCHRONIZATION.
  if (!flags_and_length_fit(packet, 38) || big_endian_32(packet, 40) != 0x00000001) return std::nullopt;
  const int universe = big_endian_16(packet, 45);
  if (universe < 1 || universe > 63999) return std::nullopt;  // §6.3.3: a universe that data can name
  return SacnSync{copied<16>(packet, 22), packet[44], universe};
}

SacnReceiver::Verdict SacnReceiver::receive(Time now, Bytes packet) {
  if (const auto sync = decode_sacn_sync(packet)) {
    if (last_sync_.size() >= kMaxUniverses && !last_sync_.contains(sync->sync_universe)) return Verdict::ignored;
    last_sync_[sync->sync_universe] = now;
    for (auto& [number, universe] : universes_) {
      for (auto& [cid, source] : universe.sources) {
        if (!source.waiting || source.sync_universe != sync->sync_universe) continue;
        source.slots = source.held;
        source.waiting = false;
        source.live = true;
      }
      merge(universe);
    }
    return Verdict::accepted;
  }
  const auto data = decode_sacn_data(packet);
  if (!data) return Verdict::not_sacn;
  if (data->preview) return Verdict::preview;          // §6.2.6: never to live outputs
  if (data->start_code != 0) return Verdict::ignored;  // only levels reach fixtures
  if (universes_.size() >= kMaxUniverses && !universes_.contains(data->universe)) return Verdict::ignored;

  Universe& universe = universes_[data->universe];
  forget_lost(universe, now);  // so a returning source is new, with new sequence numbers (§6.7.1)
  const auto known = universe.sources.find(data->cid);
  if (known != universe.sources.end() && sacn_out_of_order(data->sequence, known->second.sequence)) {
    return Verdict::out_of_order;
  }
  if (data->terminated) {  // §6.2.6: levels in it are not used, the source is gone at once
    if (known != universe.sources.end()) universe.sources.erase(known);
    merge(universe);
    return Verdict::terminated;
  }
  if (known == universe.sources.end() && universe.sources.size() >= kMaxSacnSources) return Verdict::ignored;

  Source& source = universe.sources[data->cid];
  source.last_seen = now;
  source.sequence = data->sequence;
  source.priority = data->priority;
  source.sync_universe = data->sync_universe;
  source.force_sync = data->force_sync;
  // §6.2.4.1, §11: synchronised data waits for its packet. Before the first such packet it acts at once. If these
  // packets stop for 2.5 s, the force-sync bit decides: 1 = go on without, 0 = freeze.
  bool wait = false;
  if (data->sync_universe != 0) {
    const auto sync = last_sync_.find(data->sync_universe);
    wait = sync != last_sync_.end() && !(now - sync->second > kLossTimeout && data->force_sync);
  }
  // A packet with fewer slots leaves the others unchanged.
  Levels& into = wait ? source.held : source.slots;
  if (wait && !source.waiting) source.held = source.slots;
  std::copy(data->slots.begin(), data->slots.end(), into.begin());
  source.waiting = wait;
  source.live = source.live || !wait;
  merge(universe);
  return Verdict::accepted;
}

std::optional<SacnReceiver::Levels> SacnReceiver::levels(int universe, Time now) {
  const auto found = universes_.find(universe);
  if (found == universes_.end()) return std::nullopt;
  forget_lost(found->second, now);
  return found->second.look;
}

std::size_t SacnReceiver::sources(int universe, Time now) {
  const auto found = universes_.find(universe);
  if (found == universes_.end()) return 0;
  forget_lost(found->second, now);
  return found->second.sources.size();
}

void SacnReceiver::forget_lost(Universe& universe, Time now) {
  // Network data loss, §6.7.1. All sources are judged at once, so that sources lost together never hand over to one
  // another.
  const auto gone =
      std::erase_if(universe.sources, [now](const auto& entry) { return now - entry.second.last_seen > kLossTimeout; });
  if (gone > 0) merge(universe);
}

void SacnReceiver::merge(Universe& universe) {
  int highest = -1;
  for (const auto& [cid, source] : universe.sources) {
    if (source.live) highest = std::max(highest, source.priority);
  }
  if (highest < 0) return;  // without sources the last look is held
  Levels look{};
  for (const auto& [cid, source] : universe.sources) {
    if (!source.live || source.priority != highest) continue;
    for (std::size_t slot = 0; slot < look.size(); ++slot) look[slot] = std::max(look[slot], source.slots[slot]);
  }
  universe.look = look;
}

}  // namespace luxrig::sim
