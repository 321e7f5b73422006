#pragma once
/// Chooses one of several parts of a luminaire file: the one named by a key of the rig file, or the only one.

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

/// Index of the choice with that name, or with that description if only one has it. Otherwise a problem without a
/// place, which lists the choices and the key that selects one. `kind`: "variant", "emitter". requires choices
[[nodiscard]] tl::expected<std::size_t, Problem> choose(const std::vector<Choice>& choices,
                                                        const std::optional<std::string>& wanted, std::string_view kind,
                                                        std::string_view key);

}  // namespace luxrig
