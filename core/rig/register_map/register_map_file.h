#pragma once
/// Register maps as files: TOML, the keys of [device], [[register]] and [[setup]] in rigs/REFERENCE.md.

#include <filesystem>
#include <string_view>

#include "core/result.h"
#include "core/rig/register_map/register_map.h"

namespace luxrig {

/// `file` is for problems only.
[[nodiscard]] Checked<RegisterMap> parse_register_map(std::string_view text, const std::string& file);
[[nodiscard]] Checked<RegisterMap> load_register_map(const std::filesystem::path& path);

}  // namespace luxrig
