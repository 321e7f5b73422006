#pragma once
/// Painted goals in the rig's folder, written so that the rig can be read at any instant.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/result.h"
#include "core/rig/brief.h"

namespace luxrig {

/// save_painting(), but with the files as they were before if the rig cannot be read with them (Cause::invalid).
[[nodiscard]] Result<void> save_if_readable(const std::filesystem::path& rig_file, const SurfaceGoalSpec& goal,
                                            const std::string& strokes, std::span<const Point> points);

/// Adds a [[surface_goal]] without strokes at the end of the rig file, as a person would; all else in it stays. The result
/// is read before it replaces the file. Refused (Cause::invalid) if the rig cannot be read with it.
[[nodiscard]] Result<SurfaceGoalSpec> add_surface_goal(const std::filesystem::path& rig_file, const std::string& name,
                                                       const std::optional<double>& max_lx);

}  // namespace luxrig
