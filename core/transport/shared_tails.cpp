#include "core/transport/shared_tails.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kTailPlaceKey = 0x7a11, kPathKey = 0x7a12, kHitKey = 0x7a13, kCutKey = 0x7a14;

/// Mean change, relative to the mean, at which records count as settled: far below their noise.
constexpr double kSettled = 3e-4;

/// One place of so many is a leg farther from the receivers, where the records' own paths end.
constexpr std::size_t kFartherPlaces = 3;

/// A record speaks for its neighbours without a ray up to this share of the shortest leg that its paths found.
constexpr double kClearShare = 0.5;

}  // namespace

std::uint64_t SharedTails::grow(std::span<const Receiver> receivers, std::size_t count, std::uint32_t paths,
                                std::span<const HitPool> pools, std::span<const HitPlan> plans,
                                std::span<const double> cuts_lx, int threads, const Watch& watch) {
  const auto first = static_cast<std::uint32_t>(records_.size());
  std::uint64_t rays = add_places(receivers, count, threads);
  const std::size_t added = records_.size() - first;
  std::vector<std::vector<float>> shortest_m(replicates_.size());
  parallel_for(replicates_.size(), threads, [&](std::size_t k) {
    shortest_m[k].assign(added, HUGE_VALF);
    sample(k, first, paths, pools[k], plans, cuts_lx, shortest_m[k], watch);
  });
  for (Replicate& replicate : replicates_) rays += std::exchange(replicate.rays, 0);
  for (std::size_t i = 0; i < added; ++i) {
    float clear_m = HUGE_VALF;
    for (const auto& of_replicate : shortest_m) clear_m = std::min(clear_m, of_replicate[i]);
    records_.set_clear_m(first + i, kClearShare * static_cast<double>(clear_m));
  }
  parallel_for(replicates_.size(), threads, [&](std::size_t k) { settle(k, first); });
  return rays;
}

std::uint64_t SharedTails::add_places(std::span<const Receiver> receivers, std::size_t count, int threads) {
  std::vector<std::optional<TailRecords::Place>> found(count);
  const SobolSequence samples(mixed(seed_, kTailPlaceKey));
  parallel_for(count, threads, [&](std::size_t i) {
    Receiver from = receivers[i % receivers.size()];
    const std::uint32_t index = drawn_ + static_cast<std::uint32_t>(i);
    for (std::uint32_t leg = 0; leg < (i % kFartherPlaces == 0 ? 2 : 1); ++leg) {
      const auto [u, v] = samples.pair(index, leg, 0);
      const auto hit =
          scene_.nearest(from.position_world_m, cosine_direction(from.normal_world, u, v), from.normal_world);
      if (!hit) break;
      from = {hit->position_world_m, hit->normal_world};
      const Bsdf& bsdf = bsdfs_[scene_.material_index_of(hit->triangle)];
      if (bsdf.matt() && !bsdf.black()) found[i] = TailRecords::Place{hit->position_world_m, hit->normal_world, 0};
    }
  });
  drawn_ += static_cast<std::uint32_t>(count);
  std::vector<TailRecords::Place> places;
  for (std::size_t i = 0; i < count; ++i) {
    if (!found[i]) continue;
    places.push_back(*found[i]);
    seen_by_.push_back(static_cast<std::uint32_t>(i % receivers.size()));
  }
  records_.append(places, replicates_.size(), columns_);
  return count;
}

void SharedTails::sample(std::size_t k, std::uint32_t first, std::uint32_t paths, const HitPool& pool,
                         std::span<const HitPlan> plans, std::span<const double> cuts_lx,
                         std::vector<float>& shortest_m, const Watch& watch) {
  Replicate& replicate = replicates_[k];
  replicate.heads.resize((records_.size() - first) * columns_);
  replicate.links.clear();
  PathScratch scratch;
  std::vector<HitStretch> stretches;
  std::vector<double> values(columns_);
  TailShare share;
  share.records = &records_;
  share.replicate = k;
  share.link = true;
  for (auto record = first; record < records_.size(); ++record) {
    if (watch.stop.stop_requested()) return;
    const TailRecords::Place& place = records_.place(record);
    const auto start = PathSampler::at({place.position_world_m, place.normal_world});
    const HitPlan& plan = plans[seen_by_[record]];
    const double cut_lx = cuts_lx[seen_by_[record]];
    const std::uint64_t key = mixed(mixed(seed_, kPathKey), mixed(record, k));
    const SobolSequence samples(key);
    std::fill(values.begin(), values.end(), 0.0);
    draw_stretches(plan, pool, paths, mixed(key, kHitKey), stretches);
    replicate.rays += sampler_.join_start(start, pool, plan, stretches, cut_lx, mixed(key, kCutKey), {values, 3});
    for (std::uint32_t p = 0; p < paths; ++p) {
      replicate.rays += sampler_.add_path(start, samples, p, pool, plan, cut_lx, scratch, {values, 3}, &share);
      if (share.linked) replicate.links.push_back({record, *share.linked, (share.per_lux_rgb / paths).cast<float>()});
      shortest_m[record - first] = std::min(shortest_m[record - first], static_cast<float>(scratch.first_leg_m));
    }
    for (std::size_t c = 0; c < columns_; ++c)
      replicate.heads[(record - first) * columns_ + c] = static_cast<float>(values[c] / paths);
  }
}

/// Solves E = H + W E by Gauss–Seidel, where H are the heads and W the links. Reflectances below 1 make it converge.
/// What older records say does not depend on newer ones, to which no link of theirs goes.
void SharedTails::settle(std::size_t k, std::uint32_t first) {
  const Replicate& replicate = replicates_[k];
  const std::size_t emitters = columns_ / 3;
  std::vector<float> sum(columns_);
  constexpr int kMostSweeps = 200;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double moved = 0, all = 0;
    std::size_t link = 0;
    for (std::uint32_t record = first; record < records_.size(); ++record) {
      std::copy_n(replicate.heads.data() + (record - first) * columns_, columns_, sum.begin());
      for (; link < replicate.links.size() && replicate.links[link].to == record; ++link) {
        const float* const from = records_.values(k, replicate.links[link].from).data();
        const Vec3f& per_lux = replicate.links[link].per_lux_rgb;
        for (std::size_t p = 0; p < 3; ++p) {
          const float factor = per_lux[static_cast<Eigen::Index>(p)];
          for (std::size_t c = p * emitters; c < (p + 1) * emitters; ++c) sum[c] += factor * from[c];
        }
      }
      float* const values = records_.values(k, record).data();
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

}  // namespace luxrig
