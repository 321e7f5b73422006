#pragma once
/// A list of strokes as a file, which a person can read, compare and edit: JSON, a stroke on each line.

#include "core/goals/stroke.h"

namespace luxrig {

/// {"luxrig_painting": 1, "strokes": [{"kind": "brush", "lux": 300, "radius_m": 0.4, "falloff": 0.5,
///  "path": [{"position": [x, y, z], "normal": [x, y, z]}, …]}, …]}
/// in world coordinates. Numbers are written such that they are read as the same. Numbers must be finite.
[[nodiscard]] std::string painting_to_json(std::span<const Stroke> strokes);

/// Refuses text that is not such a file, and strokes that are not as stroke.h says. All problems, with their places.
[[nodiscard]] Checked<std::vector<Stroke>> painting_from_json(const std::string& text, const std::string& file_name);

}  // namespace luxrig
