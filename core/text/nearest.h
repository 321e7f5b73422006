#pragma once
/// "Did you mean …?": the known name nearest to what a person wrote.

#include <span>
#include <string>
#include <string_view>

namespace luxrig {

/// The first known name that continues with _ after `wanted` (a unit was omitted). Otherwise the name with the smallest
/// edit distance (insert, delete, replace, swap of neighbours; ignoring case, and the difference of - and _); the first
/// on a tie. Empty if none is near (at most a third of the letters may differ, or two).
[[nodiscard]] std::string_view nearest_name(std::string_view wanted, std::span<const std::string_view> known);

/// For the mend of an unknown name: `did you mean "lumens"?`, else `known: a, b, c` (at most twelve), else `otherwise`
/// if there are no known names.
[[nodiscard]] std::string mend_for_unknown(std::string_view wanted, std::span<const std::string_view> known,
                                           std::string_view otherwise);

}  // namespace luxrig
