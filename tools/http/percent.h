#pragma once
/// Percent-encoding in addresses.

#include <optional>
#include <string>
#include <string_view>

namespace luxrig {

/// Nothing if it is not validly encoded. plus_is_space: as in a query.
[[nodiscard]] std::optional<std::string> percent_decoded(std::string_view text, bool plus_is_space);

}  // namespace luxrig
