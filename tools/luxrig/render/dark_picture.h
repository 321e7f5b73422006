#pragma once
/// Why a picture is dark.

#include <span>
#include <string>

#include "core/picture/picture.h"
#include "core/rig/rig.h"

namespace luxrig {

/// Empty if something in view gets 0.1 lx or more. Else a sentence or two: nothing is in view; no lamp is on; or for
/// the lamps that are on: they are blocked, they shine past everything, or they light things outside the view (from 64
/// rays of each lamp's light).
/// emitters   the rig's fixtures in order, then its daylight; levels one per emitter
/// when_set   names these levels in the sentence: "in plan.json"
[[nodiscard]] std::string why_dark(const Picture& picture, const RayScene& scene, const Rig& rig,
                                   std::span<const Emitter> emitters, std::span<const double> levels,
                                   const std::string& when_set);

}  // namespace luxrig
