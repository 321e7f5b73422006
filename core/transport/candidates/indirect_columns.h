#pragma once
/// Reflected light of candidates at all receivers, with its error, read off several importance fields.

#include <memory>

#include "core/transport/candidates/direct_columns.h"
#include "core/transport/candidates/surface_importance.h"

namespace luxrig {

/// Light as it leaves a luminaire: directions and the lumens that each stands for.
struct LeavingRay {
  Vec3 direction_world;
  double lumens;
};

class IndirectColumns {
 public:
  static constexpr std::size_t kReplicates = 8;
  /// Rays of the first replicate after which a candidate may be given up as unlit.
  static constexpr std::uint32_t kFirstRays = 16;

  /// rays_per_replicate   a power of two keeps the samples' strata whole
  IndirectColumns(const RayScene& scene, std::vector<std::unique_ptr<SurfaceImportance>> fields,
                  std::span<const CandidateLuminaire> luminaires, std::uint32_t rays_per_replicate, std::uint64_t seed);

  struct Column {
    std::vector<float> lux;                 ///< per receiver, mean of the replicates
    std::vector<float> standard_error_lux;  ///< of it, widened for so few replicates (replicate_error.h)
    std::uint64_t rays = 0;
    bool given_up = false;

    std::vector<float> replicates;  ///< kReplicates × stride; scratch
  };

  /// Overwrites `column`. may_give_up: nothing is lost if no direct light gets anywhere and the first rays meet no
  /// surface that matters. lamp_world_m: where the luminaire hangs.
  void evaluate(std::size_t luminaire, const Vec3& lamp_world_m, bool may_give_up, Column& column) const;

  [[nodiscard]] const std::vector<std::unique_ptr<SurfaceImportance>>& fields() const { return fields_; }
  [[nodiscard]] std::uint32_t rays_per_replicate() const { return rays_per_replicate_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  const RayScene& scene_;
  std::vector<std::unique_ptr<SurfaceImportance>> fields_;
  std::uint32_t rays_per_replicate_;
  std::vector<std::vector<LeavingRay>> leaving_;  ///< [luminaire · kReplicates + replicate]
};

/// Rays of one luminaire for one replicate.
[[nodiscard]] std::vector<LeavingRay> leaving_rays(const CandidateLuminaire& luminaire, std::uint32_t count,
                                                   std::uint64_t seed);

}  // namespace luxrig
