#pragma once
/// Reflected light of candidates at all receivers, with its error, from several importance fields.
///
/// A candidate's rays are drawn by two strategies, weighted by the balance heuristic: half by the luminaire's
/// intensity, half towards important surfaces that pilot rays from nearby found (direction_guide.h).

#include <memory>

#include "core/transport/candidates/direct_columns.h"
#include "core/transport/candidates/reflected/direction_guide.h"
#include "core/transport/candidates/reflected/surface_importance.h"

namespace luxrig {

class IndirectColumns {
 public:
  static constexpr std::size_t kReplicates = 8;
  /// Rays of the first replicate after which a candidate may be rejected as unlit.
  static constexpr std::uint32_t kFirstRays = 16;

  /// flatness_error   relative; added to the replicates' spread
  IndirectColumns(const RayScene& scene, std::vector<std::unique_ptr<SurfaceImportance>> fields, double flatness_error,
                  std::uint64_t seed);

  /// Important directions for lamps at or near some places. Adds the rays cast to `rays`.
  [[nodiscard]] DirectionGuide guide(const CandidateLuminaire& luminaire, std::span<const Vec3> lamps_world_m,
                                     std::uint64_t& rays) const;

  /// Rays of a candidate.
  struct Rays {
    std::uint32_t per_replicate;  ///< of both strategies together; an even number
    std::uint64_t key;            ///< candidates with different keys err independently, except for the fields
    bool may_give_up;             ///< stop after a few rays if these and the pilot rays met no useful surface
  };
  /// One replicate. The fields are large, so do one replicate for many candidates before the next.
  /// lux   overwritten: stride() floats. Returns the rays cast.
  std::uint64_t evaluate(std::size_t replicate, const CandidateLuminaire& luminaire, const Vec3& lamp_world_m,
                         const DirectionGuide& guide, const Rays& rays, std::span<float> lux) const;
  /// All replicates, in sequence.
  std::uint64_t evaluate(const CandidateLuminaire& luminaire, const Vec3& lamp_world_m, const DirectionGuide& guide,
                         const Rays& rays, std::span<float> replicates) const;

  /// Mean of the replicates, and its standard error, widened for their small number (replicate_error.h).
  /// further_squared_lux2   per receiver, or empty: square of other errors
  void summarise(std::span<const float> replicates, std::span<const float> further_squared_lux2, std::span<float> lux,
                 std::span<float> standard_error_lux) const;

  /// Number of receivers, rounded up: the length of a replicate.
  [[nodiscard]] std::size_t stride() const { return fields_.front()->stride(); }
  [[nodiscard]] std::vector<std::unique_ptr<SurfaceImportance>>& fields() { return fields_; }
  [[nodiscard]] const std::vector<std::unique_ptr<SurfaceImportance>>& fields() const { return fields_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Met {
    std::uint32_t row;  ///< of the field; SurfaceImportance::kNoRow = no important surface
    double reflectance;
  };
  [[nodiscard]] Met meet(const SurfaceImportance& field, const Vec3& from_world_m, const Vec3& direction,
                         std::uint64_t& rays) const;

  const RayScene& scene_;
  std::vector<std::unique_ptr<SurfaceImportance>> fields_;
  double flatness_error_;
  std::uint64_t seed_;
};

}  // namespace luxrig
