#include "drivers/dmx/sacn/sacn_receiver.h"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/dmx/sequence.h"

namespace luxrig::sacn {
namespace {

// Bounds memory: more are a flood of forged packets, not a rig.
constexpr std::size_t kMaxSources = 16, kMaxSyncUniverses = 64;

/// Names come from the network and go into reports: no control characters.
std::string printable(std::string text) {
  for (char& letter : text) {
    if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F) letter = '?';
  }
  return text;
}

}  // namespace

Receiver::Receiver(ReceiverSettings settings) : settings_(std::move(settings)) { restart(); }

void Receiver::restart() {
  universes_.clear();
  syncs_.clear();
  groups_.clear();
  for (const int universe : settings_.universes) {
    universes_[universe];
    groups_.insert(universe);
  }
}

Receiver::Verdict Receiver::receive(Time now, std::span<const std::uint8_t> bytes) {
  if (const auto packet = decode(bytes)) return take_data(now, *packet);
  if (const auto packet = decode_sync(bytes)) return take_sync(now, *packet);
  return Verdict::not_sacn;
}

Receiver::Verdict Receiver::take_sync(Time now, const SyncPacket& packet) {
  if (!syncs_.contains(packet.sync_universe) && syncs_.size() >= kMaxSyncUniverses) return Verdict::ignored;
  Sync& sync = syncs_[packet.sync_universe];
  const auto known = sync.sequence.find(packet.cid);
  if (known != sync.sequence.end() && now - sync.last <= kSourceLoss &&
      is_out_of_order(packet.sequence, known->second)) {
    return Verdict::out_of_order;
  }
  if (known == sync.sequence.end() && sync.sequence.size() >= kMaxSources) sync.sequence.clear();
  sync.sequence[packet.cid] = packet.sequence;
  sync.last = now;
  for (auto& [number, universe] : universes_) {
    for (auto& [cid, source] : universe.sources) {
      if (!source.held || source.sync_universe != packet.sync_universe) continue;
      source.slots = *source.held;
      source.held.reset();
      source.shown = true;
    }
  }
  return Verdict::taken;
}

Receiver::Verdict Receiver::take_data(Time now, const DataPacket& packet) {
  const auto found = universes_.find(packet.universe);
  if (found == universes_.end() || packet.cid == settings_.own) return Verdict::ignored;
  if (packet.preview) return Verdict::preview;  // 6.2.6: never to live outputs
  if (packet.start_code != kLevels && packet.start_code != kSlotPriority) return Verdict::ignored;
  if (packet.priority < settings_.lowest_priority) return Verdict::ignored;
  Universe& universe = found->second;
  if (!universe.started) universe.started = now;
  // Losses are judged after all arrived packets are read (heard). A late reader must not declare a source lost whose
  // packets wait behind another's.
  const auto known = universe.sources.find(packet.cid);
  if (known == universe.sources.end() && (packet.terminated || universe.sources.size() >= kMaxSources)) {
    return packet.terminated ? Verdict::terminated : Verdict::ignored;
  }
  const bool is_new = known == universe.sources.end();
  Source& source = is_new ? universe.sources[packet.cid] : known->second;
  if (is_new) source.first = source.last = now;
  if (source.lost) {  // back before its loss has counted: treated as new, with new sequence numbers (6.7.1)
    source.lost.reset();
    source.levels_sequence.reset();
    source.priorities_sequence.reset();
  }
  auto& sequence = packet.start_code == kLevels ? source.levels_sequence : source.priorities_sequence;
  if (sequence && is_out_of_order(packet.sequence, *sequence)) return Verdict::out_of_order;  // 6.7.2
  sequence = packet.sequence;
  if (packet.terminated) {  // 6.2.6: levels in it are not used, the source is gone at once
    universe.sources.erase(packet.cid);
    return Verdict::terminated;
  }
  source.name = printable(packet.source_name);
  source.priority = packet.priority;
  if (packet.start_code == kSlotPriority) {
    source.slot_priority = {};
    std::copy(packet.slots.begin(), packet.slots.end(), source.slot_priority.begin());
    source.slot_priority_at = now;
  } else {
    take_levels(now, source, packet);
  }
  return Verdict::taken;
}

void Receiver::take_levels(Time now, Source& source, const DataPacket& packet) {
  source.last = now;
  source.sync_universe = packet.sync_universe;
  source.force_sync = packet.force_sync;
  if (packet.sync_universe != 0 && groups_.size() < universes_.size() + kMaxSyncUniverses) {
    groups_.insert(packet.sync_universe);
  }
  ++tick_;
  if (synchronised(now, source)) {
    if (!source.held) source.held = source.slots;
    source.held->take(packet.slots, tick_);
  } else {
    if (source.held) source.slots = *source.held;
    source.held.reset();
    source.slots.take(packet.slots, tick_);
    source.shown = true;
  }
}

/// 6.2.4.1, 11.1: before the first synchronisation packet data acts at once. If these packets stop for 2.5 s, the
/// force-sync bit decides: 1 = go on without, 0 = freeze.
bool Receiver::synchronised(Time now, const Source& source) const {
  if (source.sync_universe == 0) return false;
  const auto sync = syncs_.find(source.sync_universe);
  if (sync == syncs_.end()) return false;
  return now - sync->second.last <= kSourceLoss || !source.force_sync;
}

void Receiver::forget_lost(Time now, Universe& universe) {
  auto& sources = universe.sources;
  for (auto& [cid, source] : sources) {
    if (!source.lost && now - source.last > kSourceLoss) source.lost = source.last + kSourceLoss;  // 6.7.1
    if (source.held && !synchronised(now, source)) {
      source.slots = *source.held;
      source.held.reset();
      source.shown = true;
    }
  }
  // Judge all sources before removing any, so that sources lost together never hand over to one another.
  std::vector<Cid> gone;
  for (const auto& [cid, source] : sources) {
    if (!source.lost) continue;
    const Time lost = *source.lost;
    const bool certain = std::all_of(sources.begin(), sources.end(),
                                     [&](const auto& other) { return other.second.lost || other.second.last > lost; });
    if (certain) gone.push_back(cid);
  }
  for (const Cid& cid : gone) sources.erase(cid);
}

HeardUniverse Receiver::heard(Time now, int number) {
  const auto found = universes_.find(number);
  if (found == universes_.end()) return {};
  Universe& universe = found->second;
  if (!universe.started) universe.started = now;
  forget_lost(now, universe);
  std::vector<MergeInput> senders;
  const Source* first = nullptr;
  const Duration listened = now - *universe.started;
  bool sampling = false;
  for (const auto& [cid, source] : universe.sources) {
    const bool tells = source.slot_priority_at && now - *source.slot_priority_at <= kSourceLoss;
    if (!source.slot_priority_at && now - source.first < kSamplingPeriod) {
      sampling = true;
      continue;
    }
    if (!source.shown) continue;
    senders.push_back({&source.slots, source.priority, tells ? &source.slot_priority : nullptr});
    if (first == nullptr || source.priority > first->priority) first = &source;
  }
  if (listened < kSamplingPeriod) return universe.last;
  if (senders.empty()) {
    // A source may be about to count: reporting "absent" would light its lamps.
    const bool may_be_there = listened < kSourceLoss || (sampling && listened < kSourceLoss + kSamplingPeriod);
    if (universe.last.presence != DeskPresence::unknown || !may_be_there) universe.last.presence = DeskPresence::absent;
    return universe.last;
  }
  universe.last.presence = DeskPresence::present;
  universe.last.levels = merge(senders, settings_.rule);
  universe.last.source = first->name;
  if (senders.size() > 1) universe.last.source += fmt::format(" and {} more", senders.size() - 1);
  return universe.last;
}

std::size_t Receiver::sources(Time now, int number) {
  const auto found = universes_.find(number);
  if (found == universes_.end()) return 0;
  forget_lost(now, found->second);
  return found->second.sources.size();
}

}  // namespace luxrig::sacn
