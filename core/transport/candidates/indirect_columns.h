#pragma once
/// Reflected light of candidates at all receivers, with its error, read off several importance fields.
///
/// A candidate's rays are drawn by two strategies, weighted by the balance heuristic: half by the luminaire's
/// intensity, half where pilot rays from about there found surfaces that matter (direction_guide.h).

#include <array>
#include <memory>

#include "core/transport/candidates/direct_columns.h"
#include "core/transport/candidates/direction_guide.h"
#include "core/transport/candidates/surface_importance.h"

namespace luxrig {

/// A luminaire's rays for all replicates, made once for all places where it hangs.
struct LuminaireRays {
  /// A direction drawn by the luminaire's intensity.
  struct Leaving {
    Vec3 direction_world;
    double candela;
    double density_per_sr;
  };
  CandidateLuminaire luminaire;
  std::vector<std::vector<Leaving>> leaving;               ///< per replicate
  std::vector<std::vector<std::array<double, 2>>> guided;  ///< points of the unit square, per replicate; as many
};

class IndirectColumns {
 public:
  static constexpr std::size_t kReplicates = 8;
  /// Rays of the first replicate after which a candidate may be given up as unlit.
  static constexpr std::uint32_t kFirstRays = 16;

  /// flatness_error   relative; added to what the replicates show
  IndirectColumns(const RayScene& scene, std::vector<std::unique_ptr<SurfaceImportance>> fields, double flatness_error,
                  std::uint64_t seed);

  /// rays_per_replicate   of both strategies together, even
  [[nodiscard]] LuminaireRays prepare(const CandidateLuminaire& luminaire, std::uint32_t rays_per_replicate) const;

  /// What is worth looking at from about some places. Adds the rays cast to `rays`.
  [[nodiscard]] DirectionGuide guide(const CandidateLuminaire& luminaire, std::span<const Vec3> lamps_world_m,
                                     std::uint64_t& rays) const;

  struct Column {
    std::vector<float> lux;                 ///< per receiver (and some zeros), mean of the replicates
    std::vector<float> standard_error_lux;  ///< of it, widened for so few replicates (replicate_error.h)
    std::uint64_t rays = 0;
    bool given_up = false;

    std::vector<float> replicates;                    ///< kReplicates × stride
    std::vector<WeightedRow> met_cells, met_patches;  ///< scratch
  };

  /// Overwrites `column`.
  /// lamp_world_m   where the luminaire hangs
  /// may_give_up    stop after a few rays if they and the pilot rays met no surface that matters
  void evaluate(const LuminaireRays& luminaire, const Vec3& lamp_world_m, const DirectionGuide& guide, bool may_give_up,
                Column& column) const;

  [[nodiscard]] std::vector<std::unique_ptr<SurfaceImportance>>& fields() { return fields_; }
  [[nodiscard]] const std::vector<std::unique_ptr<SurfaceImportance>>& fields() const { return fields_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Met {
    std::uint32_t cell;  ///< SurfaceCells::kNone: nothing that matters
    double reflectance;
  };
  [[nodiscard]] Met meet(const SurfaceImportance& field, const Vec3& lamp_world_m, double off_lamp_m,
                         const Vec3& direction, std::uint64_t& rays) const;

  const RayScene& scene_;
  std::vector<std::unique_ptr<SurfaceImportance>> fields_;
  double flatness_error_;
  std::uint64_t seed_;
};

}  // namespace luxrig
