#include "sim/devices/rdm_line.h"

#include <algorithm>

namespace luxrig::sim {

RdmResponder& RdmLine::add(std::string name, RdmIdentity identity) {
  members_.push_back({std::move(name), std::make_unique<RdmResponder>(std::move(identity))});
  return *members_.back().responder;
}

bool RdmLine::dead(const Member& member) const {
  return faults_.find(member.name, FaultKind::dead) || faults_.find(member.name, FaultKind::unpowered) ||
         faults_.find(member.name, FaultKind::silent);
}

RdmLine::Answer RdmLine::exchange(Time now, std::span<const std::uint8_t> packet) {
  Answer together;
  ++exchanges_;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = members_[i];
    const bool has_power = !faults_.find(member.name, FaultKind::unpowered);
    if (has_power && !member.had_power) member.responder->power_up();
    member.had_power = has_power;
    if (!has_power || faults_.find(member.name, FaultKind::dead)) continue;  // it does not receive either
    std::vector<std::uint8_t> bytes = member.responder->receive(now, packet);
    // One number per exchange and member, so that losses on a line are independent.
    const Disturbance disturbance = faults_.disturbance({&member.name, 1}, exchanges_ * 512 + i);
    if (bytes.empty() || disturbance.silent) continue;
    if (disturbance.garbled) {
      const std::size_t at = disturbance.random % bytes.size();
      bytes[at] ^= static_cast<std::uint8_t>(1 + disturbance.random / bytes.size() % 255);
    }
    together.late = std::max(together.late, disturbance.delay);
    if (together.bytes.size() < bytes.size()) together.bytes.resize(bytes.size(), 0);
    for (std::size_t b = 0; b < bytes.size(); ++b) together.bytes[b] |= bytes[b];
  }
  return together;
}

std::vector<std::uint64_t> RdmLine::reachable() const {
  std::vector<std::uint64_t> uids;
  for (const Member& member : members_) {
    if (!dead(member)) uids.push_back(member.responder->uid());
  }
  std::sort(uids.begin(), uids.end());
  return uids;
}

}  // namespace luxrig::sim
