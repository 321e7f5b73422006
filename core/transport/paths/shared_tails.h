#pragma once
/// Fills tail records: what receivers see beyond their paths' second vertices, worked out once for all of them.

#include "core/run.h"
#include "core/transport/paths/path_sampler.h"

namespace luxrig {

class SharedTails {
 public:
  SharedTails(const RayScene& scene, const PathSampler& sampler, const std::vector<Bsdf>& bsdfs, std::size_t emitters,
              std::size_t replicates, std::uint64_t seed)
      : scene_(scene), sampler_(sampler), bsdfs_(bsdfs), columns_(3 * emitters), seed_(seed), replicates_(replicates) {}

  /// Adds up to `count` records to each replicate, where first legs of paths from the receivers end, samples each by
  /// `paths` paths (which may end in other records), and settles them with each other. Older records stay as they are.
  /// pools    light hits, one per replicate
  /// plans    by receiver, for `paths` paths; cuts [lx] of connections likewise (PathSampler::join_start)
  /// Returns the rays cast. When stopped, the records are of no use.
  std::uint64_t grow(std::span<const Receiver> receivers, std::size_t count, std::uint32_t paths,
                     std::span<const HitPool> pools, std::span<const HitPlan> plans, std::span<const double> cuts_lx,
                     int threads, const Watch& watch);

  [[nodiscard]] const TailRecords& records(std::size_t replicate) const { return replicates_[replicate].records; }

 private:
  /// One record's light by way of another's.
  struct Link {
    std::uint32_t to, from;
    Vec3f per_lux_rgb;
  };
  struct Replicate {
    TailRecords records;
    std::uint32_t drawn = 0;             ///< first legs so far
    std::vector<std::uint32_t> seen_by;  ///< of records that are being added: the receiver it was found from
    std::vector<float> heads;  ///< likewise, × columns: lux of first reflections, or of paths that found no record
    std::vector<Link> links;   ///< of the records that are being added, by `to`
    std::uint64_t rays = 0;
  };
  void add_places(std::size_t k, std::span<const Receiver> receivers, std::size_t count);
  void sample(std::size_t k, std::uint32_t first, std::uint32_t paths, const HitPool& pool,
              std::span<const HitPlan> plans, std::span<const double> cuts_lx, const Watch& watch);
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
