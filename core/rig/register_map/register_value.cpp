#include "core/rig/register_map/register_value.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/check.h"

namespace luxrig {
namespace {

std::uint16_t bytes_swapped(std::uint16_t word) { return static_cast<std::uint16_t>(word << 8 | word >> 8); }

}  // namespace

std::pair<double, double> register_limits(const RegisterFormat& format) {
  if (format.number == RegisterNumber::floating) {
    const double most = std::numeric_limits<float>::max();
    return {-most, most};
  }
  const double counts = format.registers == 1 ? 65536.0 : 4294967296.0;
  if (format.number == RegisterNumber::signed_whole) return {-counts / 2, counts / 2 - 1};
  return {0, counts - 1};
}

RegisterWords words_of(double value, const RegisterFormat& format) {
  LUXRIG_CHECK(!std::isnan(value), "NaN for a register");
  const auto [least, most] = register_limits(format);
  const double clamped = std::clamp(value, least, most);
  const std::uint32_t bits = format.number == RegisterNumber::floating
                                 ? std::bit_cast<std::uint32_t>(static_cast<float>(clamped))
                                 : static_cast<std::uint32_t>(std::llround(clamped));
  RegisterWords words;
  words.count = static_cast<std::size_t>(format.registers);
  if (words.count == 1) {
    words.word[0] = static_cast<std::uint16_t>(bits);
  } else {
    words.word[format.low_word_first ? 1 : 0] = static_cast<std::uint16_t>(bits >> 16);
    words.word[format.low_word_first ? 0 : 1] = static_cast<std::uint16_t>(bits);
  }
  if (format.low_byte_first) {
    for (std::uint16_t& word : words.word) word = bytes_swapped(word);
  }
  return words;
}

double value_of(std::span<const std::uint16_t> words, const RegisterFormat& format) {
  LUXRIG_CHECK(words.size() == static_cast<std::size_t>(format.registers) && (words.size() == 1 || words.size() == 2),
               "{} registers, {} expected", words.size(), format.registers);
  const auto word = [&](std::size_t i) -> std::uint32_t {
    return format.low_byte_first ? bytes_swapped(words[i]) : words[i];
  };
  if (words.size() == 1) {
    if (format.number == RegisterNumber::signed_whole) return static_cast<std::int16_t>(word(0));
    return word(0);
  }
  const std::uint32_t bits = format.low_word_first ? word(1) << 16 | word(0) : word(0) << 16 | word(1);
  switch (format.number) {
    case RegisterNumber::floating:
      return std::bit_cast<float>(bits);
    case RegisterNumber::signed_whole:
      return static_cast<std::int32_t>(bits);
    case RegisterNumber::whole:
      break;
  }
  return bits;
}

}  // namespace luxrig
