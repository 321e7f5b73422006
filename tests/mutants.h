#pragma once
/// Damaged copies of a good file, for readers that must refuse or read any input.

#include <algorithm>
#include <string>

#include "tests/random.h"

namespace luxrig {

/// Damages the text one to eight times: changes a byte; cuts out, doubles or moves a piece; replaces a number; or cuts
/// off the end.
inline std::string mutant_of(std::string text, Random& random) {
  static const char* const kNumbers[] = {"0", "-1", "1e308", "-1e308", "nan", "inf", "99999999999", "1,5", "0x10", ""};
  for (std::size_t times = 1 + random.below(8); times > 0 && !text.empty(); --times) {
    const std::size_t at = random.below(text.size());
    const std::size_t size = std::min(text.size() - at, 1 + random.below(40));
    switch (random.below(6)) {
      case 0:
        text[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        text.erase(at, size);
        break;
      case 2:
        text.insert(random.below(text.size()), text.substr(at, size));
        break;
      case 3: {
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        text.replace(digit, std::min(text.find_first_not_of("0123456789.", digit), text.size()) - digit,
                     kNumbers[random.below(std::size(kNumbers))]);
        break;
      }
      case 4:
        text[at] = static_cast<char>(text[at] ^ (1 << random.below(8)));
        break;
      default:
        if (random.below(4) == 0) text.resize(at);
    }
  }
  return text;
}

}  // namespace luxrig
