#include "drivers/dmx/rdm/rdm_discovery.h"

#include <algorithm>

namespace luxrig::rdm {
namespace {

constexpr std::uint8_t kPreamble = 0xFE, kSeparator = 0xAA;
constexpr std::size_t kPreambleSize = 7;
constexpr std::size_t kEncodedUid = 12, kEncodedChecksum = 4;
constexpr std::uint8_t kOdd = 0xAA, kEven = 0x55;
constexpr std::uint64_t kLastUid = 0xFFFFFFFFFFFE;
// A broadcast is not confirmed, and a device that misses it stays muted.
constexpr int kUnMutes = 3;
// One answer lost on the line would end a branch, so silence must be heard twice.
constexpr int kSilences = 2;

void append_encoded(std::vector<std::uint8_t>& bytes, std::uint8_t byte) {
  bytes.push_back(byte | kOdd);
  bytes.push_back(byte | kEven);
}

struct UidRange {
  std::uint64_t lowest = 0, highest = kLastUid;
  [[nodiscard]] bool holds(const Uid& uid) const { return number_of(uid) >= lowest && number_of(uid) <= highest; }
};

/// One search. A range is halved at most 48 times, since a UID has 48 bits.
class Search {
 public:
  Search(DiscoveryLine& line, const DiscoveryLimits& limits) : line_(line), limits_(limits) {}

  Result<DiscoveryResult> run() {
    for (int round = 0; round < limits_.rounds && result_.complete; ++round) {
      const std::size_t before = found_.size();
      for (int i = 0; i < (round == 0 ? kUnMutes : 0); ++i) {
        if (auto asked = line_.un_mute_everybody(); !asked) return tl::unexpected(asked.error());
        ++result_.requests;
      }
      if (auto searched = search(); !searched) return tl::unexpected(searched.error());
      if (found_.size() == before) break;
    }
    result_.found.assign(found_.begin(), found_.end());
    result_.unmutable.assign(unmutable_.begin(), unmutable_.end());
    return result_;
  }

 private:
  enum class Heard { nobody, one, many };
  struct Answer {
    Heard heard = Heard::nobody;
    Uid who;
  };

  [[nodiscard]] bool may_ask() {
    if (result_.requests >= limits_.requests) result_.complete = false;
    return result_.complete;
  }

  Result<void> search() {
    std::vector<UidRange> ranges = {UidRange{}};
    while (!ranges.empty() && may_ask()) {
      const UidRange range = ranges.back();
      ranges.pop_back();
      const auto halve = look_into(range);
      if (!halve) return tl::unexpected(halve.error());
      if (!*halve) continue;
      const std::uint64_t middle = range.lowest + (range.highest - range.lowest) / 2;
      ranges.push_back({middle + 1, range.highest});
      ranges.push_back({range.lowest, middle});
    }
    return {};
  }

  /// Mutes one device after another until the range is silent. True if answers collide: the range must be halved.
  Result<bool> look_into(const UidRange& range) {
    const bool single = range.lowest == range.highest;
    while (may_ask()) {
      const auto answer = ask(range);
      if (!answer) return tl::unexpected(answer.error());
      if (answer->heard == Heard::nobody) return false;
      // For a single UID nothing is left to tell apart, whatever was heard: it confirms or is not there.
      const Uid who = single ? uid_of(range.lowest) : answer->who;
      const bool surely = answer->heard == Heard::one && answer->who == who;
      if (single && found_.contains(who)) {
        if (surely) unmutable_.insert(who);
        return false;
      }
      if (!single && answer->heard == Heard::many) return true;
      // It answers although muted, or does not confirm.
      if (!single && (found_.contains(who) || unconfirmed_.contains(who))) return hides_others(range, who);
      const auto confirmed = mute(who);
      if (!confirmed) return tl::unexpected(confirmed.error());
      if (*confirmed) {
        found_.insert(who);
        if (single) return false;
        continue;
      }
      // Two answers may add up to a valid one. Only for a single UID is it certain which device answered.
      if (single && surely) unmutable_.insert(who);
      if (single) return false;
      unconfirmed_.insert(who);
      return hides_others(range, who);
    }
    return false;
  }

  /// For a device that answers but cannot be muted: true if it may hide others, so the range must be halved. It may
  /// hide them within its own range. Its answer for another range means that no other device answered, and halving that
  /// would never end. The exception: it does not exist, and two answers added up to a valid one. So ask for its UID
  /// alone: a real device answers.
  Result<bool> hides_others(const UidRange& range, const Uid& who) {
    if (range.holds(who)) return true;
    if (everywhere_.contains(who)) return false;
    const auto alone = ask({number_of(who), number_of(who)});
    if (!alone) return tl::unexpected(alone.error());
    if (alone->heard != Heard::one || alone->who != who) return true;
    everywhere_.insert(who);
    return false;
  }

  Result<Answer> ask(const UidRange& range) {
    for (int i = 0; i < kSilences && may_ask(); ++i) {
      ++result_.requests;
      const auto bytes = line_.ask_branch(uid_of(range.lowest), uid_of(range.highest));
      if (!bytes) return tl::unexpected(bytes.error());
      if (bytes->empty()) continue;
      const auto who = decode_branch_answer(*bytes);
      return who && !is_broadcast(*who) ? Answer{Heard::one, *who} : Answer{Heard::many, {}};
    }
    return Answer{};
  }

  Result<bool> mute(const Uid& who) {
    for (int i = 0; i < 1 + limits_.retries && may_ask(); ++i) {
      ++result_.requests;
      auto confirmed = line_.mute(who);
      if (!confirmed || *confirmed) return confirmed;
    }
    return false;
  }

  DiscoveryLine& line_;
  const DiscoveryLimits& limits_;
  DiscoveryResult result_;
  std::set<Uid> found_, unmutable_, unconfirmed_, everywhere_;
};

Packet discovery_request(const Uid& from, std::uint8_t transaction, const Uid& to, Pid pid) {
  Packet packet;
  packet.to = to;
  packet.from = from;
  packet.transaction = transaction;
  packet.command_class = CommandClass::discovery;
  packet.pid = pid;
  return packet;
}

}  // namespace

std::vector<std::uint8_t> encode_branch_answer(const Uid& uid) {
  std::vector<std::uint8_t> bytes(kPreambleSize, kPreamble), plain;
  bytes.push_back(kSeparator);
  append(plain, uid);
  for (const std::uint8_t byte : plain) append_encoded(bytes, byte);
  const std::uint16_t checksum = checksum_of(std::span(bytes).subspan(kPreambleSize + 1));
  append_encoded(bytes, static_cast<std::uint8_t>(checksum >> 8));
  append_encoded(bytes, static_cast<std::uint8_t>(checksum & 0xFF));
  return bytes;
}

std::optional<Uid> decode_branch_answer(std::span<const std::uint8_t> bytes) {
  std::size_t start = 0;
  while (start < bytes.size() && start < kPreambleSize && bytes[start] == kPreamble) ++start;
  if (start >= bytes.size() || bytes[start] != kSeparator) return std::nullopt;
  bytes = bytes.subspan(start + 1);
  if (bytes.size() < kEncodedUid + kEncodedChecksum) return std::nullopt;
  std::array<std::uint8_t, (kEncodedUid + kEncodedChecksum) / 2> plain{};
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const std::uint8_t odd = bytes[2 * i], even = bytes[2 * i + 1];
    if ((odd & kOdd) != kOdd || (even & kEven) != kEven) return std::nullopt;
    plain[i] = odd & even;
  }
  const int checksum = plain[6] << 8 | plain[7];
  if (checksum_of(bytes.first(kEncodedUid)) != checksum) return std::nullopt;
  return uid_from(plain);
}

Packet unique_branch_request(const Uid& from, std::uint8_t transaction, const Uid& lowest, const Uid& highest) {
  Packet packet = discovery_request(from, transaction, kEverybody, Pid::disc_unique_branch);
  append(packet.data, lowest);
  append(packet.data, highest);
  return packet;
}

Packet mute_request(const Uid& from, std::uint8_t transaction, const Uid& who) {
  return discovery_request(from, transaction, who, Pid::disc_mute);
}

Packet un_mute_request(const Uid& from, std::uint8_t transaction) {
  return discovery_request(from, transaction, kEverybody, Pid::disc_un_mute);
}

Result<DiscoveryResult> discover(DiscoveryLine& line, const DiscoveryLimits& limits) {
  return Search(line, limits).run();
}

}  // namespace luxrig::rdm
