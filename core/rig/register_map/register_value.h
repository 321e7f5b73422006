#pragma once
/// Converts between numbers and their registers. Pure.

#include <array>
#include <cstdint>
#include <span>

#include "core/rig/patch.h"

namespace luxrig {

/// Content of one or two registers.
struct RegisterWords {
  std::array<std::uint16_t, 2> word{};
  std::size_t count = 1;  ///< 1 or 2
  bool operator==(const RegisterWords&) const = default;
};

/// Least and largest number that the format can hold (floating: ±the largest float).
[[nodiscard]] std::pair<double, double> register_limits(const RegisterFormat& format);

/// The nearest number that the format can hold; whole formats round. requires value not NaN.
[[nodiscard]] RegisterWords words_of(double value, const RegisterFormat& format);

/// The number in the registers; a floating one may not be finite. requires words.size() == format.registers.
[[nodiscard]] double value_of(std::span<const std::uint16_t> words, const RegisterFormat& format);

}  // namespace luxrig
