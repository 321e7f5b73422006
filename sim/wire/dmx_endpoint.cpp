#include "sim/wire/dmx_endpoint.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

#include "sim/wire/dmx_fixtures.h"

namespace luxrig::sim {
namespace {

constexpr int kMaxPacketsAtOnce = 256;  // per serve(), so that a flood cannot delay the world
constexpr Duration kOvertakenAfter = std::chrono::milliseconds(40);  // the next frame has arrived by then
constexpr std::size_t kMaxArrived = 4096;                            // waiting under the fault `slow`

}  // namespace

DmxEndpoint::DmxEndpoint(const EndpointParts& parts, BoundSocket socket)
    : parts_(parts), socket_(std::move(socket)), port_(socket_.port) {}

void DmxEndpoint::serve(Time now) {
  const std::string& bus = parts_.rig.buses[parts_.bus].name;
  lamp_faults_.obey(parts_.rig, parts_.bus, parts_.faults, parts_.world);
  if (parts_.faults.find(bus, FaultKind::dead)) {
    socket_.descriptor.reset();
    arrived_.clear();
    overtaken_.clear();
    owed_.clear();
    return;
  }
  if (!socket_.descriptor.open()) {
    if (auto again = bind_udp(port_)) socket_ = std::move(*again);
  }
  take(now);
  bool any = false;
  while (!arrived_.empty() && arrived_.front().due <= now) {
    const Arrived packet = std::move(arrived_.front());
    arrived_.pop_front();
    any = true;
    obey(now, packet);
  }
  const auto later =
      std::stable_partition(overtaken_.begin(), overtaken_.end(), [now](const Arrived& p) { return p.due <= now; });
  for (auto packet = overtaken_.begin(); packet != later; ++packet) {
    any = true;
    obey(now, *packet);
  }
  overtaken_.erase(overtaken_.begin(), later);
  send_owed(now);
  if (any)
    obey_dmx(
        parts_, ++frames_, [&](int universe) { return levels(universe, now); },
        [this](std::size_t f) { return moved_by(f); });
}

void DmxEndpoint::obey(Time now, const Arrived& packet) {
  for (Answer& answer : receive(now, packet.address, packet.bytes)) {
    if (owed_.size() >= kMaxArrived) break;
    owed_.push_back({now + answer.late, packet.address, packet.port, std::move(answer.packet)});
  }
}

void DmxEndpoint::send_owed(Time now) {
  for (const Owed& answer : owed_) {
    if (answer.due > now) continue;
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(answer.address);
    to.sin_port = htons(answer.port);
    ::sendto(socket_.descriptor.get(), answer.bytes.data(), answer.bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
             reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  std::erase_if(owed_, [now](const Owed& answer) { return answer.due <= now; });
}

void DmxEndpoint::take(Time now) {
  std::array<std::uint8_t, 2048> buffer;
  for (int i = 0; i < kMaxPacketsAtOnce && socket_.descriptor.open(); ++i) {
    sockaddr_in from{};
    socklen_t from_length = sizeof from;
    const auto received = ::recvfrom(socket_.descriptor.get(), buffer.data(), buffer.size(), 0,
                                     reinterpret_cast<sockaddr*>(&from), &from_length);
    if (received < 0) {
      if (errno == EINTR || errno == ECONNREFUSED) continue;  // one of our answers met a closed port: ignore it
      break;
    }
    const Disturbance disturbance = parts_.faults.disturbance({&parts_.rig.buses[parts_.bus].name, 1}, packets_++);
    if (disturbance.silent || arrived_.size() >= kMaxArrived) continue;
    Packet bytes(buffer.begin(), buffer.begin() + received);
    // UDP has its own checksum, so the fault imitates a broken sender: it changes the header.
    if (disturbance.garbled && !bytes.empty())
      bytes[disturbance.random % std::min<std::size_t>(bytes.size(), 8)] ^= 0xff;
    Time due = now + disturbance.delay;
    Arrived packet{due, ntohl(from.sin_addr.s_addr), ntohs(from.sin_port), std::move(bytes)};
    if (disturbance.reordered && overtaken_.size() < kMaxArrived) {
      packet.due += kOvertakenAfter;
      overtaken_.push_back(std::move(packet));
      continue;
    }
    if (!arrived_.empty()) packet.due = std::max(due, arrived_.back().due);
    if (disturbance.duplicated) arrived_.push_back(packet);
    arrived_.push_back(std::move(packet));
  }
}

void DmxEndpoint::descriptors(std::vector<int>& into) const {
  if (socket_.descriptor.open()) into.push_back(socket_.descriptor.get());
}

}  // namespace luxrig::sim
