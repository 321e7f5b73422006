#include "core/transport/paths/irradiance_cache.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kTailPlaceKey = 0x7a11, kPathKey = 0x7a12, kHitKey = 0x7a13, kCutKey = 0x7a14;

/// Mean relative change at which records count as settled: far below their noise.
constexpr double kSettled = 3e-4;

/// One place in this many is a leg farther from the receivers, where the records' own paths end.
constexpr std::size_t kFartherPlaces = 3;

/// A record represents its neighbours without a ray up to this share of the shortest leg of its paths.
constexpr double kClearShare = 0.25;

/// Records are averaged without a ray up to this share of that distance, as more and farther records take part.
constexpr double kBlendClear = 0.4;

}  // namespace

std::uint64_t IrradianceCache::grow(std::span<const Receiver> receivers, std::size_t count, std::uint32_t paths,
                                    std::span<const LightVertexPool> pools, std::span<const LightVertexPlan> plans,
                                    std::span<const double> cuts_lx, int threads, const Watch& watch) {
  parallel_for(replicates_.size(), threads, [&](std::size_t k) {
    const auto first = static_cast<std::uint32_t>(replicates_[k].records.size());
    add_places(k, receivers, count);
    sample(k, first, paths, pools[k], plans, cuts_lx, watch);
    settle(k, first);
    blend(k);
  });
  std::uint64_t rays = 0;
  for (Replicate& replicate : replicates_) rays += std::exchange(replicate.rays, 0);
  return rays;
}

void IrradianceCache::add_places(std::size_t k, std::span<const Receiver> receivers, std::size_t count) {
  Replicate& replicate = replicates_[k];
  const SobolSequence samples(mixed(mixed(seed_, kTailPlaceKey), k));
  std::vector<IrradianceRecords::Vertex> places;
  replicate.seen_by.clear();
  for (std::size_t i = 0; i < count; ++i) {
    Receiver from = receivers[i % receivers.size()];
    const std::uint32_t index = replicate.drawn + static_cast<std::uint32_t>(i);
    std::optional<IrradianceRecords::Vertex> found;
    for (std::uint32_t leg = 0; leg < (i % kFartherPlaces == 0 ? 2 : 1); ++leg) {
      const auto [u, v] = samples.pair(index, leg, 0);
      ++replicate.rays;
      const auto hit =
          scene_.nearest(from.position_world_m, cosine_direction(from.normal_world, u, v), from.normal_world);
      if (!hit) break;
      from = {hit->position_world_m, hit->normal_world};
      const Bsdf& bsdf = bsdfs_[scene_.material_index_of(hit->triangle)];
      if (bsdf.matt() && !bsdf.black()) found = IrradianceRecords::Vertex{hit->position_world_m, hit->normal_world, 0};
    }
    if (!found) continue;
    places.push_back(*found);
    replicate.seen_by.push_back(static_cast<std::uint32_t>(i % receivers.size()));
  }
  replicate.drawn += static_cast<std::uint32_t>(count);
  replicate.records.append(places, columns_);
}

void IrradianceCache::sample(std::size_t k, std::uint32_t first, std::uint32_t paths, const LightVertexPool& pool,
                             std::span<const LightVertexPlan> plans, std::span<const double> cuts_lx,
                             const Watch& watch) {
  Replicate& replicate = replicates_[k];
  IrradianceRecords& records = replicate.records;
  replicate.heads.resize((records.size() - first) * columns_);
  replicate.links.clear();
  PathScratch scratch;
  std::vector<LightVertexRange> stretches;
  std::vector<double> values(columns_);
  TailShare share;
  share.records = &records;
  share.link = true;
  for (auto record = first; record < records.size(); ++record) {
    if (watch.stop.stop_requested()) return;
    const IrradianceRecords::Vertex& place = records.place(record);
    auto start = PathSampler::at({place.position_world_m, place.normal_world});
    start.images = sampler_.images_from_anywhere();
    const LightVertexPlan& plan = plans[replicate.seen_by[record - first]];
    const double cut_lx = cuts_lx[replicate.seen_by[record - first]];
    const std::uint64_t key = mixed(mixed(seed_, kPathKey), mixed(record, k));
    const SobolSequence samples(key);
    std::fill(values.begin(), values.end(), 0.0);
    draw_stretches(plan, pool, paths, mixed(key, kHitKey), stretches);
    replicate.rays += sampler_.join_start(start, pool, plan, stretches, cut_lx, mixed(key, kCutKey), {values, 3});
    double shortest_m = HUGE_VAL;
    for (std::uint32_t p = 0; p < paths; ++p) {
      replicate.rays += sampler_.add_path(start, samples, p, pool, plan, cut_lx, scratch, {values, 3}, &share);
      if (share.linked) replicate.links.push_back({record, *share.linked, (share.per_lux_rgb / paths).cast<float>()});
      shortest_m = std::min(shortest_m, scratch.first_leg_m);
    }
    records.set_clear_m(record, kClearShare * shortest_m);
    for (std::size_t c = 0; c < columns_; ++c)
      replicate.heads[(record - first) * columns_ + c] = static_cast<float>(values[c] / paths);
  }
}

/// Solves E = H + W E by Gauss–Seidel, where H are the heads and W the links. Reflectances below 1 ensure convergence.
/// Older records do not depend on newer ones: none of their links goes there.
void IrradianceCache::settle(std::size_t k, std::uint32_t first) {
  Replicate& replicate = replicates_[k];
  IrradianceRecords& records = replicate.records;
  const std::size_t emitters = columns_ / 3;
  std::vector<float> sum(columns_);
  constexpr int kMaxSweeps = 200;
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double moved = 0, all = 0;
    std::size_t link = 0;
    for (std::uint32_t record = first; record < records.size(); ++record) {
      std::copy_n(replicate.heads.data() + (record - first) * columns_, columns_, sum.begin());
      for (; link < replicate.links.size() && replicate.links[link].to == record; ++link) {
        const float* const from = records.values(replicate.links[link].from).data();
        const Vec3f& per_lux = replicate.links[link].per_lux_rgb;
        for (std::size_t p = 0; p < 3; ++p) {
          const float factor = per_lux[static_cast<Eigen::Index>(p)];
          for (std::size_t c = p * emitters; c < (p + 1) * emitters; ++c) sum[c] += factor * from[c];
        }
      }
      float* const values = records.values(record).data();
      float record_moved = 0, record_all = 0;
      for (std::size_t c = 0; c < columns_; ++c) {
        record_moved += std::abs(sum[c] - values[c]);
        record_all += sum[c];
        values[c] = sum[c];
      }
      moved += static_cast<double>(record_moved);
      all += static_cast<double>(record_all);
    }
    if (moved <= kSettled * all) return;
  }
}

/// The told value of each record is the mean of itself and the visible records beside it.
void IrradianceCache::blend(std::size_t k) {
  Replicate& replicate = replicates_[k];
  IrradianceRecords& records = replicate.records;
  const auto size = static_cast<std::uint32_t>(records.size());
  std::vector<float> count(size, 1.0f);
  for (std::uint32_t i = 0; i < size; ++i) std::ranges::copy(records.values(i), records.told(i).begin());
  std::vector<std::uint32_t> beside;
  for (std::uint32_t i = 0; i < size; ++i) {
    records.find_beside(i, beside);
    const IrradianceRecords::Vertex& here = records.place(i);
    for (const std::uint32_t j : beside) {
      if (j < i) continue;  // already done
      const IrradianceRecords::Vertex& there = records.place(j);
      const double distance_m = (there.position_world_m - here.position_world_m).norm();
      if (distance_m > kBlendClear * std::max(here.clear_m, there.clear_m)) {
        ++replicate.rays;
        if (!sampler_.sees_record(here.position_world_m, here.normal_world, there, distance_m)) continue;
      }
      const std::span<const float> mine = records.values(i), theirs = records.values(j);
      const std::span<float> told_here = records.told(i), told_there = records.told(j);
      for (std::size_t c = 0; c < columns_; ++c) {
        told_here[c] += theirs[c];
        told_there[c] += mine[c];
      }
      ++count[i];
      ++count[j];
    }
  }
  for (std::uint32_t i = 0; i < size; ++i) {
    for (float& lux : records.told(i)) lux /= count[i];
    records.sum_up(i, sampler_.importances());
  }
}

}  // namespace luxrig
