#include "core/transport/shared_tails.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kPlaceKey = 0x7a11, kPathKey = 0x7a12;

/// Mean change, relative to the mean, at which records count as settled: far below their noise.
constexpr double kSettled = 3e-4;

/// A record speaks for its neighbours without a ray up to this share of the shortest leg that its paths found.
constexpr double kClearShare = 0.5;

}  // namespace

std::uint64_t SharedTails::grow(std::span<const Receiver> receivers, std::size_t count, std::uint32_t paths,
                                std::span<const HitPool> pools, int threads, const Watch& watch) {
  const auto first = static_cast<std::uint32_t>(records_.size());
  std::uint64_t rays = add_places(receivers, count, threads);
  const std::size_t added = records_.size() - first;
  std::vector<std::vector<float>> shortest_m(replicates_.size());
  parallel_for(replicates_.size(), threads, [&](std::size_t k) {
    shortest_m[k].assign(added, HUGE_VALF);
    sample(k, first, paths, pools[k], shortest_m[k], watch);
  });
  for (Replicate& replicate : replicates_) rays += std::exchange(replicate.rays, 0);
  for (std::size_t i = 0; i < added; ++i) {
    float clear_m = HUGE_VALF;
    for (const auto& of_replicate : shortest_m) clear_m = std::min(clear_m, of_replicate[i]);
    records_.set_clear_m(first + i, kClearShare * static_cast<double>(clear_m));
  }
  parallel_for(replicates_.size(), threads, [&](std::size_t k) { settle(k); });
  return rays;
}

std::uint64_t SharedTails::add_places(std::span<const Receiver> receivers, std::size_t count, int threads) {
  std::vector<std::optional<TailRecords::Place>> found(count);
  const SobolSequence samples(mixed(seed_, kPlaceKey));
  parallel_for(count, threads, [&](std::size_t i) {
    const Receiver& from = receivers[i % receivers.size()];
    const auto [u, v] = samples.pair(drawn_ + static_cast<std::uint32_t>(i), 0, 0);
    const auto hit =
        scene_.nearest(from.position_world_m, cosine_direction(from.normal_world, u, v), from.normal_world);
    if (!hit) return;
    const Bsdf& bsdf = bsdfs_[scene_.material_index_of(hit->triangle)];
    if (bsdf.matt() && !bsdf.black()) found[i] = TailRecords::Place{hit->position_world_m, hit->normal_world, 0};
  });
  drawn_ += static_cast<std::uint32_t>(count);
  std::vector<TailRecords::Place> places;
  for (const auto& place : found)
    if (place) places.push_back(*place);
  records_.append(places, replicates_.size(), columns_);
  return count;
}

void SharedTails::sample(std::size_t k, std::uint32_t first, std::uint32_t paths, const HitPool& pool,
                         std::vector<float>& shortest_m, const Watch& watch) {
  Replicate& replicate = replicates_[k];
  replicate.heads.resize(records_.size() * columns_);
  PathScratch scratch;
  std::vector<double> values(columns_);
  TailShare share;
  share.records = &records_;
  share.replicate = k;
  share.link = true;
  const std::size_t stretches = pool.hits.size() / PathSampler::kHitsPerPath;
  for (auto record = first; record < records_.size(); ++record) {
    if (watch.stop.stop_requested()) return;
    const TailRecords::Place& place = records_.place(record);
    const SobolSequence samples(mixed(mixed(seed_, kPathKey), mixed(record, k)));
    std::fill(values.begin(), values.end(), 0.0);
    for (std::uint32_t p = 0; p < paths; ++p) {
      const std::size_t hit = (std::size_t{record} * paths + p) % stretches * PathSampler::kHitsPerPath;
      replicate.rays += sampler_.add_path(Receiver{place.position_world_m, place.normal_world}, samples, p, pool, hit,
                                          0, scratch, {values, 3}, &share);
      if (share.linked) replicate.links.push_back({record, *share.linked, (share.per_lux_rgb / paths).cast<float>()});
      shortest_m[record - first] = std::min(shortest_m[record - first], static_cast<float>(scratch.first_leg_m));
    }
    for (std::size_t c = 0; c < columns_; ++c)
      replicate.heads[record * columns_ + c] = static_cast<float>(values[c] / paths);
  }
}

/// Solves E = H + W E by Gauss–Seidel, where H are the heads and W the links. Reflectances below 1 make it converge.
void SharedTails::settle(std::size_t k) {
  const Replicate& replicate = replicates_[k];
  std::vector<float> sum(columns_);
  constexpr int kMostSweeps = 200;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double moved = 0, all = 0;
    std::size_t link = 0;
    for (std::uint32_t record = 0; record < records_.size(); ++record) {
      std::copy_n(replicate.heads.data() + record * columns_, columns_, sum.begin());
      for (; link < replicate.links.size() && replicate.links[link].to == record; ++link) {
        const auto from = records_.values(k, replicate.links[link].from);
        const Vec3f& per_lux = replicate.links[link].per_lux_rgb;
        for (std::size_t c = 0; c < columns_; c += 3)
          for (std::size_t p = 0; p < 3; ++p) sum[c + p] += per_lux[static_cast<Eigen::Index>(p)] * from[c + p];
      }
      const auto values = records_.values(k, record);
      for (std::size_t c = 0; c < columns_; ++c) {
        moved += static_cast<double>(std::abs(sum[c] - values[c]));
        all += static_cast<double>(sum[c]);
        values[c] = sum[c];
      }
    }
    if (moved <= kSettled * all) return;
  }
}

}  // namespace luxrig
