#pragma once
/// Addresses in use on each bus, so that no two devices share a DMX slot, a Modbus register or a CANopen node.

#include <map>
#include <string>
#include <vector>

#include "core/rig/patch.h"
#include "core/rig/problem_list.h"
#include "core/rig/register_map/register_map.h"

namespace luxrig {

class PatchMap {
 public:
  struct Owner {
    std::string name;  ///< as printed in messages: fixture "spot-1"
    FilePosition in_file;  ///< of its address
  };
  /// requires 1 ≤ first, first + count - 1 ≤ 512
  void claim_slots(std::size_t bus, int universe, int first, int count, Owner owner);
  void claim_registers(std::size_t bus, int unit, RegisterTable table, int first, int count, Owner owner);
  void claim_node(std::size_t bus, int node, Owner owner);

  /// Reports each claim that overlaps an earlier one, naming both and, for DMX, a free address. Cost: proportional to
  /// the slots and registers claimed.
  void report(const std::vector<Bus>& buses, ProblemList& problems) const;

 private:
  struct Claim {
    int first, count;
    Owner owner;
  };
  struct Registers {
    std::size_t bus;
    int unit;
    RegisterTable table;
    auto operator<=>(const Registers&) const = default;
  };
  std::map<std::pair<std::size_t, int>, std::vector<Claim>> slots_;  ///< by bus and universe
  std::map<Registers, std::vector<Claim>> registers_;
  std::map<std::pair<std::size_t, int>, std::vector<Owner>> nodes_;  ///< by bus and node
};

}  // namespace luxrig
