#pragma once
/// The emitters and receivers of a Rig.

#include <span>
#include <vector>

#include "core/rig/rig.h"
#include "core/transport/evaluator.h"

namespace luxrig {

/// A luminaire at this pose: its rated flux, shape and colour, and its TILT factor there. Planner and simulated truth
/// both make their emitters here.
/// beam_rad   of its zoom; 0 = as stated by its luminaire
[[nodiscard]] Emitter emitter_of(const Luminaire& luminaire, const Pose& world_from_lamp, double beam_rad = 0);

/// One emitter per fixture, in the rig's order, as by emitter_of at its aim. Column j of a TransportMatrix is then
/// fixture j, and a level of 1 its rated flux.
/// joints   aims, one per fixture; empty = as in the rig file
[[nodiscard]] std::vector<Emitter> emitters_of(const Rig& rig, std::span<const Joints> joints = {});

/// Sky and sun as separate emitters (Emitter::sky), only those that shine; none without daylight. A clear or general
/// sky whose sun is below the horizon is taken with the sun on it.
[[nodiscard]] std::vector<Emitter> daylight_emitters_of(const Rig& rig);

/// emitters_of(rig, joints), then daylight_emitters_of(rig): columns from fixtures.size() on are daylight, at level 1.
[[nodiscard]] std::vector<Emitter> all_emitters_of(const Rig& rig, std::span<const Joints> joints = {});

/// For a transport of all_emitters_of(rig): levels of all its columns, from the fixtures' levels.
[[nodiscard]] Eigen::VectorXd levels_with_daylight(const TransportMatrix& transport, const Eigen::VectorXd& levels);

/// For such a transport: illuminance by daylight alone at each receiver [lx]; zeros without daylight.
[[nodiscard]] Eigen::VectorXd daylight_lux(const Rig& rig, const TransportMatrix& transport);

/// The rig's points, in order, then its luxmeters, in order: row p is points[p], and row points.size() + m is
/// luxmeters[m] (also for a luxmeter at a point).
[[nodiscard]] std::vector<Receiver> receivers_of(const Rig& rig);

/// The floor of errors (EvaluateOptions) for a rig's goals: a tenth of its smallest goal or limit above 0; without any,
/// a tenth of the receivers' mean illuminance. Light below the floor is computed less exactly.
void set_error_floor(const Rig& rig, EvaluateOptions& options);

}  // namespace luxrig
