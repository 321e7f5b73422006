#pragma once
/// "Did you mean …?": the known name nearest to what a person wrote.

#include <span>
#include <string>
#include <string_view>

namespace luxrig {

/// The first known name that goes on with _ where `wanted` ends (a unit left off); else the one with the smallest edit
/// distance (insert, delete, replace, swap of neighbours; upper and lower case, and - and _ count as the same letter),
/// the first on a tie; empty when none is near (more than a third of the letters differ, at least two being allowed).
[[nodiscard]] std::string_view nearest_name(std::string_view wanted, std::span<const std::string_view> known);

/// For the mend of an unknown name: `did you mean "lumens"?`, else `known: a, b, c` (at most twelve of them), else
/// `otherwise` when nothing is known.
[[nodiscard]] std::string mend_for_unknown(std::string_view wanted, std::span<const std::string_view> known,
                                           std::string_view otherwise);

}  // namespace luxrig
