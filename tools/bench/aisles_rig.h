#pragma once
/// A rig as large as a museum's, as a rig file: what `luxrig solve` is measured on.

#include <string>

namespace luxrig {

/// An exhibition hall of aisles between partition walls, on which works hang; along each wall a track of spots, each
/// aimed at a work near it. Every fifth work is a drawing that may have 50 lx, the others want 120 to 300, a few 1200,
/// which is more than their spots have; spots reach the works beside their own. Scene and photometry are in the file
/// itself, so it needs nothing but its own text.
[[nodiscard]] std::string aisles_rig_text(int fixtures, int points);

}  // namespace luxrig
