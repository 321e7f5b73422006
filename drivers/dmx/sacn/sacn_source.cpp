#include "drivers/dmx/sacn/sacn_source.h"

namespace luxrig::sacn {
namespace {

// Clause 6.6.2: three packets of unchanged data, then one every 800…1000 ms. 880 ms leaves both ends room for a late
// cycle of 44 Hz.
constexpr int kRepeatsAfterChange = 3;
constexpr Duration kKeepAlive = std::chrono::milliseconds(880);

// A receiver that still knows our component identifier drops a packet whose sequence number is 0…19 behind the last
// one it heard (clause 6.7.2), and some hold that memory for ever. A restarted source does not know that number. One
// jump of 20 after its first packet gets past it, whatever it was: if the first is 0…19 behind, the second is ahead.
constexpr std::uint8_t kPastTheDropWindow = 20;

std::uint64_t hash(std::string_view text, std::uint64_t state) {
  for (const char letter : text) {  // FNV-1a
    state ^= static_cast<std::uint8_t>(letter);
    state *= 0x100000001b3ULL;
  }
  state ^= 0xFF;  // the end of a part: ("ab", "c") is not ("a", "bc")
  return state * 0x100000001b3ULL;
}

std::uint64_t mix(std::uint64_t x) {  // splitmix64's finaliser: FNV alone leaves the high bits thin
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

}  // namespace

Cid derive_cid(std::string_view host, std::string_view rig, std::string_view bus) {
  Cid cid{};
  for (std::size_t half = 0; half < 2; ++half) {
    std::uint64_t state = half == 0 ? 0xcbf29ce484222325ULL : 0x9ae16a3b2f90404fULL;
    for (const std::string_view part : {std::string_view("luxrig sacn"), host, rig, bus}) state = hash(part, state);
    state = mix(state);
    for (std::size_t i = 0; i < 8; ++i) cid[half * 8 + i] = static_cast<std::uint8_t>(state >> (56 - 8 * i));
  }
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

std::vector<std::uint8_t> Source::next_packet(int universe, Stream& stream, bool terminated) {
  DataPacket packet;
  packet.cid = settings_.cid;
  packet.source_name = settings_.source_name;
  packet.priority = static_cast<std::uint8_t>(settings_.priority);
  packet.sequence = stream.sequence;
  packet.terminated = terminated;
  packet.universe = static_cast<std::uint16_t>(universe);
  packet.slots.assign(stream.slots.begin(), stream.slots.end());
  stream.sequence = static_cast<std::uint8_t>(stream.sequence + (stream.packets == 0 ? kPastTheDropWindow : 1));
  ++stream.packets;
  return encode(packet);
}

std::optional<std::vector<std::uint8_t>> Source::due(Time now, int universe, const DmxSlots& slots) {
  Stream& stream = streams_[universe];
  if (!stream.sending || slots != stream.slots) {
    stream.repeats_left = 1 + kRepeatsAfterChange;
    stream.slots = slots;
    stream.sending = true;
  }
  const bool wanted = settings_.continuous || stream.repeats_left > 0 || now - stream.last >= kKeepAlive;
  if (!wanted || !stream.rate.take(now)) return std::nullopt;
  if (stream.repeats_left > 0) --stream.repeats_left;
  stream.last = now;
  return next_packet(universe, stream, false);
}

std::optional<std::vector<std::uint8_t>> Source::goodbye(int universe) {
  const auto found = streams_.find(universe);
  if (found == streams_.end() || !found->second.sending) return std::nullopt;
  return next_packet(universe, found->second, true);
}

void Source::rest() {
  for (auto& [universe, stream] : streams_) stream.sending = false;
}

}  // namespace luxrig::sacn
