#include "core/transport/candidates/indirect_columns.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/transport/replicate_error.h"
#include "core/transport/sobol.h"

namespace luxrig {
namespace {

/// As RayScene::occluded() stops short of a lamp, light starts a little way from it: a lamp flush with a ceiling shines
/// off it, not into it.
constexpr double kErrorsFromLamp = 32;
constexpr std::uint32_t kPilotRays = 1024;

constexpr std::uint64_t kLampKey = 0x6c616d70, kGuidedKey = 0x67756964, kPilotKey = 0x70696c6f;

Vec3 world_direction(const CandidateLuminaire& luminaire, const Vec3& direction_lamp) {
  return (luminaire.lamp_from_world.transpose() * direction_lamp).normalized();
}

}  // namespace

IndirectColumns::IndirectColumns(const RayScene& scene, std::vector<std::unique_ptr<SurfaceImportance>> fields,
                                 double flatness_error, std::uint64_t seed)
    : scene_(scene), fields_(std::move(fields)), flatness_error_(flatness_error), seed_(seed) {}

LuminaireRays IndirectColumns::prepare(const CandidateLuminaire& luminaire, std::uint32_t rays_per_replicate) const {
  LuminaireRays rays{luminaire, {}, {}};
  for (std::size_t k = 0; k < kReplicates; ++k) {
    const SobolSequence samples(mixed(mixed(seed_, kLampKey), k)), points(mixed(mixed(seed_, kGuidedKey), k));
    auto& leaving = rays.leaving.emplace_back();
    auto& guided = rays.guided.emplace_back();
    for (std::uint32_t i = 0; i < rays_per_replicate / 2; ++i) {
      const auto [u, v] = samples.pair(i, 0, 0);
      const DirectionSample drawn = luminaire.intensity->sample(u, v);
      const bool drawn_at_all = drawn.density_per_sr > 0 && std::isfinite(drawn.density_per_sr);
      const double candela = drawn_at_all ? luminaire.intensity->intensity_cd(drawn.direction) : 0;
      leaving.push_back({world_direction(luminaire, drawn.direction), candela, drawn.density_per_sr});
      guided.push_back(points.pair(i, 0, 0));
    }
  }
  return rays;
}

IndirectColumns::Met IndirectColumns::meet(const SurfaceImportance& field, const Vec3& lamp_world_m, double off_lamp_m,
                                           const Vec3& direction, std::uint64_t& rays) const {
  ++rays;
  const auto hit = scene_.nearest(lamp_world_m + off_lamp_m * direction, direction, Vec3::Zero());
  if (!hit) return {SurfaceCells::kNone, 0};
  const double reflectance = diffuse_reflectance(scene_.material_of(hit->triangle));
  if (!(reflectance > 0)) return {SurfaceCells::kNone, 0};
  const std::uint32_t cell = field.surfaces().find(hit->position_world_m, hit->normal_world, rays);
  if (cell == SurfaceCells::kNone || !field.live(cell)) return {SurfaceCells::kNone, 0};
  return {cell, reflectance};
}

/// Worth of a direction: what its light brings to each receiver, as a share of what all pilot rays bring there, summed
/// over receivers. So those that get little count as much as those that get much.
DirectionGuide IndirectColumns::guide(const CandidateLuminaire& lamp, std::span<const Vec3> lamps_world_m,
                                      std::uint64_t& rays) const {
  DirectionGuide guide;
  const SurfaceImportance& field = *fields_.front();
  const SobolSequence samples(mixed(seed_, kPilotKey));
  struct Pilot {
    Vec3 direction;
    WeightedRow met;
  };
  std::vector<Pilot> pilots;
  std::vector<WeightedRow> met_cells, met_patches;
  for (std::uint32_t i = 0; i < kPilotRays && !lamps_world_m.empty(); ++i) {
    const auto [u, v] = samples.pair(i, 0, 0);
    const DirectionSample drawn = lamp.intensity->sample(u, v);
    if (!(drawn.density_per_sr > 0)) continue;
    const double weight = lamp.intensity->intensity_cd(drawn.direction) / drawn.density_per_sr;
    if (!(weight > 0) || !std::isfinite(weight)) continue;
    // Neighbouring points of the sequence go to different places, so that each gets its share of all directions.
    const Vec3& from_m = lamps_world_m[i % lamps_world_m.size()];
    const Vec3 direction = world_direction(lamp, drawn.direction);
    const Met one = meet(field, from_m, kErrorsFromLamp * scene_.surface_error_m(from_m), direction, rays);
    if (one.cell == SurfaceCells::kNone) continue;
    pilots.push_back({direction, {one.cell, static_cast<float>(weight * one.reflectance)}});
    met_cells.push_back(pilots.back().met);
    met_patches.push_back({field.patch_of(one.cell), pilots.back().met.weight});
  }
  const std::size_t stride = field.stride();
  std::vector<float> per_share(stride, 0.0f);
  add_weighted_rows(field.first_rows(), met_cells, per_share);
  add_weighted_rows(field.further_rows(), met_patches, per_share);
  for (float& sum : per_share) sum = sum > 0 ? 1 / sum : 0;
  for (const Pilot& pilot : pilots) {
    const float* first = field.first_rows() + pilot.met.row * stride;
    const float* further = field.further_rows() + field.patch_of(pilot.met.row) * stride;
    float worth = 0;
    for (std::size_t r = 0; r < stride; ++r) worth += per_share[r] * (first[r] + further[r]);
    guide.add(pilot.direction, pilot.met.weight * worth);
  }
  guide.finish();
  return guide;
}

void IndirectColumns::evaluate(const LuminaireRays& luminaire, const Vec3& lamp_world_m, const DirectionGuide& guide,
                               bool may_give_up, Column& column) const {
  const std::size_t stride = fields_.front()->stride();
  const CandidateLuminaire& lamp = luminaire.luminaire;
  column.replicates.assign(kReplicates * stride, 0.0f);
  column.lux.assign(stride, 0.0f);
  column.standard_error_lux.assign(stride, 0.0f);
  column.rays = 0;
  column.given_up = false;
  const double off_lamp_m = kErrorsFromLamp * scene_.surface_error_m(lamp_world_m);
  const auto half = static_cast<double>(luminaire.leaving.front().size());
  bool met_any = false;
  for (std::size_t k = 0; k < kReplicates; ++k) {
    const SurfaceImportance& field = *fields_[k];
    column.met_cells.clear();
    column.met_patches.clear();
    const auto look = [&](const Vec3& direction, double candela, double own_density) {
      const Met one = meet(field, lamp_world_m, off_lamp_m, direction, column.rays);
      if (one.cell == SurfaceCells::kNone) return;
      const double lumens = candela / (half * (own_density + guide.density_per_sr(direction)));
      const auto reflected = static_cast<float>(lumens * one.reflectance);
      column.met_cells.push_back({one.cell, reflected});
      column.met_patches.push_back({field.patch_of(one.cell), reflected});
    };
    std::uint32_t first = 0;
    for (const LuminaireRays::Leaving& leaving : luminaire.leaving[k]) {
      if (k == 0 && may_give_up && guide.empty() && column.met_cells.empty() && first++ == kFirstRays) {
        column.given_up = true;
        return;
      }
      if (leaving.candela > 0) look(leaving.direction_world, leaving.candela, leaving.density_per_sr);
    }
    for (const auto& [u, v] : luminaire.guided[k]) {
      const Vec3 direction = guide.sample(u, v).direction;
      const Vec3 direction_lamp = lamp.lamp_from_world * direction;
      const double candela = lamp.intensity->intensity_cd(direction_lamp);
      if (candela > 0) look(direction, candela, lamp.intensity->density_per_sr(direction_lamp));
    }
    met_any |= !column.met_cells.empty();
    const auto sums = std::span(column.replicates).subspan(k * stride, stride);
    add_weighted_rows(field.first_rows(), column.met_cells, sums);
    add_weighted_rows(field.further_rows(), column.met_patches, sums);
  }
  if (!met_any) return;
  const double widened = student_t_975(kReplicates - 1) / 1.959963984540054;
  for (std::size_t r = 0; r < stride; ++r) {
    double mean = 0, squares = 0;
    for (std::size_t k = 0; k < kReplicates; ++k) mean += column.replicates[k * stride + r];
    mean /= kReplicates;
    for (std::size_t k = 0; k < kReplicates; ++k) {
      const double off = column.replicates[k * stride + r] - mean;
      squares += off * off;
    }
    column.lux[r] = static_cast<float>(mean);
    column.standard_error_lux[r] = static_cast<float>(
        std::hypot(widened * std::sqrt(squares / (kReplicates * (kReplicates - 1.0))), flatness_error_ * mean));
  }
}

std::size_t IndirectColumns::bytes() const {
  std::size_t sum = 0;
  for (const auto& field : fields_) sum += field->bytes();
  return sum;
}

}  // namespace luxrig
