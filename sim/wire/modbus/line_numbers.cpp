#include "sim/wire/modbus/line_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace luxrig::sim {
namespace {

// Orders the four bytes (or two) as on the wire: ABCD, CDAB, BADC or DCBA.
void order(std::vector<std::uint8_t>& bytes, const RegisterFormat& format) {
  if (format.low_word_first && bytes.size() == 4) std::rotate(bytes.begin(), bytes.begin() + 2, bytes.end());
  if (!format.low_byte_first) return;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) std::swap(bytes[i], bytes[i + 1]);
}

}  // namespace

std::vector<std::uint16_t> registers_from(double value, const RegisterFormat& format) {
  const std::size_t size = 2 * static_cast<std::size_t>(format.registers);
  std::uint64_t pattern = 0;
  if (format.number == RegisterNumber::floating) {
    const auto single = static_cast<float>(value);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &single, sizeof bits);
    pattern = bits;
  } else {
    const double span = std::exp2(8.0 * static_cast<double>(size));
    const bool is_signed = format.number == RegisterNumber::signed_whole;
    const double whole = std::clamp(std::round(value), is_signed ? -span / 2 : 0, is_signed ? span / 2 - 1 : span - 1);
    pattern = static_cast<std::uint64_t>(static_cast<std::int64_t>(whole));
  }
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = size; i-- > 0;) bytes.push_back(static_cast<std::uint8_t>(pattern >> (8 * i)));
  order(bytes, format);
  std::vector<std::uint16_t> words;
  for (std::size_t i = 0; i < size; i += 2) words.push_back(static_cast<std::uint16_t>(bytes[i] << 8 | bytes[i + 1]));
  return words;
}

double number_from(std::span<const std::uint16_t> words, const RegisterFormat& format) {
  std::vector<std::uint8_t> bytes;
  for (const std::uint16_t word : words) {
    bytes.push_back(static_cast<std::uint8_t>(word >> 8));
    bytes.push_back(static_cast<std::uint8_t>(word & 0xff));
  }
  if (format.low_byte_first) {
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) std::swap(bytes[i], bytes[i + 1]);
  }
  if (format.low_word_first && bytes.size() == 4) std::rotate(bytes.begin(), bytes.begin() + 2, bytes.end());
  std::uint32_t pattern = 0;
  for (const std::uint8_t byte : bytes) pattern = pattern << 8 | byte;
  if (format.number == RegisterNumber::floating) {
    float single = 0;
    std::memcpy(&single, &pattern, sizeof single);
    return static_cast<double>(single);
  }
  if (format.number == RegisterNumber::whole) return pattern;
  const double span = bytes.size() == 2 ? 65536.0 : 4294967296.0;
  return pattern >= span / 2 ? pattern - span : pattern;
}

}  // namespace luxrig::sim
