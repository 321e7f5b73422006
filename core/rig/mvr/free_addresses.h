#pragma once
/// DMX slots in use, by universe. Private to core/rig/mvr.

#include <bitset>
#include <map>
#include <optional>

namespace luxrig {

struct UniverseAddress {
  int universe = 1, address = 1;
};

class FreeAddresses {
 public:
  /// Takes the slots if all are free and within 1…512.
  bool take(const UniverseAddress& at, int slots) {
    if (at.address < 1 || at.address - 1 + slots > 512) return false;
    std::bitset<512>& taken = taken_[at.universe];
    for (int i = 0; i < slots; ++i)
      if (taken[static_cast<std::size_t>(at.address - 1 + i)]) return false;
    for (int i = 0; i < slots; ++i) taken.set(static_cast<std::size_t>(at.address - 1 + i));
    return true;
  }

  /// Takes the next free slots after those found before, from `first_universe` on. requires slots ≤ 512
  UniverseAddress take_next(int first_universe, int slots) {
    if (next_.universe < first_universe) next_ = {first_universe, 1};
    while (!take(next_, slots)) {
      if (++next_.address + slots - 1 > 512) next_ = {next_.universe + 1, 1};
    }
    const UniverseAddress found = next_;
    next_.address += slots;
    return found;
  }

 private:
  std::map<int, std::bitset<512>> taken_;
  UniverseAddress next_{0, 1};
};

}  // namespace luxrig
