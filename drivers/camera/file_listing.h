#pragma once
/// Which picture files a [[camera]] with source = "files" has, and what their names say.

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace luxrig {

/// Files of a folder, or those beside the path that its last part fits as a pattern (* and ?), by name; numbers in
/// names count by their value. Cause::network when the folder is not there or none fits.
[[nodiscard]] Result<std::vector<std::filesystem::path>> picture_files(const std::filesystem::path& folder_or_pattern);

/// "wall_12.5ms_3.png": 0.0125. Nothing when the name has no "…ms" or "…s" that stands alone.
[[nodiscard]] std::optional<double> exposure_in_name(std::string_view name);

}  // namespace luxrig
