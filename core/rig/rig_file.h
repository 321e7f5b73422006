#pragma once
/// The rig file (TOML) -> Rig. Every key is documented in rigs/REFERENCE.md.

#include <filesystem>
#include <string_view>

#include "core/result.h"
#include "core/rig/rig.h"

namespace luxrig {

/// Points of [[surface_goal]]s: refused if they are not there, or are of other strokes; or left out, for whoever is about
/// to lay them out anew.
enum class PaintedPoints { read, left_out };

/// Reads, checks and completes a rig. Reports every problem in the file with its line and column (and the nearest known
/// key for an unknown one). Loads the photometric files. Checks that mesh files exist, but does not read them
/// (scene_builder.h does). `path` may be a folder with a rig.toml in it. Driver names and bus options are checked by
/// the drivers (drivers/registry.h).
[[nodiscard]] Checked<Rig> load_rig(const std::filesystem::path& path, PaintedPoints painted = PaintedPoints::read);

/// The same from text. Relative paths start at `folder`.
[[nodiscard]] Checked<Rig> parse_rig(std::string_view text, const std::filesystem::path& file,
                                     const std::filesystem::path& folder, PaintedPoints painted = PaintedPoints::read);

}  // namespace luxrig
