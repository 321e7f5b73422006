#pragma once
/// A Rig as transport sees it: what shines and what is lit.

#include <vector>

#include "core/rig/rig.h"
#include "core/transport/evaluator.h"

namespace luxrig {

/// One emitter per fixture, in the rig's order, at the luminaire's rated flux and aimed as the rig file says; with the
/// luminaire's shape and colour, and its TILT factor at that aim.
/// Column j of a TransportMatrix is then fixture j, and a level of 1 its rated flux.
[[nodiscard]] std::vector<Emitter> emitters_of(const Rig& rig);

/// Sky and sun as separate emitters (Emitter::sky), those of them that shine: none without daylight. A clear or general
/// sky whose sun is below the horizon is taken with the sun on it.
[[nodiscard]] std::vector<Emitter> daylight_emitters_of(const Rig& rig);

/// The rig's points, in order, then its luxmeters, in order: row p is points[p], and row
/// points.size() + m is luxmeters[m] (also for a luxmeter that stands at a point).
[[nodiscard]] std::vector<Receiver> receivers_of(const Rig& rig);

}  // namespace luxrig
