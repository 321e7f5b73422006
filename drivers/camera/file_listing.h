#pragma once
/// Picture files of a [[camera]] with source = "files", and the facts in their names.

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// Files of a folder, or files whose names match the last part of the path as a pattern (* and ?). Sorted by name;
/// numbers in names sort by value. Cause::network if the folder does not exist or no file matches.
[[nodiscard]] Result<std::vector<std::filesystem::path>> picture_files(const std::filesystem::path& folder_or_pattern);

/// "wall_12.5ms_3.png" -> 0.0125. Empty if the name has no "…ms" or "…s" on its own.
[[nodiscard]] std::optional<double> exposure_in_name(std::string_view name);

}  // namespace luxrig
