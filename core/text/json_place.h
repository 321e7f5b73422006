#pragma once
/// Line and column of a value in a JSON text, for messages.

#include <string_view>

namespace luxrig {

struct JsonPlace {
  int line = 0, column = 0;  ///< from 1
};

/// Place of the value at a path such as /tasks/0/lights/3/level, or of the last existing value along it. requires
/// well-formed text; for any other text, it is some place in it.
[[nodiscard]] JsonPlace place_in_json(std::string_view text, std::string_view path);

}  // namespace luxrig
