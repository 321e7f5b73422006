#pragma once
/// The scene as a lamp sees it: where its light first falls (thesis §3.2.1, "reflective shadow map"). Sampled by
/// direction with low discrepancy instead of rendered.

#include <cstdint>
#include <span>
#include <vector>

#include "core/scene/ray_scene.h"
#include "core/transport/evaluator.h"
#include "core/transport/sobol.h"

namespace luxrig {

/// A share of an emitter's flux at its first surface.
struct LightViewHit {
  Vec3 position_world_m;
  Vec3 normal_world;  ///< unit, on the lit side
  std::uint32_t triangle;
  double flux_lm;  ///< arriving flux, at level 1
};

struct LightView {
  std::vector<LightViewHit> hits;  ///< of light that hits a surface; in the order of the samples
  std::uint64_t rays = 0;
};

/// The light of one emitter by the first `count` points of `samples`. Unbiased: the mean sum of flux_lm near a place is
/// the flux that falls there. Equal emitters give equal hits for equal samples. The light of a sky starts all over a
/// disk as wide as the scene, so few samples find a small window.
[[nodiscard]] LightView light_view(const RayScene& scene, const Emitter& emitter, const SobolSequence& samples,
                                   std::uint32_t count);

/// The reflectance that the cache uses, by linear Rec. 709 primary, all of it diffuse. A coat counts as a diffuse
/// surface with its reflectance at normal incidence, over the body. That is exact if no gloss sends light towards a
/// receiver at the expense of other directions, which the cache cannot know.
[[nodiscard]] Vec3 diffuse_equivalent_rgb(const Material& material);

}  // namespace luxrig
