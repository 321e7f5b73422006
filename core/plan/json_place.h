#pragma once
/// Where a value stands in the text of a JSON document, for messages.

#include <string_view>

namespace luxrig {

struct JsonPlace {
  int line = 0, column = 0;  ///< from 1
};

/// Place of the value that a path such as /tasks/0/lights/3/level leads to, or of the last one on the way that is
/// there. requires well-formed text; for any other it gives some place in it.
[[nodiscard]] JsonPlace place_in_json(std::string_view text, std::string_view path);

}  // namespace luxrig
