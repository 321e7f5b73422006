#pragma once
/// How even the light is on painted surfaces: lowest over mean illuminance (U0 of EN 12464-1).

#include <span>
#include <string>
#include <vector>

#include "core/plan/verdict.h"
#include "core/rig/rig.h"

namespace luxrig {

struct Uniformity {
  std::string surface_goal;  ///< its name
  double wanted = 0;
  double share = 0;          ///< lowest over mean of the best estimates
  double low = 0, high = 0;  ///< it lies between them wherever in their intervals the points lie
  Verdict verdict = Verdict::unknown;
};

/// Of each surface goal that asks for it and has points. The mean is by the area that each point stands for.
/// light   of each point of the rig
[[nodiscard]] std::vector<Uniformity> uniformities(const Rig& rig, std::span<const LuxEstimate> light);

/// "drawing: uniformity 0.62 (0.58 to 0.66), wanted 0.6: unknown"
[[nodiscard]] std::string text_of(const Uniformity& uniformity);

}  // namespace luxrig
