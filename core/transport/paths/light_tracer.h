#pragma once
/// First hits of light traced from the lamps: samples of directly lit surfaces, shared by all receivers.

#include <vector>

#include "core/transport/bsdf.h"
#include "core/transport/direct/emitter_sampler.h"
#include "core/transport/paths/mirror_images.h"
#include "core/transport/sobol.h"

namespace luxrig {

/// The materials of a scene, by RayScene::material_index_of.
[[nodiscard]] std::vector<Bsdf> bsdfs_of(const RayScene& scene);

/// Largest reflectance of its surfaces, by body or coat.
[[nodiscard]] double largest_reflectance(const RayScene& scene);

/// Landing place of a ray from a lamp. flux_rgb is zero if it lands nowhere or on black.
struct LightVertex {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();    ///< on the lit side
  Vec3 to_light_world = Vec3::UnitZ();  ///< unit, towards the source of the light
  Vec3 flux_rgb = Vec3::Zero();         ///< [lm] per sample: the mean over samples is the flux of the group
  Vec3 matt_rgb = Vec3::Zero();         ///< flux_rgb times f of a matt surface
  const Bsdf* bsdf = nullptr;
  std::size_t emitter = 0;
  double density = 0;         ///< of the group's samples here: per m², and per sr for lamps with size
  double choice_density = 0;  ///< with which next-event estimation here would draw the same light
  double in_place = 0;        ///< the same, given its place of lamps
  std::uint32_t plane = MirrorImages::kNoPlane;  ///< that shows images of lamps

  [[nodiscard]] bool shines() const { return bsdf != nullptr && flux_rgb.maxCoeff() > 0; }
};

class LightTracer {
 public:
  LightTracer(const RayScene& scene, const EmitterSampler& lamps, const std::vector<Bsdf>& bsdfs,
              const MirrorImages* images = nullptr)
      : scene_(scene), lamps_(lamps), bsdfs_(bsdfs), images_(images), bounds_world_m_(scene.bounds_world_m()) {}

  /// The hit of one sample of a group of lamps. Adds the rays cast: none if it cannot meet geometry.
  [[nodiscard]] LightVertex trace(std::size_t group, const SobolSequence& samples, std::uint32_t index,
                                  EmitterSampler::Weights& weights, std::uint64_t& rays) const;

 private:
  const RayScene& scene_;
  const EmitterSampler& lamps_;
  const std::vector<Bsdf>& bsdfs_;
  const MirrorImages* images_;
  Eigen::AlignedBox3d bounds_world_m_;
};

}  // namespace luxrig
