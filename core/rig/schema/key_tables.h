#pragma once
/// The table of schema.h in parts. Each has the keys of its sections, in the order of the reference.

#include "core/rig/schema.h"

namespace luxrig::schema {

inline constexpr Bounds kAny{};
inline constexpr Bounds kPosition{-1e7, 1e7};  // m, as in map coordinates: 10 000 km from the equator to a pole
inline constexpr Bounds kSize{0, 1e4, true};
inline constexpr Bounds kShare{0, 1};
inline constexpr Bounds kAngle{-3600, 3600};
inline constexpr Bounds kSeconds{0, 3600};
inline constexpr Bounds kRegister{0, 65535};
inline constexpr Bounds kChromaticity{0, 1, true, true};
inline constexpr Bounds kKelvin{1667, 25000};

[[nodiscard]] std::span<const KeySpec> room_keys();
[[nodiscard]] std::span<const KeySpec> fixture_keys();
[[nodiscard]] std::span<const KeySpec> task_keys();
[[nodiscard]] std::span<const KeySpec> control_keys();
[[nodiscard]] std::span<const KeySpec> register_map_keys();
[[nodiscard]] std::span<const KeySpec> scenario_keys();

}  // namespace luxrig::schema
