#pragma once
/// Numbers in a device's registers.

#include <cstdint>
#include <span>
#include <vector>

#include "core/rig/patch.h"

namespace luxrig::sim {

/// Whole numbers are clamped to the format's range. requires value not NaN.
[[nodiscard]] std::vector<std::uint16_t> registers_from(double value, const RegisterFormat& format);
/// requires as many words as the format has.
[[nodiscard]] double number_from(std::span<const std::uint16_t> words, const RegisterFormat& format);

}  // namespace luxrig::sim
