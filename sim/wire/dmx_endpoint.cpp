#include "sim/wire/dmx_endpoint.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <set>

#include "sim/wire/dmx_fixtures.h"

namespace luxrig::sim {
namespace {

constexpr int kMaxPacketsAtOnce = 256;  // per serve(), so that a flood cannot delay the world
constexpr Duration kOvertakenAfter = std::chrono::milliseconds(40);  // the next frame has arrived by then
constexpr std::size_t kMaxArrived = 4096;                            // waiting under the fault `slow`

}  // namespace

std::vector<int> universes_of(const Rig& rig, std::size_t bus) {
  std::set<int> universes;
  for (const Fixture& fixture : rig.fixtures) {
    const auto* patch = std::get_if<DmxPatch>(&fixture.patch);
    if (fixture.bus == bus && patch != nullptr) universes.insert(patch->universe);
  }
  return {universes.begin(), universes.end()};
}

Result<DmxEndpoint::Ear> DmxEndpoint::listen(const EndpointPlace& place, std::span<const std::uint32_t> groups) {
  Ear ear;
  auto own = place.among_others ? share_udp(place.port, place.address) : bind_udp(place.port, place.address);
  if (!own) return tl::unexpected(own.error());
  ear.own = std::move(*own);
  if (!place.among_others) return ear;
  for (const std::uint32_t group : groups) {
    auto joined = join_multicast(ear.own.port, group, place.address);
    if (!joined) return tl::unexpected(joined.error());
    ear.shared.push_back(std::move(*joined));
  }
  auto broadcasts = hear_broadcasts(ear.own.port, place.address);
  if (!broadcasts) return tl::unexpected(broadcasts.error());
  for (Descriptor& descriptor : *broadcasts) ear.shared.push_back(std::move(descriptor));
  return ear;
}

DmxEndpoint::DmxEndpoint(const EndpointParts& parts, EndpointPlace place, std::vector<std::uint32_t> groups, Ear ear)
    : parts_(parts), place_(std::move(place)), groups_(std::move(groups)), ear_(std::move(ear)) {}

void DmxEndpoint::serve(Time now) {
  const std::string& bus = parts_.rig.buses[parts_.bus].name;
  lamp_faults_.obey(parts_.rig, parts_.bus, parts_.faults, parts_.world);
  if (parts_.faults.find(bus, FaultKind::dead)) {
    ear_ = {};
    arrived_.clear();
    overtaken_.clear();
    owed_.clear();
    return;
  }
  if (!ear_.own.descriptor.open()) {
    if (auto again = listen(place_, groups_)) ear_ = std::move(*again);
  }
  take(now, ear_.own.descriptor.get());
  for (const Descriptor& shared : ear_.shared) take(now, shared.get());
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
    // A program that sends from another port may listen on the standard one only. Not to ourselves, where a program
    // of this machine has our address.
    if (place_.among_others && packet.port != place_.port && packet.address != place_.address)
      owed_.push_back({now + answer.late, packet.address, static_cast<std::uint16_t>(place_.port), answer.packet});
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
    ::sendto(ear_.own.descriptor.get(), answer.bytes.data(), answer.bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
             reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  std::erase_if(owed_, [now](const Owed& answer) { return answer.due <= now; });
}

void DmxEndpoint::take(Time now, int descriptor) {
  std::array<std::uint8_t, 2048> buffer;
  for (int i = 0; i < kMaxPacketsAtOnce && descriptor >= 0; ++i) {
    sockaddr_in from{};
    socklen_t from_length = sizeof from;
    const auto received =
        ::recvfrom(descriptor, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &from_length);
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
  if (ear_.own.descriptor.open()) into.push_back(ear_.own.descriptor.get());
  for (const Descriptor& shared : ear_.shared) into.push_back(shared.get());
}

}  // namespace luxrig::sim
