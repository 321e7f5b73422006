#pragma once
/// A rig as large as a museum's, as a rig file, to measure `luxrig solve` on.

#include <string>

namespace luxrig {

/// An exhibition hall of aisles between partition walls with works on them. Each wall has a track of spots, each aimed
/// at a work nearby; spots also reach the neighbouring works. Every fifth work is a drawing with a limit of 50 lx. The
/// others want 120 to 300 lx, a few 1200 lx, which is more than their spots can give. Scene and photometry are in the
/// file, so it needs no other file.
[[nodiscard]] std::string aisles_rig_text(int fixtures, int points);

}  // namespace luxrig
