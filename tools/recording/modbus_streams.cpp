#include "tools/recording/modbus_streams.h"

#include <algorithm>

namespace luxrig::recording {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Messaging on TCP/IP 1.0b, 3.1.3: transaction, protocol 0, length of what follows, unit; then the PDU.
constexpr std::size_t kLengthAt = 4, kUnitAt = 6, kPduAt = 7;
constexpr std::size_t kShortest = 2, kLongestLength = modbus::kLongestAdu - kUnitAt;

std::uint16_t word(Bytes in, std::size_t at) { return static_cast<std::uint16_t>(in[at] << 8 | in[at + 1]); }

/// How far b is behind a, as TCP counts: over the overflow.
std::int32_t distance(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(b - a); }

/// Takes whole frames from the beginning. What cannot be Modbus is dropped: the next segment begins a frame, mostly.
template <class Take>
void take_frames(std::vector<std::uint8_t>& in, const Take& take) {
  std::size_t at = 0;
  while (in.size() - at >= kPduAt) {
    const Bytes rest = Bytes(in).subspan(at);
    const std::size_t length = word(rest, kLengthAt);
    if (word(rest, 2) != 0 || length < kShortest || length > kLongestLength) {
      at = in.size();
      break;
    }
    if (rest.size() < kUnitAt + length) break;
    take(rest.first(kUnitAt + length));
    at += kUnitAt + length;
  }
  in.erase(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(at));
}

}  // namespace

void TcpStream::append(std::uint32_t sequence, Bytes payload) {
  const std::int32_t behind = distance(sequence, *next_);
  if (behind < 0 || static_cast<std::size_t>(behind) >= payload.size()) return;
  payload = payload.subspan(static_cast<std::size_t>(behind));
  in_.insert(in_.end(), payload.begin(), payload.end());
  *next_ += static_cast<std::uint32_t>(payload.size());
}

void TcpStream::take(std::uint32_t sequence, Bytes payload) {
  if (payload.empty()) return;
  if (!next_) next_ = sequence;
  if (distance(*next_, sequence) > 0)
    ahead_.emplace_back(sequence, std::vector<std::uint8_t>(payload.begin(), payload.end()));
  else
    append(sequence, payload);
  std::stable_sort(ahead_.begin(), ahead_.end(),
                   [&](const auto& a, const auto& b) { return distance(*next_, a.first) < distance(*next_, b.first); });
  if (ahead_.size() > kWait) {
    in_.clear();
    next_ = ahead_.front().first;
  }
  std::size_t used = 0;
  for (; used < ahead_.size() && distance(*next_, ahead_[used].first) <= 0; ++used)
    append(ahead_[used].first, ahead_[used].second);
  ahead_.erase(ahead_.begin(), ahead_.begin() + static_cast<std::ptrdiff_t>(used));
}

std::optional<modbus::Request> decode_request(Bytes frame) {
  constexpr std::size_t kFixed = 5;  // function, address, value or count
  if (frame.size() < kPduAt + kFixed) return std::nullopt;
  const Bytes pdu = frame.subspan(kPduAt);
  modbus::Request request;
  request.unit = frame[kUnitAt];
  request.function = static_cast<modbus::Function>(pdu[0]);
  request.first_register = word(pdu, 1);
  const std::size_t count = word(pdu, 3);
  const auto fits = [&](std::size_t most, std::size_t how_many) {
    return how_many >= 1 && how_many <= most && static_cast<std::size_t>(request.first_register) + how_many <= 65536;
  };
  switch (request.function) {
    case modbus::Function::read_coils:
    case modbus::Function::read_discrete:
    case modbus::Function::read_holding:
    case modbus::Function::read_input:
      request.count = count;
      if (pdu.size() != kFixed ||
          !fits(is_of_bits(request.function) ? modbus::kMaxReadBits : modbus::kMaxReadRegisters, count))
        return std::nullopt;
      return request;
    case modbus::Function::write_coil:
    case modbus::Function::write_single:
      if (pdu.size() != kFixed) return std::nullopt;
      request.values = {
          static_cast<std::uint16_t>(request.function == modbus::Function::write_coil ? (count != 0 ? 1 : 0) : count)};
      return request;
    case modbus::Function::write_coils:
    case modbus::Function::write_multiple: {
      const bool bits = request.function == modbus::Function::write_coils;
      const std::size_t bytes = bits ? (count + 7) / 8 : 2 * count;
      if (!fits(bits ? modbus::kMaxWriteCoils : modbus::kMaxWriteRegisters, count) ||
          pdu.size() != kFixed + 1 + bytes || pdu[kFixed] != bytes)
        return std::nullopt;
      for (std::size_t i = 0; i < count; ++i)
        request.values.push_back(bits ? static_cast<std::uint16_t>(pdu[kFixed + 1 + i / 8] >> i % 8 & 1)
                                      : word(pdu, kFixed + 1 + 2 * i));
      return request;
    }
  }
  return std::nullopt;
}

void ModbusStreams::take(Duration at, const TcpSegment& segment, Recording& into) {
  const bool asks = ports_.contains(segment.to.port);
  const auto& client = asks ? segment.from : segment.to;
  const auto& server = asks ? segment.to : segment.from;
  const std::pair key(client, server);
  if (segment.begins) {
    if (const auto old = connections_.find(key); old != connections_.end() && asks) {
      unanswered_ += old->second.waiting.size();
      connections_.erase(old);
    }
  }
  if (segment.payload.empty() && !segment.begins) return;
  if (!connections_.contains(key) && connections_.size() >= kConnections) {
    const auto oldest = std::min_element(connections_.begin(), connections_.end(),
                                         [](const auto& a, const auto& b) { return a.second.used < b.second.used; });
    unanswered_ += oldest->second.waiting.size();
    connections_.erase(oldest);
  }
  Connection& connection = connections_[key];
  connection.used = ++uses_;
  TcpStream& stream = asks ? connection.requests : connection.answers;
  stream.take(segment.sequence, segment.payload);
  take_frames(stream.in(), [&](Bytes frame) {
    if (!asks) return take_answer(at, server, connection, frame, into);
    const auto request = decode_request(frame);
    if (!request) return;
    into.modbus_clients.insert(client.ipv4);
    if (connection.waiting.size() >= kRequests) {
      connection.waiting.erase(connection.waiting.begin());
      ++unanswered_;
    }
    if (!connection.waiting.insert_or_assign(word(frame, 0), *request).second) ++unanswered_;
  });
}

void ModbusStreams::take_answer(Duration at, const SocketAddress& server, Connection& connection, Bytes frame,
                                Recording& into) {
  const std::uint16_t transaction = word(frame, 0);
  const auto found = connection.waiting.find(transaction);
  if (found == connection.waiting.end()) return;
  modbus::Answer answer = modbus::decode(found->second, transaction, frame);
  if (answer.verdict == modbus::Verdict::exception) ++into.modbus_refused;
  if (answer.verdict == modbus::Verdict::garbled) ++unanswered_;
  if (answer.verdict == modbus::Verdict::good)
    into.modbus.push_back({at, server, std::move(found->second), std::move(answer.values)});
  connection.waiting.erase(found);
}

void ModbusStreams::end(Recording& into) const {
  into.modbus_unanswered = unanswered_;
  for (const auto& [key, connection] : connections_) into.modbus_unanswered += connection.waiting.size();
}

}  // namespace luxrig::recording
