#pragma once
/// The rig file (TOML) -> Rig. Every key is documented in rigs/REFERENCE.md.

#include <filesystem>
#include <string_view>

#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

/// Reads, checks and completes a rig: every problem in the file is reported, with its line and column
/// (unknown keys with the nearest known one). Loads the photometric files; checks that mesh files
/// exist, but does not read them (scene_builder.h does). `path` may be a folder with a rig.toml in it.
/// Driver names and bus options are the drivers' to check (drivers/registry.h).
[[nodiscard]] Checked<Rig> load_rig(const std::filesystem::path& path);

/// The same from text; files beside it are looked up in `folder`.
[[nodiscard]] Checked<Rig> parse_rig(std::string_view text, const std::filesystem::path& file,
                                     const std::filesystem::path& folder);

}  // namespace luxrig
