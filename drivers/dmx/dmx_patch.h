#pragma once
/// Maps the fixtures of one bus to DMX slots.
///
/// Drives and joint angles in, whole 512-slot universes out. Short packets are not sent, as DMX512-A receivers keep the
/// slots that a short packet leaves out. A 16-bit value is encoded once, so its two bytes always go in the same frame.

#include <array>
#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/output/devices.h"
#include "core/rig/rig.h"

namespace luxrig {

inline constexpr std::size_t kDmxSlots = 512;
using DmxSlots = std::array<std::uint8_t, kDmxSlots>;  ///< [0] is address 1

/// Shortest period of a full universe in E1.11: break 92 µs + mark 12 µs + 513 slots · 44 µs.
inline constexpr Duration kDmxShortestPeriod = std::chrono::microseconds(22676);
/// Luxrig's frame period: 44 frames a second.
inline constexpr Duration kDmxWritePeriod = std::chrono::nanoseconds(22727273);

struct DmxUniverse {
  int number = 0;  ///< as patched
  DmxSlots slots{};
};

/// value 0…1 as the nearest whole number of 1…3 bytes: of 0…255, 0…65535 or 0…16777215.
[[nodiscard]] std::uint32_t encode_dmx(double value, int bytes);

/// Share 0…1 of a joint's travel: the inverse of angle = from + v/65535·(to − from), clamped to the travel.
[[nodiscard]] double share_of_travel(double angle_rad, double from_rad, double to_rad);

class DmxPatchbay {
 public:
  /// requires the patch to be checked (check_dmx_patch). Every fixture starts dark; heads start at the rig file's aim.
  DmxPatchbay(const Rig& rig, std::size_t bus);

  /// All or nothing: Cause::invalid names the fixture and the error in its value.
  Result<void> set_levels(std::span<const LevelCommand> commands);
  /// The same for heads; takes effect with the next set_levels. Angles may pass the range by 1e-6 rad (rounding).
  Result<void> set_aims(std::span<const AimCommand> commands);

  /// Every universe that a fixture of the bus uses, in ascending order.
  [[nodiscard]] std::span<const DmxUniverse> universes() const { return universes_; }
  /// The slots of a universe that this bus's fixtures use and send, as 1; index as in universes().
  [[nodiscard]] DmxSlots used_slots(std::size_t universe) const;
  /// Fixtures of a universe, ascending; index as in universes().
  [[nodiscard]] std::vector<std::size_t> fixtures_of(std::size_t universe) const;
  /// The effect that these slots, sent by a desk, would have on the fixtures. Leaves out a fixture whose dimmer is not
  /// `given`, and joints with a missing part. The inverse of universes(), to half a step.
  [[nodiscard]] std::vector<DeskCommand> decode(std::size_t universe, const DmxSlots& slots,
                                                const std::bitset<kDmxSlots>& given) const;
  [[nodiscard]] bool has_heads() const { return has_heads_; }

 private:
  struct Entry {
    std::string name;
    DmxPatch patch;
    JointRange range;
    bool moves = false;
    std::vector<int> bytes;    ///< by slot: number of bytes in its value
    std::size_t universe = 0;  ///< index in universes_
    double drive = 0;
    Joints joints;
  };
  void encode(const Entry& entry);
  [[nodiscard]] static std::optional<double> share_in_cell(const Entry& entry, std::size_t coarse_slot,
                                                           const DmxSlots& slots, const std::bitset<kDmxSlots>& given);
  [[nodiscard]] Fault invalid(std::size_t fixture, std::string detail) const;

  std::string bus_;
  std::map<std::size_t, Entry> entries_;  ///< by fixture index in the rig
  std::vector<DmxUniverse> universes_;
  bool has_heads_ = false;
};

/// Problems of the fixtures and meters on a DMX bus: a Modbus patch, a luxmeter, a universe outside the range given,
/// a fixture that runs past slot 512.
[[nodiscard]] std::vector<Problem> check_dmx_patch(const Rig& rig, std::size_t bus, int lowest_universe,
                                                   int highest_universe);

}  // namespace luxrig
