#pragma once
/// A Rig as transport sees it: what shines and what is lit.

#include <span>
#include <vector>

#include "core/rig/rig.h"
#include "core/transport/evaluator.h"

namespace luxrig {

/// A luminaire hung and aimed so: at its rated flux, with its shape, colour, and its TILT factor at that pose. Planner
/// and simulated truth both make their emitters here.
/// beam_rad   of its zoom; 0: as its luminaire states
[[nodiscard]] Emitter emitter_of(const Luminaire& luminaire, const Pose& world_from_lamp, double beam_rad = 0);

/// One emitter per fixture, in the rig's order, at the luminaire's rated flux, with its shape, its colour, and its TILT
/// factor at that aim. Column j of a TransportMatrix is then fixture j, and a level of 1 its rated flux.
/// joints   where fixtures look, one per fixture; empty: as the rig file says
[[nodiscard]] std::vector<Emitter> emitters_of(const Rig& rig, std::span<const Joints> joints = {});

/// Sky and sun as separate emitters (Emitter::sky), those of them that shine: none without daylight. A clear or general
/// sky whose sun is below the horizon is taken with the sun on it.
[[nodiscard]] std::vector<Emitter> daylight_emitters_of(const Rig& rig);

/// emitters_of(rig, joints), then daylight_emitters_of(rig): columns from fixtures.size() on are daylight, at level 1.
[[nodiscard]] std::vector<Emitter> all_emitters_of(const Rig& rig, std::span<const Joints> joints = {});

/// Of a transport of all_emitters_of(rig): levels of all its columns, when the fixtures have these.
[[nodiscard]] Eigen::VectorXd levels_with_daylight(const TransportMatrix& transport, const Eigen::VectorXd& levels);

/// Of such a transport: what daylight alone gives each receiver [lx]; zeros without any.
[[nodiscard]] Eigen::VectorXd daylight_lux(const Rig& rig, const TransportMatrix& transport);

/// The rig's points, in order, then its luxmeters, in order: row p is points[p], and row
/// points.size() + m is luxmeters[m] (also for a luxmeter that stands at a point).
[[nodiscard]] std::vector<Receiver> receivers_of(const Rig& rig);

/// The floor of errors (EvaluateOptions) that a rig's goals ask for: a tenth of its smallest goal or limit above 0;
/// without any, a tenth of the receivers' mean illuminance. What a point gets below that is told less closely.
void set_error_floor(const Rig& rig, EvaluateOptions& options);

}  // namespace luxrig
