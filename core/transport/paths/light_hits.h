#pragma once
/// First hits of light traced from the lamps: samples of the surfaces that are lit directly, which all receivers share.

#include <vector>

#include "core/transport/bsdf.h"
#include "core/transport/direct/lamps.h"
#include "core/transport/paths/mirror_images.h"
#include "core/transport/sobol.h"

namespace luxrig {

/// The materials of a scene, by RayScene::material_index_of.
[[nodiscard]] std::vector<Bsdf> bsdfs_of(const RayScene& scene);

/// Most that any of its surfaces reflects, by body or coat.
[[nodiscard]] double largest_reflectance(const RayScene& scene);

/// Where a ray from a lamp lands. flux_rgb is zero when it lands nowhere or on black.
struct LightHit {
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();    ///< on the lit side
  Vec3 to_light_world = Vec3::UnitZ();  ///< unit, where the light came from
  Vec3 flux_rgb = Vec3::Zero();         ///< [lm] per sample: the mean over samples is the flux of the group
  Vec3 matt_rgb = Vec3::Zero();         ///< flux_rgb times f of a matt surface
  const Bsdf* bsdf = nullptr;
  std::size_t emitter = 0;
  double density = 0;         ///< with which the group's samples fall here: per m², and per sr for what has size
  double choice_density = 0;  ///< with which next-event estimation here would ask for the same light
  double in_place = 0;        ///< the same, had its place of lamps been chosen
  std::uint32_t plane = MirrorImages::kNoPlane;  ///< that shows images of lamps

  [[nodiscard]] bool shines() const { return bsdf != nullptr && flux_rgb.maxCoeff() > 0; }
};

class LightHits {
 public:
  LightHits(const RayScene& scene, const Lamps& lamps, const std::vector<Bsdf>& bsdfs,
            const MirrorImages* images = nullptr)
      : scene_(scene), lamps_(lamps), bsdfs_(bsdfs), images_(images), bounds_world_m_(scene.bounds_world_m()) {}

  /// The hit of one sample of a group of lamps. Adds the rays it cost: none when it can meet no geometry.
  [[nodiscard]] LightHit trace(std::size_t group, const SobolSequence& samples, std::uint32_t index,
                               Lamps::Weights& weights, std::uint64_t& rays) const;

 private:
  const RayScene& scene_;
  const Lamps& lamps_;
  const std::vector<Bsdf>& bsdfs_;
  const MirrorImages* images_;
  Eigen::AlignedBox3d bounds_world_m_;
};

}  // namespace luxrig
