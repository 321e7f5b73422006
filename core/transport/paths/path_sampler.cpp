#include "core/transport/paths/path_sampler.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/photometry/light_colour.h"

namespace luxrig {
namespace {

constexpr std::array<double, 3> kLuminance = {0.2126, 0.7152, 0.0722};

/// Sets of four Sobol dimensions per bounce; far bounces matter little and use plain random numbers.
constexpr std::uint32_t kSetsPerBounce = 3;
constexpr std::uint32_t kSobolBounces = 4;
/// Shadow rays of a start cast together.
constexpr std::size_t kJoinsAtOnce = 64;

/// Random numbers without strata.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  double plain() {
    state_ += 0x9e3779b97f4a7c15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

/// The random numbers of one path.
class PathDice : public Dice {
 public:
  PathDice(const SobolSequence& samples, std::uint32_t index)
      : Dice(samples.number(index)), samples_(samples), index_(index) {}

  std::array<double, 2> pair(std::uint32_t bounce, std::uint32_t of_bounce) {
    if (bounce >= kSobolBounces) return {plain(), plain()};
    return samples_.pair(index_, kSetsPerBounce * bounce + of_bounce / 2, of_bounce % 2);
  }

 private:
  const SobolSequence& samples_;
  std::uint32_t index_;
};

/// Weight of a connection worth `value`; 0 if it is not made.
double kept(double value, double cut, double chance) {
  if (value >= cut) return 1;
  return chance * cut < value ? cut / value : 0;
}

}  // namespace

PathSampler::Join PathSampler::join(const Vertex& vertex, const LightVertex& hit, double hits, double cut,
                                    double chance) const {
  const Vec3 towards_m = hit.position_world_m - vertex.position_world_m;
  const double height_m = vertex.normal_world.dot(towards_m);
  const double hit_height_m = -hit.normal_world.dot(towards_m);
  if (!(height_m > 0) || !(hit_height_m > 0)) return {};
  const double per_distance2 = 1 / towards_m.squaredNorm();
  const double geometry = height_m * hit_height_m * per_distance2 * per_distance2;
  const double by_hit = hits * hit.density;
  double of_surface = height_m * std::sqrt(per_distance2) / kPi;
  double asked = hit.choice_density;
  Vec3 rgb = vertex.through_rgb;
  if (hit.bsdf->matt() && (vertex.bsdf == nullptr || vertex.bsdf->matt())) {
    rgb = rgb.cwiseProduct(hit.matt_rgb);
    if (vertex.bsdf) rgb = rgb.cwiseProduct(vertex.bsdf->body_rgb()) / kPi;
  } else {
    const Vec3 direction = towards_m * std::sqrt(per_distance2);
    rgb =
        rgb.cwiseProduct(hit.bsdf->value(hit.normal_world, -direction, hit.to_light_world)).cwiseProduct(hit.flux_rgb);
    asked += met_density_per_sr(hit.emitter, *hit.bsdf, hit.normal_world, -direction, hit.to_light_world);
    if (vertex.bsdf) {
      rgb = rgb.cwiseProduct(vertex.bsdf->value(vertex.normal_world, vertex.out_world, direction));
      of_surface = vertex.bsdf->density(vertex.normal_world, vertex.out_world, direction);
    }
  }
  const double density =
      vertex.outside ? next_density_per_sr(vertex, towards_m * std::sqrt(per_distance2), of_surface) : of_surface;
  const double by_path = density * hit_height_m * per_distance2 * std::sqrt(per_distance2) * asked;
  const std::size_t place = lamps_.place_of(hit.emitter);
  double by_image = image_density_per_m2(vertex, hit.plane, place, hit.position_world_m);
  if (by_image > 0)
    by_image *= image_direction_density(place, hit.in_place, *hit.bsdf, hit.normal_world,
                                        -towards_m * std::sqrt(per_distance2), hit.to_light_world);
  const double factor = geometry / hits * (by_hit / (by_hit + by_path + by_image));
  if (!(factor > 0) || !std::isfinite(factor)) return {};
  rgb *= factor;
  const double worth = luminance_of_rgb(rgb) * level(hit.emitter);
  if (!(worth > 0)) return {};
  const double counts = kept(worth, cut, chance);
  return {hit.emitter, counts * rgb, counts * worth};
}

void PathSampler::look_outside(Vertex& vertex, SkyOpenings::Outside& outside) const {
  vertex.outside = nullptr;
  if (!lamps_.openings()) return;
  lamps_.openings()->look_outside(vertex.position_world_m, vertex.normal_world, outside);
  if (outside.sum > 0) vertex.outside = &outside;
}

double PathSampler::next_density_per_sr(const Vertex& vertex, const Vec3& direction, double of_surface) const {
  return (1 - kOutsideShare) * of_surface +
         kOutsideShare * lamps_.openings()->outside_density_per_sr(*vertex.outside, vertex.position_world_m, direction);
}

Bsdf::Sample PathSampler::next_direction(const Vertex& vertex, double u, double v, double lobe) const {
  Bsdf::Sample next;
  if (vertex.outside && u < kOutsideShare) {
    next.in =
        lamps_.openings()->sample_outside(*vertex.outside, vertex.position_world_m, u / kOutsideShare, v).direction;
    const double cosine = vertex.normal_world.dot(next.in);
    if (!(cosine > 0)) return {};
    next.density_per_sr =
        vertex.bsdf ? vertex.bsdf->density(vertex.normal_world, vertex.out_world, next.in) : cosine / kPi;
    next.weight_rgb = cosine * (vertex.bsdf ? vertex.bsdf->value(vertex.normal_world, vertex.out_world, next.in)
                                            : Vec3(Vec3::Ones()));
    next.density_per_sr = next_density_per_sr(vertex, next.in, next.density_per_sr);
    if (!(next.density_per_sr > 0)) return {};
    next.weight_rgb /= next.density_per_sr;
    return next;
  }
  if (vertex.outside) u = (u - kOutsideShare) / (1 - kOutsideShare);
  if (vertex.bsdf) {
    next = vertex.bsdf->sample(vertex.normal_world, vertex.out_world, u, v, lobe);
  } else {
    next.in = cosine_direction(vertex.normal_world, u, v);
    next.weight_rgb = Vec3::Constant(kPi);
    next.density_per_sr = vertex.normal_world.dot(next.in) / kPi;
  }
  if (vertex.outside && next.density_per_sr > 0) {
    const double density = next_density_per_sr(vertex, next.in, next.density_per_sr);
    next.weight_rgb *= next.density_per_sr / density;
    next.density_per_sr = density;
  }
  return next;
}

std::uint64_t PathSampler::join_start(const Vertex& start, const LightVertexPool& pool, const LightVertexPlan& plan,
                                      std::span<const LightVertexRange> stretches, double cut, std::uint64_t key,
                                      const PathSums& sums, std::span<double> squares) const {
  std::uint64_t rays = 0;
  Dice dice(key);
  Vertex vertex = start;
  SkyOpenings::Outside outside;
  look_outside(vertex, outside);
  std::array<Join, kJoinsAtOnce> joins;
  std::array<Vec3, kJoinsAtOnce> hits_world_m;
  std::array<std::size_t, kJoinsAtOnce> group_of{};
  std::array<std::uint8_t, kJoinsAtOnce> occluded{};
  std::size_t count = 0;
  const auto shine = [&] {
    scene_.occluded_many(vertex.position_world_m, vertex.normal_world, std::span(hits_world_m).first(count),
                         std::span(occluded).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      if (occluded[i] != 0) continue;
      const double through = through_glass(vertex.position_world_m, hits_world_m[i]);
      sums.add(joins[i].emitter, through * joins[i].rgb);
      const double of_one_hit = through * joins[i].worth * plan.at_start[group_of[i]];
      if (!squares.empty()) squares[group_of[i]] += of_one_hit * of_one_hit;
    }
    rays += std::exchange(count, 0);
  };
  for (std::size_t g = 0; g < stretches.size(); ++g) {
    for (const LightVertex& hit : pool.hits(g).subspan(stretches[g].begin, stretches[g].count)) {
      if (!hit.shines()) continue;
      joins[count] = join(vertex, hit, plan.at_start[g], cut, dice.plain());
      if (!(joins[count].worth > 0)) continue;
      group_of[count] = g;
      hits_world_m[count++] = hit.position_world_m;
      if (count == kJoinsAtOnce) shine();
    }
  }
  if (count > 0) shine();
  return rays;
}

std::uint64_t PathSampler::join_deeper(const Vertex& vertex, const LightVertexPool& pool, const LightVertexPlan& plan,
                                       double cut, double select, double chance, const PathSums& sums) const {
  std::size_t g = 0;
  while (g + 1 < pool.groups() && select >= plan.deeper[g]) select -= plan.deeper[g++];
  const auto shining = pool.shining(g);
  if (shining.empty() || !(plan.deeper[g] > 0)) return 0;
  // The remainder of the number after the choice is again uniform.
  const double rest = std::clamp(select / plan.deeper[g], 0.0, 1 - 0x1p-53);
  const auto pick = static_cast<std::size_t>(rest * static_cast<double>(shining.size()));
  // Hits without flux count as drawn: this many of all samples shine.
  Vertex weighed = vertex;
  weighed.through_rgb *= static_cast<double>(shining.size()) / pool.count(g);
  const LightVertex& hit = pool.hits(g)[shining[pick]];
  const Join joined = join(weighed, hit, plan.deeper[g], cut, chance);
  if (!(joined.worth > 0)) return 0;
  if (!scene_.occluded(vertex.position_world_m, vertex.normal_world, hit.position_world_m))
    sums.add(joined.emitter, through_glass(vertex.position_world_m, hit.position_world_m) * joined.rgb);
  return 1;
}

std::uint64_t PathSampler::join_image(const Vertex& vertex, std::span<const double> hits, double cut,
                                      const ImageDice& dice, PathScratch& scratch, const PathSums& sums) const {
  const auto place = images_.draw(*vertex.images, vertex.position_world_m, dice.select, dice.u, dice.v);
  if (place.plane == MirrorImages::kNoPlane) return 0;
  const Vec3 towards_m = place.position_world_m - vertex.position_world_m;
  const double height_m = vertex.normal_world.dot(towards_m), place_height_m = -place.normal_world.dot(towards_m);
  if (!(height_m > 0) || !(place_height_m > 0)) return 0;
  const double per_distance2 = 1 / towards_m.squaredNorm(), per_distance = std::sqrt(per_distance2);
  const Vec3 direction = towards_m * per_distance;
  const Bsdf& bsdf = bsdfs_[images_.material_of(place.plane)];
  const std::size_t lamp = place.place_of_lamp;
  EmitterChoice choice;
  if (lamps_.place_has_size(lamp) && dice.by_gloss < 0.5) {
    const Bsdf::Sample drawn = bsdf.sample(place.normal_world, -direction, dice.s, dice.t, dice.lobe);
    if (!(drawn.density_per_sr > 0)) return 0;
    choice = lamps_.place_towards(lamp, place.position_world_m, place.normal_world, drawn.in);
  } else {
    choice = lamps_.ask_place(lamp, 1, place.position_world_m, place.normal_world, dice.s, dice.t);
  }
  if (!(choice.density > 0)) return 0;
  choice.density =
      image_direction_density(lamp, choice.in_place, bsdf, place.normal_world, -direction, choice.direction_world);
  Vec3 per_lux = vertex.through_rgb.cwiseProduct(bsdf.value(place.normal_world, -direction, choice.direction_world)) *
                 (height_m * place_height_m * per_distance2 * per_distance2 / place.density_per_m2);
  double of_surface = height_m * per_distance / kPi;
  if (vertex.bsdf) {
    per_lux = per_lux.cwiseProduct(vertex.bsdf->value(vertex.normal_world, vertex.out_world, direction));
    of_surface = vertex.bsdf->density(vertex.normal_world, vertex.out_world, direction);
  }
  if (!(per_lux.maxCoeff() > 0)) return 0;
  if (vertex.outside) of_surface = next_density_per_sr(vertex, direction, of_surface);
  const double path_per_m2 = of_surface * place_height_m * per_distance2 * per_distance;
  const double sum = lamps_.weigh(place.position_world_m, place.normal_world, scratch.image_weights);
  const double asked = lamps_.place_probability(lamp, scratch.image_weights, sum);
  const double by_image = place.density_per_m2 * choice.density, by_path = path_per_m2 * asked * choice.in_place;
  scratch.lit.clear();
  double worth = 0;
  lamps_.light(choice, [&](std::size_t emitter, double lux, double hit_density) {
    const double by_chance =
        path_per_m2 * met_density_per_sr(emitter, bsdf, place.normal_world, -direction, choice.direction_world);
    const double by_hit = hits[lamps_.group_of(emitter)] * hit_density;
    const double share = by_image / (by_image + by_path + by_hit + by_chance);
    const Vec3 rgb = share * lux * per_lux.cwiseProduct(lamps_.colour_rgb(emitter));
    worth += luminance_of_rgb(rgb) * level(emitter);
    scratch.lit.push_back({emitter, rgb});
  });
  if (!(worth > 0) || !std::isfinite(worth)) return 0;
  const double counts = kept(worth, cut, dice.chance);
  if (counts == 0) return 0;
  // The plane has a surface only where its triangles are.
  const auto hit = scene_.nearest(vertex.position_world_m, direction, vertex.normal_world);
  if (!hit || images_.plane_of(hit->triangle) != place.plane) return 1;
  if (!scene_.occluded(hit->position_world_m, hit->normal_world, choice.target_world_m)) {
    const double share = counts * through_glass(vertex.position_world_m, hit->position_world_m) *
                         through_glass(hit->position_world_m, choice.target_world_m);
    for (const PathScratch::Lit& lit : scratch.lit) sums.add(lit.emitter, share * lit.rgb);
  }
  return 2;
}

std::uint64_t PathSampler::ask_lamps(const Vertex& before, const Vertex& vertex, double density_per_m2,
                                     std::span<const double> hits, double cut, double select, double u, double v,
                                     double chance, PathScratch& scratch, const PathSums& sums) const {
  scratch.weights_sum = lamps_.weigh(vertex.position_world_m, vertex.normal_world, scratch.weights);
  const EmitterChoice choice =
      lamps_.choose(vertex.position_world_m, vertex.normal_world, scratch.weights, scratch.weights_sum, select, u, v);
  if (!(choice.density > 0)) return 0;
  const Vec3 per_lux = vertex.through_rgb.cwiseProduct(
      vertex.bsdf->value(vertex.normal_world, vertex.out_world, choice.direction_world));
  const double by_path = density_per_m2 * choice.density;
  double by_image = image_density_per_m2(before, vertex.plane, choice.place, vertex.position_world_m);
  if (by_image > 0)
    by_image *= image_direction_density(choice.place, choice.in_place, *vertex.bsdf, vertex.normal_world,
                                        vertex.out_world, choice.direction_world);
  scratch.lit.clear();
  double worth = 0;
  lamps_.light(choice, [&](std::size_t emitter, double lux, double hit_density) {
    const double by_chance = density_per_m2 * met_density_per_sr(emitter, *vertex.bsdf, vertex.normal_world,
                                                                 vertex.out_world, choice.direction_world);
    const double share = by_path / (by_path + hits[lamps_.group_of(emitter)] * hit_density + by_chance + by_image);
    const Vec3 rgb = share * lux * per_lux.cwiseProduct(lamps_.colour_rgb(emitter));
    worth += luminance_of_rgb(rgb) * level(emitter);
    scratch.lit.push_back({emitter, rgb});
  });
  if (!(worth > 0) || !std::isfinite(worth)) return 0;
  const double counts = kept(worth, cut, chance);
  if (counts == 0) return 0;
  if (!scene_.occluded(vertex.position_world_m, vertex.normal_world, choice.target_world_m)) {
    const double share = counts * through_glass(vertex.position_world_m, choice.target_world_m);
    for (const PathScratch::Lit& lit : scratch.lit) sums.add(lit.emitter, share * lit.rgb);
  }
  return 1;
}

void PathSampler::meet_lights(const Vertex& before, const Vertex& vertex, const Bsdf::Sample& next, double free_m,
                              double density_per_m2, std::span<const double> hits, const PathScratch& scratch,
                              const PathSums& sums) const {
  const double of_gloss = vertex.bsdf->density(vertex.normal_world, vertex.out_world, next.in);
  lamps_.each_towards(
      vertex.position_world_m, vertex.normal_world, next.in, free_m, scratch.weights, scratch.weights_sum,
      [&](std::size_t emitter, double luminance_cd_m2, double choice_density, double in_place, double hit_density,
          const Vec3& at_world_m) {
        const std::size_t place = lamps_.place_of(emitter);
        double by_image = image_density_per_m2(before, vertex.plane, place, vertex.position_world_m);
        if (by_image > 0)
          by_image *=
              image_direction_density(place, in_place, *vertex.bsdf, vertex.normal_world, vertex.out_world, next.in);
        // The MIS weight uses the density of gloss alone, although some paths towards openings raise the actual
        // density.
        const double share = of_gloss / (of_gloss + choice_density +
                                         (hits[lamps_.group_of(emitter)] * hit_density + by_image) / density_per_m2);
        const double counts = through_glass(vertex.position_world_m, at_world_m) * share * luminance_cd_m2;
        if (!(counts > 0) || !std::isfinite(counts)) return;
        sums.add(emitter,
                 counts * vertex.through_rgb.cwiseProduct(next.weight_rgb).cwiseProduct(lamps_.colour_rgb(emitter)));
      });
}

std::uint64_t PathSampler::add_path(const Vertex& start, const SobolSequence& samples, std::uint32_t index,
                                    const LightVertexPool& pool, const LightVertexPlan& plan, double cut,
                                    PathScratch& scratch, const PathSums& sums, TailShare* tails) const {
  std::uint64_t rays = 0;
  scratch.first_leg_m = HUGE_VAL;
  PathDice dice(samples, index);
  Vertex vertex = start, before = start;  // `before`: the previous vertex, where it may see images of lamps
  double arrived_per_m2 = 0;
  if (tails != nullptr) tails->linked.reset();
  const PathSums* into = &sums;
  PathSums beside;  // for a path that only checks a record
  for (std::uint32_t bounce = 0; bounce < kLongestPath; ++bounce) {
    look_outside(vertex, scratch.outside);
    if (bounce > 0) rays += join_deeper(vertex, pool, plan, cut, dice.pair(bounce, 3)[0], dice.plain(), *into);
    if (vertex.images && !vertex.images->images.empty()) {
      const auto [u, v] = dice.pair(bounce, 5);
      const ImageDice of_image{
          dice.pair(bounce, 4)[1], u, v, dice.plain(), dice.plain(), dice.plain(), dice.plain(), dice.plain()};
      rays += join_image(vertex, bounce == 0 ? plan.at_start : plan.deeper, cut, of_image, scratch, *into);
    }
    const auto [u, v] = dice.pair(bounce, 0);
    const double lobe = vertex.bsdf && !vertex.bsdf->matt() ? dice.pair(bounce, 4)[0] : 0;
    const Bsdf::Sample next = next_direction(vertex, u, v, lobe);
    if (!(next.density_per_sr > 0)) break;
    ++rays;
    const auto hit = scene_.nearest(vertex.position_world_m, next.in, vertex.normal_world);
    if (bounce > 0 && lamps_.have_size() && !vertex.bsdf->matt()) {
      const double free_m = hit ? hit->distance_m + 2 * scene_.surface_error_m(hit->position_world_m) : HUGE_VAL;
      meet_lights(before, vertex, next, free_m, arrived_per_m2, bounce == 1 ? plan.at_start : plan.deeper, scratch,
                  *into);
    }
    if (!hit) break;
    const Bsdf& bsdf = bsdfs_[scene_.material_index_of(hit->triangle)];
    if (bsdf.black()) break;
    Vertex reached{hit->position_world_m, hit->normal_world, -next.in, &bsdf,
                   through_glass(vertex.position_world_m, hit->position_world_m) *
                       vertex.through_rgb.cwiseProduct(next.weight_rgb)};
    if (images_.any()) {
      reached.images = &images_.from_anywhere();
      reached.plane = images_.plane_of(hit->triangle);
    }
    const double cosine = reached.normal_world.dot(reached.out_world);
    const double distance2_m2 = (reached.position_world_m - vertex.position_world_m).squaredNorm();
    // In a corner, where the distance rounds to 0, the path is the more accurate way.
    const double density_per_m2 = std::min(next.density_per_sr * cosine / distance2_m2, 1e200);
    const auto [select, chance] = dice.pair(bounce, 1);
    const auto [s, t] = lamps_.have_size() ? dice.pair(bounce, 2) : std::array<double, 2>{};
    rays += ask_lamps(vertex, reached, density_per_m2, bounce == 0 ? plan.at_start : plan.deeper, cut, select, s, t,
                      chance, scratch, *into);
    if (bounce == 0) scratch.first_leg_m = std::sqrt(distance2_m2);
    if (tails != nullptr && tails->records != nullptr && into == &sums && bsdf.matt()) {
      if (const auto record = record_for(reached.position_world_m, reached.normal_world, *tails->records, rays)) {
        const Vec3 per_lux_rgb = reached.through_rgb.cwiseProduct(bsdf.body_rgb()) / kPi;
        if (tails->link) {
          tails->linked = record;
          tails->per_lux_rgb = per_lux_rgb;
          break;
        }
        if (tails->ends == nullptr) {
          tails->taken_lx += add_record(per_lux_rgb, *tails->records, *record, sums);
          break;
        }
        tails->ends->ends.push_back({reached.position_world_m, reached.normal_world.cast<float>(),
                                     per_lux_rgb.cast<float>(), *record,
                                     static_cast<std::uint32_t>(tails->records->size())});
        if (!tails->check) break;
        scratch.beside.assign(sums.values.size(), 0.0);
        beside = {scratch.beside, sums.channels};
        into = &beside;
      }
    }
    const double throughput = reached.through_rgb.cwiseProduct(bsdf.body_rgb()).maxCoeff() / kPi +
                              (bsdf.matt() ? 0 : reached.through_rgb.maxCoeff() / kPi * bsdf.coat_albedo(cosine));
    if (throughput < kRouletteBelow) {
      const double goes_on = throughput / kRouletteBelow;
      if (dice.pair(bounce, 3)[1] >= goes_on) break;
      reached.through_rgb /= goes_on;
    }
    if (images_.any()) before = vertex;
    vertex = reached;
    arrived_per_m2 = density_per_m2;
  }
  if (into == &beside)
    tails->ends->checks.push_back(
        {static_cast<std::uint32_t>(tails->ends->ends.size() - 1), static_cast<float>(worth_of(beside))});
  return rays;
}

double PathSampler::worth_of(const PathSums& sums) const {
  const std::size_t emitters = levels_.size();
  double worth = 0;
  for (std::size_t c = 0; c < sums.channels; ++c) {
    const double weight = sums.channels == 1 ? 1 : kLuminance[c];
    for (std::size_t e = 0; e < emitters; ++e) worth += weight * levels_[e] * sums.values[c * emitters + e];
  }
  return worth;
}

std::optional<std::uint32_t> PathSampler::record_for(const Vec3& position_world_m, const Vec3& normal_world,
                                                     const IrradianceRecords& records, std::uint64_t& rays,
                                                     std::optional<std::uint32_t> so_far) const {
  const auto found = records.nearest(position_world_m, normal_world);
  if (!found) return std::nullopt;
  if (found->record == so_far) return so_far;  // the path to it was clear
  const IrradianceRecords::Vertex& place = records.place(found->record);
  if (found->distance_m <= place.clear_m) return found->record;
  ++rays;
  if (!sees_record(position_world_m, normal_world, place, found->distance_m)) return std::nullopt;
  return found->record;
}

bool PathSampler::sees_record(const Vec3& position_world_m, const Vec3& normal_world,
                              const IrradianceRecords::Vertex& record, double distance_m) const {
  // Above both surfaces by a share of their distance, so that a nearly plane surface does not block itself.
  const double lift_m = 0.05 * distance_m;
  return !scene_.occluded(position_world_m + lift_m * normal_world, normal_world,
                          record.position_world_m + lift_m * record.normal_world);
}

PathSampler::EndsSum PathSampler::add_ends(RecordLookups& ends, const IrradianceRecords& records,
                                           const PathSums& sums) const {
  EndsSum sum;
  std::size_t check = 0;
  for (std::size_t i = 0; i < ends.ends.size(); ++i) {
    RecordLookup& end = ends.ends[i];
    if (end.looked_at < records.size()) {
      // A nearer record behind an edge does not represent it; then the present one stays.
      if (const auto record =
              record_for(end.position_world_m, end.normal_world.cast<double>(), records, sum.rays, end.record))
        end.record = *record;
      end.looked_at = static_cast<std::uint32_t>(records.size());
    }
    const double taken_lx = add_record(end.per_lux_rgb.cast<double>(), records, end.record, sums);
    sum.taken_lx += taken_lx;
    for (; check < ends.checks.size() && ends.checks[check].end == i; ++check) {
      sum.checked_lx += taken_lx;
      sum.by_path_lx += static_cast<double>(ends.checks[check].by_path_lx);
    }
  }
  return sum;
}

double PathSampler::add_record(const Vec3& per_lux_rgb, const IrradianceRecords& records, std::size_t record,
                               const PathSums& sums) const {
  const Vec3 luminous = Vec3(kLuminance[0], kLuminance[1], kLuminance[2]).cwiseProduct(per_lux_rgb);
  if (!sums.values.empty()) {
    // Plain loops over contiguous arrays, which the compiler vectorises.
    const std::size_t emitters = levels_.size();
    const float* const from = records.told(record).data();
    records.each_lit(record, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = 0; c < 3; ++c) {
        const auto channel = static_cast<Eigen::Index>(c);
        double* const to = sums.values.data() + (sums.channels == 1 ? 0 : c * emitters);
        const double factor = sums.channels == 1 ? luminous[channel] : per_lux_rgb[channel];
        for (std::size_t e = begin; e < end; ++e) to[e] += factor * static_cast<double>(from[c * emitters + e]);
      }
    });
  }
  return luminous.dot(records.told_lux_rgb(record));
}

}  // namespace luxrig
