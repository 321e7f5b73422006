#pragma once
/// Pixels of an Open Fixture Library matrix. Private to core/rig/personality.

#include <string>
#include <vector>

#include "core/rig/personality/ofl/ofl_json.h"

namespace luxrig {

inline constexpr std::size_t kMaxPixels = 4096;

struct OflMatrix {
  struct Pixel {
    std::string key;
    int x = 0, y = 0, z = 0;
  };
  std::vector<Pixel> pixels;  ///< x fastest, then y, then z
  std::vector<std::string> groups;
  std::vector<std::string> whole;  ///< groups of all pixels
  bool too_large = false;

  [[nodiscard]] bool has(std::string_view key) const;
  /// The keys selected by `repeatFor` ("eachPixelABC", "eachPixelXYZ", …, "eachPixelGroup"); none for any other word.
  [[nodiscard]] std::vector<std::string> order(std::string_view repeat_for) const;
};

[[nodiscard]] OflMatrix read_ofl_matrix(const OflJson& matrix);

}  // namespace luxrig
