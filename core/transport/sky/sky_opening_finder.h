#pragma once
/// Finds the openings through which the sky is seen from within rooms, without being told of any.

#include <cstdint>

#include "core/run.h"
#include "core/transport/evaluator.h"
#include "core/transport/sky/sky_openings.h"

namespace luxrig {

/// Short paths from the receivers show from where a little of the sky is seen. About some of the rays that reach it the
/// rim of the opening is felt for, which gives planes that it may lie in; the rectangle is kept that explains most rays
/// by the smallest solid angles, then, of those it leaves out, the next.
///
/// Empty when no emitter is a sky, when nothing stands about, or when what is lit sees so much of the sky that there is
/// nothing to gain. What is found depends on scene, receivers and seed only, not on the number of threads.
/// rays   adds those cast: some thousands in the open, up to about 100,000 where openings are small
[[nodiscard]] SkyOpenings find_sky_openings(const RayScene& scene, std::span<const Receiver> receivers,
                                            std::span<const Emitter> emitters, std::uint64_t seed, int threads,
                                            const Watch& watch, std::uint64_t& rays);

}  // namespace luxrig
