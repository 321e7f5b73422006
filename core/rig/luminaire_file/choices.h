#pragma once
/// Which of several parts of a luminaire file is meant: the one that a key of the rig file names, or the only one.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

struct Choice {
  std::string name;
  std::string description;  ///< may be empty
};

/// Index of the choice, by its name, or by its description when only one has it. Else a problem without a place: which
/// there are, and the key that chooses. `kind`: "variant", "emitter". requires choices
[[nodiscard]] tl::expected<std::size_t, Problem> choose(const std::vector<Choice>& choices,
                                                        const std::optional<std::string>& wanted, std::string_view kind,
                                                        std::string_view key);

}  // namespace luxrig
