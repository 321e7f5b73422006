#pragma once
/// A painted goal's two files beside the rig file: its strokes, and the points that follow from them.

#include <span>
#include <string>
#include <vector>

#include "core/goals/stroke.h"
#include "core/result.h"
#include "core/rig/brief.h"

namespace luxrig {

/// The strokes in the goal's file; none if there is no file.
[[nodiscard]] Checked<std::vector<Stroke>> strokes_of(const SurfaceGoalSpec& goal);

/// Writes both files. A program that is killed, or a power cut, leaves the strokes and points from before or these, and
/// a rig that can be read. strokes: as painting_to_json() has them.
[[nodiscard]] Result<void> save_painting(const SurfaceGoalSpec& goal, const std::string& strokes,
                                         std::span<const Point> points);
/// Writes the points of the strokes that are in the file.
[[nodiscard]] Result<void> save_points(const SurfaceGoalSpec& goal, std::span<const Point> points);

}  // namespace luxrig
