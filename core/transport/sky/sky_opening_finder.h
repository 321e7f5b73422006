#pragma once
/// Finds the openings through which the sky is seen from within rooms, from geometry alone.

#include <cstdint>

#include "core/run.h"
#include "core/transport/evaluator.h"
#include "core/transport/sky/sky_openings.h"

namespace luxrig {

/// Short paths from the receivers find places from which a little of the sky is seen. Around some of the rays that
/// reach it, the rim of the opening is probed, which gives candidate planes. The rectangle that explains most rays with
/// the smallest solid angles is kept, then the next for the remaining rays.
///
/// Empty if no emitter is a sky, the scene is empty, or the lit surfaces see so much of the sky that there is nothing
/// to gain. The result depends on scene, receivers and seed only, not on the number of threads.
/// rays   adds those cast: some thousands in the open, up to about 100,000 with small openings
[[nodiscard]] SkyOpenings find_sky_openings(const RayScene& scene, std::span<const Receiver> receivers,
                                            std::span<const Emitter> emitters, std::uint64_t seed, int threads,
                                            const Watch& watch, std::uint64_t& rays);

}  // namespace luxrig
