#pragma once
/// Fills irradiance records: the light that receivers see beyond their paths' second vertices, computed once for all.

#include "core/run.h"
#include "core/transport/paths/path_sampler.h"

namespace luxrig {

class IrradianceCache {
 public:
  IrradianceCache(const RayScene& scene, const PathSampler& sampler, const std::vector<Bsdf>& bsdfs,
                  std::size_t emitters, std::size_t replicates, std::uint64_t seed)
      : scene_(scene), sampler_(sampler), bsdfs_(bsdfs), columns_(3 * emitters), seed_(seed), replicates_(replicates) {}

  /// Adds up to `count` records to each replicate, at the ends of first legs of paths from the receivers. Samples each
  /// with `paths` paths (which may end in other records), and settles them with each other. Older records stay
  /// unchanged.
  /// pools    light vertices, one per replicate
  /// plans    by receiver, for `paths` paths; cuts [lx] of connections likewise (PathSampler::join_start)
  /// Returns the rays cast. When stopped, the records are unusable.
  std::uint64_t grow(std::span<const Receiver> receivers, std::size_t count, std::uint32_t paths,
                     std::span<const LightVertexPool> pools, std::span<const LightVertexPlan> plans,
                     std::span<const double> cuts_lx, int threads, const Watch& watch);

  [[nodiscard]] const IrradianceRecords& records(std::size_t replicate) const { return replicates_[replicate].records; }

 private:
  /// Light of one record that comes through another.
  struct Link {
    std::uint32_t to, from;
    Vec3f per_lux_rgb;
  };
  struct Replicate {
    IrradianceRecords records;
    std::uint32_t drawn = 0;             ///< first legs so far
    std::vector<std::uint32_t> seen_by;  ///< per new record: the receiver it was found from
    std::vector<float> heads;  ///< per new record, × columns: lux of first reflections, or of paths without a record
    std::vector<Link> links;   ///< of the new records, by `to`
    std::uint64_t rays = 0;
  };
  void add_places(std::size_t k, std::span<const Receiver> receivers, std::size_t count);
  void sample(std::size_t k, std::uint32_t first, std::uint32_t paths, const LightVertexPool& pool,
              std::span<const LightVertexPlan> plans, std::span<const double> cuts_lx, const Watch& watch);
  void settle(std::size_t k, std::uint32_t first);
  void blend(std::size_t k);

  const RayScene& scene_;
  const PathSampler& sampler_;
  const std::vector<Bsdf>& bsdfs_;
  std::size_t columns_;
  std::uint64_t seed_;
  std::vector<Replicate> replicates_;
};

}  // namespace luxrig
