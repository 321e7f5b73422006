#include "core/transport/candidates/reflected/indirect_columns.h"

#include <algorithm>
#include <cmath>

#include "core/transport/replicate_error.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

/// Light starts this many e (ray_scene.h) away from a lamp: a lamp flush with a ceiling shines away from it, not into
/// it.
constexpr double kErrorsFromLamp = 32;
constexpr std::uint32_t kPilotRays = 1024;

constexpr std::uint64_t kLampKey = 0x6c616d70, kGuidedKey = 0x67756964, kPilotKey = 0x70696c6f;

Vec3 world_direction(const CandidateLuminaire& luminaire, const Vec3& direction_lamp) {
  return (luminaire.lamp_from_world.transpose() * direction_lamp).normalized();
}

struct Leaving {
  Vec3 direction_world;
  double candela = 0;  ///< 0 = nothing leaves
  double density_per_sr = 0;
};

Leaving leaving(const CandidateLuminaire& luminaire, double u, double v) {
  const DirectionSample drawn = luminaire.intensity->sample(u, v);
  if (!(drawn.density_per_sr > 0) || !std::isfinite(drawn.density_per_sr)) return {};
  return {world_direction(luminaire, drawn.direction), luminaire.intensity->intensity_cd(drawn.direction),
          drawn.density_per_sr};
}

}  // namespace

IndirectColumns::IndirectColumns(const RayScene& scene, std::vector<std::unique_ptr<SurfaceImportance>> fields,
                                 double flatness_error, std::uint64_t seed)
    : scene_(scene), fields_(std::move(fields)), flatness_error_(flatness_error), seed_(seed) {}

IndirectColumns::Met IndirectColumns::meet(const SurfaceImportance& field, const Vec3& from_world_m,
                                           const Vec3& direction, std::uint64_t& rays) const {
  ++rays;
  const auto hit = scene_.nearest(from_world_m, direction, Vec3::Zero());
  if (!hit) return {SurfaceImportance::kNoRow, 0};
  const double reflectance = diffuse_reflectance(scene_.material_of(hit->triangle));
  if (!(reflectance > 0)) return {SurfaceImportance::kNoRow, 0};
  return {field.row_at(hit->position_world_m, hit->normal_world, rays), reflectance};
}

/// Worth of a direction: its light at each receiver as a share of all pilot rays' light there, summed over receivers.
/// So receivers with little light count as much as those with much.
DirectionGuide IndirectColumns::guide(const CandidateLuminaire& luminaire, std::span<const Vec3> lamps_world_m,
                                      std::uint64_t& rays) const {
  DirectionGuide guide;
  const SurfaceImportance& field = *fields_.front();
  const SobolSequence samples(mixed(seed_, kPilotKey));
  std::vector<Vec3> directions;
  std::vector<WeightedRow> met;
  for (std::uint32_t i = 0; i < kPilotRays && !lamps_world_m.empty(); ++i) {
    const auto [u, v] = samples.pair(i, 0, 0);
    const Leaving ray = leaving(luminaire, u, v);
    if (!(ray.candela > 0)) continue;
    // Neighbouring points of the sequence go to different places, so that each place covers all directions.
    const Vec3& lamp_m = lamps_world_m[i % lamps_world_m.size()];
    const double off_lamp_m = kErrorsFromLamp * scene_.surface_error_m(lamp_m);
    const Met one = meet(field, lamp_m + off_lamp_m * ray.direction_world, ray.direction_world, rays);
    if (one.row == SurfaceImportance::kNoRow) continue;
    directions.push_back(ray.direction_world);
    met.push_back({one.row, static_cast<float>(ray.candela / ray.density_per_sr * one.reflectance)});
  }
  std::vector<float> per_share(field.stride(), 0.0f);
  add_weighted_rows(field.rows(), met, per_share);
  for (float& sum : per_share) sum = sum > 0 ? 1 / sum : 0;
  for (std::size_t i = 0; i < met.size(); ++i) {
    const float* row = field.rows() + met[i].row * field.stride();
    float worth = 0;
    for (std::size_t r = 0; r < per_share.size(); ++r) worth += per_share[r] * row[r];
    guide.add(directions[i], met[i].weight * worth);
  }
  guide.finish();
  return guide;
}

std::uint64_t IndirectColumns::evaluate(std::size_t replicate, const CandidateLuminaire& luminaire,
                                        const Vec3& lamp_world_m, const DirectionGuide& guide, const Rays& rays,
                                        std::span<float> lux) const {
  std::fill(lux.begin(), lux.end(), 0.0f);
  const double off_lamp_m = kErrorsFromLamp * scene_.surface_error_m(lamp_world_m);
  const std::uint32_t half = rays.per_replicate / 2;
  const SurfaceImportance& field = *fields_[replicate];
  const std::uint64_t key = mixed(mixed(seed_, rays.key), replicate);
  const SobolSequence by_intensity(mixed(key, kLampKey)), where_worth(mixed(key, kGuidedKey));
  std::uint64_t cast = 0;
  std::vector<WeightedRow> met;
  met.reserve(2 * half);
  const auto look = [&](const Vec3& direction, double candela, double own_density, double guide_density) {
    const Met one = meet(field, lamp_world_m + off_lamp_m * direction, direction, cast);
    if (one.row == SurfaceImportance::kNoRow) return;
    const double lumens = candela / (half * (own_density + guide_density));
    met.push_back({one.row, static_cast<float>(lumens * one.reflectance)});
  };
  for (std::uint32_t i = 0; i < half; ++i) {
    if (i == kFirstRays && rays.may_give_up && guide.empty() && met.empty()) return cast;
    const auto [u, v] = by_intensity.pair(i, 0, 0);
    const Leaving ray = leaving(luminaire, u, v);
    if (ray.candela > 0)
      look(ray.direction_world, ray.candela, ray.density_per_sr, guide.density_per_sr(ray.direction_world));
  }
  for (std::uint32_t i = 0; i < half; ++i) {
    const auto [u, v] = where_worth.pair(i, 0, 0);
    const DirectionSample drawn = guide.sample(u, v);
    const Vec3 direction_lamp = luminaire.lamp_from_world * drawn.direction;
    const double candela = luminaire.intensity->intensity_cd(direction_lamp);
    if (candela > 0)
      look(drawn.direction, candela, luminaire.intensity->density_per_sr(direction_lamp), drawn.density_per_sr);
  }
  add_weighted_rows(field.rows(), met, lux);
  return cast;
}

std::uint64_t IndirectColumns::evaluate(const CandidateLuminaire& luminaire, const Vec3& lamp_world_m,
                                        const DirectionGuide& guide, const Rays& rays,
                                        std::span<float> replicates) const {
  std::uint64_t cast = 0;
  for (std::size_t k = 0; k < kReplicates; ++k)
    cast += evaluate(k, luminaire, lamp_world_m, guide, rays, replicates.subspan(k * stride(), stride()));
  return cast;
}

void IndirectColumns::summarise(std::span<const float> replicates, std::span<const float> further_squared_lux2,
                                std::span<float> lux, std::span<float> standard_error_lux) const {
  constexpr double kCount = kReplicates;
  const double widened = student_t_975(kCount - 1) / 1.959963984540054;
  const double spread_share = widened * widened / (kCount * (kCount - 1));
  for (std::size_t r = 0; r < lux.size(); ++r) {
    double mean = 0, squares = 0;
    for (std::size_t k = 0; k < kReplicates; ++k) mean += static_cast<double>(replicates[k * stride() + r]);
    mean /= kCount;
    for (std::size_t k = 0; k < kReplicates; ++k) {
      const double off = static_cast<double>(replicates[k * stride() + r]) - mean;
      squares += off * off;
    }
    const double further = further_squared_lux2.empty() ? 0 : static_cast<double>(further_squared_lux2[r]);
    lux[r] = static_cast<float>(mean);
    standard_error_lux[r] = static_cast<float>(
        std::sqrt(spread_share * squares + flatness_error_ * flatness_error_ * mean * mean + further));
  }
}

std::size_t IndirectColumns::bytes() const {
  std::size_t sum = 0;
  for (const auto& field : fields_) sum += field->bytes();
  return sum;
}

}  // namespace luxrig
