#include "drivers/dmx/artnet/artnet_receiver.h"

#include <fmt/format.h>

#include <algorithm>

#include "drivers/dmx/sequence.h"

namespace luxrig::artnet {
namespace {

constexpr std::size_t kMaxSenders = 2, kPortsPerPage = 4;
constexpr std::size_t kMaxPollers = 32;  // more are a flood, not controllers

}  // namespace

Receiver::Receiver(ReceiverSettings settings) : settings_(std::move(settings)) {
  restart();
  for (const auto& entry : ports_) {
    const bool fits = !pages_.empty() && pages_.back().port_addresses.size() < kPortsPerPage &&
                      pages_.back().port_addresses.front() >> 4 == entry.first >> 4;
    if (!fits) pages_.emplace_back();
    pages_.back().port_addresses.push_back(entry.first);
  }
}

void Receiver::restart() {
  ports_.clear();
  polled_.clear();
  for (const int port_address : settings_.port_addresses) ports_[port_address].rule = settings_.rule;
}

Receiver::Verdict Receiver::receive(Time now, const SocketAddress& from, std::span<const std::uint8_t> bytes) {
  if (const auto dmx = decode_dmx(bytes)) return take(now, from.ipv4, *dmx);
  if (is_sync(bytes)) {
    synchronise(now, from.ipv4);
    return Verdict::taken;
  }
  if (const auto poll = decode_poll(bytes)) {
    const bool asked = std::any_of(ports_.begin(), ports_.end(), [&](const auto& entry) {
      return entry.first >= poll->lowest_port_address && entry.first <= poll->highest_port_address;
    });
    if (!asked || (polled_.size() >= kMaxPollers && !polled_.contains(from))) return Verdict::not_for_us;
    polled_.try_emplace(from, now + settings_.reply_delay);
    return Verdict::taken;
  }
  if (const auto address = decode_address(bytes)) {
    obey(*address);
    return Verdict::taken;
  }
  return Verdict::not_for_us;
}

Receiver::Verdict Receiver::take(Time now, std::uint32_t from, const Dmx& packet) {
  const auto found = ports_.find(packet.port_address);
  if (found == ports_.end()) return Verdict::not_for_us;
  Port& port = found->second;
  if (!port.started) port.started = now;
  forget_lost(now, port);
  if (port.cancel_merge) {
    std::erase_if(port.senders, [from](const Sender& known) { return known.ipv4 != from; });
    port.cancel_merge = false;
  }
  auto sender = std::find_if(port.senders.begin(), port.senders.end(),
                             [from](const Sender& known) { return known.ipv4 == from; });
  if (sender == port.senders.end()) {
    if (port.senders.size() >= kMaxSenders) return Verdict::third_sender;
    sender = port.senders.insert(port.senders.end(), Sender{from, now, 0, {}});
    if (port.senders.size() > 1) port.held.reset();  // merging starts, synchronisation ends
  } else if (packet.sequence != 0 && sender->sequence != 0 && is_out_of_order(packet.sequence, sender->sequence)) {
    return Verdict::out_of_order;
  }
  sender->last = now;
  sender->sequence = packet.sequence;
  sender->slots.take(packet.slots, ++tick_);
  ++taken_;
  show(now, port, port.senders.size() == 1 && port.last_sync && now - *port.last_sync <= kSyncLoss);
  return Verdict::taken;
}

void Receiver::show(Time, Port& port, bool hold) {
  std::vector<MergeInput> senders;
  for (const Sender& sender : port.senders) senders.push_back({&sender.slots, 0, nullptr});
  (hold ? port.held.emplace() : port.last.levels) = merge(senders, port.rule);
  if (!hold) port.held.reset();
}

void Receiver::synchronise(Time now, std::uint32_t from) {
  for (auto& [port_address, port] : ports_) {
    forget_lost(now, port);
    // Only the controller whose data a port shows may synchronise it; a merging port is never synchronised.
    if (port.senders.size() != 1 || port.senders[0].ipv4 != from) continue;
    port.last_sync = now;
    if (port.held) port.last.levels = *port.held;
    port.held.reset();
  }
}

void Receiver::obey(const Address& packet) {
  const auto page = static_cast<std::size_t>(std::max(packet.bind_index, 1) - 1);  // 0 and 1 both mean the first
  if (page >= pages_.size()) return;
  const std::vector<int>& on_page = pages_[page].port_addresses;
  if (packet.command == AddressCommand::cancel_merge) {
    for (const int port_address : on_page) ports_[port_address].cancel_merge = true;
  } else if (packet.command != AddressCommand::none && static_cast<std::size_t>(packet.port) < on_page.size()) {
    ports_[on_page[static_cast<std::size_t>(packet.port)]].rule =
        packet.command == AddressCommand::merge_ltp ? MergeRule::ltp : MergeRule::htp;
  }
}

void Receiver::forget_lost(Time now, Port& port) {
  const auto gone =
      std::erase_if(port.senders, [now](const Sender& sender) { return now - sender.last > kSenderLoss; });
  if (gone > 0 && !port.senders.empty()) show(now, port, false);
  if (port.held && port.last_sync && now - *port.last_sync > kSyncLoss) {  // back to immediate output
    port.last.levels = *port.held;
    port.held.reset();
  }
}

HeardUniverse Receiver::heard(Time now, int port_address) {
  const auto found = ports_.find(port_address);
  if (found == ports_.end()) return {};
  Port& port = found->second;
  if (!port.started) port.started = now;
  forget_lost(now, port);
  const bool undecided = port.last.presence == DeskPresence::unknown && now - *port.started < kSlowestRefresh;
  if (!port.senders.empty()) {
    port.last.presence = DeskPresence::present;
    port.last.source = text_of(port.senders[0].ipv4);
    if (port.senders.size() > 1) port.last.source += " and " + text_of(port.senders[1].ipv4);
  } else if (!undecided) {
    port.last.presence = DeskPresence::absent;
  }
  return port.last;
}

std::vector<Receiver::Answer> Receiver::answers_due(Time now) {
  std::vector<Answer> answers;
  for (auto poller = polled_.begin(); poller != polled_.end();) {
    if (poller->second > now) {
      ++poller;
      continue;
    }
    for (std::size_t page = 0; page < pages_.size(); ++page) {
      PollReply reply;
      reply.short_name = settings_.short_name;
      reply.long_name = settings_.long_name;
      reply.report = fmt::format("#0001 [{:04}] ok", taken_ % 10000);
      reply.bind_index = static_cast<int>(std::min<std::size_t>(page + 1, 255));
      reply.mac = settings_.mac;
      for (const int port_address : pages_[page].port_addresses) {
        const Port& port = ports_.at(port_address);
        reply.outputs.push_back(
            {port_address, !port.senders.empty(), port.senders.size() > 1, port.rule == MergeRule::ltp});
      }
      answers.push_back({poller->first, std::move(reply)});
    }
    poller = polled_.erase(poller);
  }
  return answers;
}

}  // namespace luxrig::artnet
