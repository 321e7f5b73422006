#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// "12 ab" -> {0x12, 0xab}; blanks are skipped.
inline std::vector<std::uint8_t> from_hex(std::string_view text) {
  std::vector<std::uint8_t> out;
  std::string pair;
  for (const char letter : text) {
    if (letter == ' ') continue;
    pair += letter;
    if (pair.size() < 2) continue;
    out.push_back(static_cast<std::uint8_t>(std::stoi(pair, nullptr, 16)));
    pair.clear();
  }
  return out;
}
