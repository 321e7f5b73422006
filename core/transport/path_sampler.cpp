#include "core/transport/path_sampler.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

double luminance(const Vec3& rgb) { return 0.2126 * rgb.x() + 0.7152 * rgb.y() + 0.0722 * rgb.z(); }

/// Sets of four Sobol dimensions per bounce; far bounces matter little and take plain random numbers.
constexpr std::uint32_t kSetsPerBounce = 3;
constexpr std::uint32_t kSobolBounces = 4;

/// The random numbers of one path.
class Dice {
 public:
  Dice(const SobolSequence& samples, std::uint32_t index)
      : samples_(samples), index_(index), state_(samples.number(index)) {}

  std::array<double, 2> pair(std::uint32_t bounce, std::uint32_t of_bounce) {
    if (bounce >= kSobolBounces) return {plain(), plain()};
    return samples_.pair(index_, kSetsPerBounce * bounce + of_bounce / 2, of_bounce % 2);
  }
  double plain() {
    state_ += 0x9e3779b97f4a7c15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  const SobolSequence& samples_;
  std::uint32_t index_;
  std::uint64_t state_;
};

/// Whether a connection worth `value` is made; if so, by what it counts.
double kept(double value, double cut, double chance) {
  if (value >= cut) return 1;
  return chance * cut < value ? cut / value : 0;
}

}  // namespace

std::uint64_t PathSampler::join(const Vertex& vertex, const LightHit& hit, double hits, double cut_lx, double chance,
                                const PathSums& sums) const {
  const Vec3 towards_m = hit.position_world_m - vertex.position_world_m;
  const double height_m = vertex.normal_world.dot(towards_m);
  const double hit_height_m = -hit.normal_world.dot(towards_m);
  if (!(height_m > 0) || !(hit_height_m > 0)) return 0;
  const double per_distance2 = 1 / towards_m.squaredNorm();
  const double per_distance = std::sqrt(per_distance2);
  const Vec3 direction = towards_m * per_distance;
  const double cosine = height_m * per_distance, hit_cosine = hit_height_m * per_distance;
  Vec3 rgb = vertex.through_rgb;
  double density = cosine / kPi;
  if (vertex.bsdf) {
    rgb = rgb.cwiseProduct(vertex.bsdf->value(vertex.normal_world, vertex.out_world, direction));
    density = vertex.bsdf->density(vertex.normal_world, vertex.out_world, direction);
  }
  rgb = rgb.cwiseProduct(hit.bsdf->value(hit.normal_world, -direction, hit.to_light_world)).cwiseProduct(hit.flux_rgb);
  const double geometry = cosine * hit_cosine * per_distance2;
  const double by_hit = hits * hit.density;
  const double by_path = density * hit_cosine * per_distance2 * hit.choice_density;
  const double factor = geometry / hits * (by_hit / (by_hit + by_path));
  if (!(factor > 0) || !std::isfinite(factor)) return 0;
  rgb *= factor;
  const double worth = luminance(rgb) * level(hit.emitter);
  if (!(worth > 0)) return 0;
  const double counts = kept(worth, cut_lx, chance);
  if (counts == 0) return 0;
  if (!scene_.occluded(vertex.position_world_m, vertex.normal_world, hit.position_world_m))
    sums.add(hit.emitter, counts * rgb);
  return 1;
}

std::uint64_t PathSampler::ask_lamps(const Vertex& vertex, double density_per_m2, double hits, double cut_lx,
                                     double select, double u, double v, double chance, PathScratch& scratch,
                                     const PathSums& sums) const {
  const double sum = lamps_.weigh(vertex.position_world_m, vertex.normal_world, scratch.weights);
  const LampChoice choice =
      lamps_.choose(vertex.position_world_m, vertex.normal_world, scratch.weights, sum, select, u, v);
  if (!(choice.density > 0)) return 0;
  const Vec3 per_lux = vertex.through_rgb.cwiseProduct(
      vertex.bsdf->value(vertex.normal_world, vertex.out_world, choice.direction_world));
  const double by_path = density_per_m2 * choice.density;
  scratch.lit.clear();
  double worth = 0;
  lamps_.light(choice, [&](std::size_t emitter, double lux, double hit_density) {
    const double share = by_path / (by_path + hits * hit_density);
    const Vec3 rgb = share * lux * per_lux.cwiseProduct(lamps_.colour_rgb(emitter));
    worth += luminance(rgb) * level(emitter);
    scratch.lit.push_back({emitter, rgb});
  });
  if (!(worth > 0) || !std::isfinite(worth)) return 0;
  const double counts = kept(worth, cut_lx, chance);
  if (counts == 0) return 0;
  if (!scene_.occluded(vertex.position_world_m, vertex.normal_world, choice.target_world_m))
    for (const PathScratch::Lit& lit : scratch.lit) sums.add(lit.emitter, counts * lit.rgb);
  return 1;
}

std::uint64_t PathSampler::add_path(const Receiver& from, const SobolSequence& samples, std::uint32_t index,
                                    const HitPool& pool, std::size_t pool_index, double cut_lx, PathScratch& scratch,
                                    const PathSums& sums, TailShare* tails) const {
  return add_path(Vertex{from.position_world_m, from.normal_world, from.normal_world}, samples, index, pool, pool_index,
                  cut_lx, scratch, sums, tails);
}

std::uint64_t PathSampler::add_path(const Vertex& start, const SobolSequence& samples, std::uint32_t index,
                                    const HitPool& pool, std::size_t pool_index, double cut_lx, PathScratch& scratch,
                                    const PathSums& sums, TailShare* tails) const {
  std::uint64_t rays = 0;
  scratch.first_leg_m = HUGE_VAL;
  Dice dice(samples, index);
  Vertex vertex = start;
  if (tails != nullptr) tails->linked.reset();
  double before_tail = 0;
  bool checking = false;
  for (std::uint32_t bounce = 0; bounce < kLongestPath; ++bounce) {
    double hits = 1;
    if (bounce == 0) {
      hits = kHitsPerPath;
      for (std::size_t h = pool_index; h < pool_index + kHitsPerPath; ++h)
        if (const LightHit& hit = pool.hits[h]; hit.shines())
          rays += join(vertex, hit, hits, cut_lx, dice.plain(), sums);
    } else if (!pool.shining.empty()) {
      // Hits without flux count as drawn: of all samples, so many shine.
      const auto pick = static_cast<std::size_t>(dice.pair(bounce, 3)[0] * static_cast<double>(pool.shining.size()));
      const LightHit& hit = pool.hits[pool.shining[std::min(pick, pool.shining.size() - 1)]];
      Vertex weighed = vertex;
      weighed.through_rgb *= static_cast<double>(pool.shining.size()) / static_cast<double>(pool.hits.size());
      rays += join(weighed, hit, hits, cut_lx, dice.plain(), sums);
    }
    const auto [u, v] = dice.pair(bounce, 0);
    Bsdf::Sample next;
    if (vertex.bsdf) {
      next = vertex.bsdf->sample(vertex.normal_world, vertex.out_world, u, v,
                                 vertex.bsdf->matt() ? 0 : dice.pair(bounce, 4)[0]);
    } else {
      next.in = cosine_direction(vertex.normal_world, u, v);
      next.weight_rgb = Vec3::Constant(kPi);
      next.density_per_sr = vertex.normal_world.dot(next.in) / kPi;
    }
    if (!(next.density_per_sr > 0)) break;
    ++rays;
    const auto hit = scene_.nearest(vertex.position_world_m, next.in, vertex.normal_world);
    if (!hit) break;
    const Bsdf& bsdf = bsdfs_[scene_.material_index_of(hit->triangle)];
    if (bsdf.black()) break;
    Vertex reached{hit->position_world_m, hit->normal_world, -next.in, &bsdf,
                   vertex.through_rgb.cwiseProduct(next.weight_rgb)};
    const double cosine = reached.normal_world.dot(reached.out_world);
    const double distance2_m2 = (reached.position_world_m - vertex.position_world_m).squaredNorm();
    const double density_per_m2 = next.density_per_sr * cosine / distance2_m2;
    const auto [select, chance] = dice.pair(bounce, 1);
    const auto [s, t] = lamps_.have_size() ? dice.pair(bounce, 2) : std::array<double, 2>{};
    // In a corner, where the distance rounds to nothing, the path is the sharper way.
    rays += ask_lamps(reached, std::min(density_per_m2, 1e200), hits, cut_lx, select, s, t, chance, scratch, sums);
    if (bounce == 0) scratch.first_leg_m = std::sqrt(distance2_m2);
    if (bounce == 0 && tails != nullptr && tails->records != nullptr && bsdf.matt()) {
      if (const auto record = record_for(reached, *tails->records, rays)) {
        const Vec3 per_lux_rgb = reached.through_rgb.cwiseProduct(bsdf.body_rgb()) / kPi;
        if (tails->link) {
          tails->linked = record;
          tails->per_lux_rgb = per_lux_rgb;
          break;
        }
        const auto values = tails->records->values(tails->replicate, *record);
        if (!tails->check) {
          tails->taken_lx += add_record(per_lux_rgb, values, sums);
          break;
        }
        tails->by_record_lx += add_record(per_lux_rgb, values, PathSums{{}, 0});
        before_tail = worth_of(sums);
        checking = true;
      }
    }
    const double throughput = reached.through_rgb.cwiseProduct(bsdf.body_rgb()).maxCoeff() / kPi +
                              (bsdf.matt() ? 0 : reached.through_rgb.maxCoeff() / kPi * bsdf.coat_albedo(cosine));
    if (throughput < kRouletteBelow) {
      const double goes_on = throughput / kRouletteBelow;
      if (dice.pair(bounce, 3)[1] >= goes_on) break;
      reached.through_rgb /= goes_on;
    }
    vertex = reached;
  }
  if (checking) tails->by_path_lx += worth_of(sums) - before_tail;
  return rays;
}

double PathSampler::worth_of(const PathSums& sums) const {
  double worth = 0;
  for (std::size_t e = 0; e < levels_.size(); ++e) {
    const double* const v = sums.values.data() + e * sums.channels;
    worth += levels_[e] * (sums.channels == 1 ? v[0] : luminance({v[0], v[1], v[2]}));
  }
  return worth;
}

std::optional<std::uint32_t> PathSampler::record_for(const Vertex& vertex, const TailRecords& records,
                                                     std::uint64_t& rays) const {
  const auto found = records.nearest(vertex.position_world_m, vertex.normal_world);
  if (!found) return std::nullopt;
  const TailRecords::Place& place = records.place(found->record);
  if (found->distance_m <= place.clear_m) return found->record;
  // Above both surfaces by a part of their distance, so that what is nearly plane does not stand in its own way.
  const double lift_m = 0.05 * found->distance_m;
  ++rays;
  if (scene_.occluded(vertex.position_world_m + lift_m * vertex.normal_world, vertex.normal_world,
                      place.position_world_m + lift_m * place.normal_world))
    return std::nullopt;
  return found->record;
}

double PathSampler::add_record(const Vec3& per_lux_rgb, std::span<const float> values, const PathSums& sums) const {
  double worth = 0;
  for (std::size_t e = 0; e < levels_.size(); ++e) {
    const Vec3 rgb = per_lux_rgb.cwiseProduct(Vec3(values[3 * e], values[3 * e + 1], values[3 * e + 2]));
    if (sums.channels > 0) sums.add(e, rgb);
    worth += levels_[e] * luminance(rgb);
  }
  return worth;
}

}  // namespace luxrig
