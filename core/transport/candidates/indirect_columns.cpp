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

constexpr std::uint64_t kLampKey = 0x6c616d70;

}  // namespace

std::vector<LeavingRay> leaving_rays(const CandidateLuminaire& luminaire, std::uint32_t count, std::uint64_t seed) {
  const SobolSequence samples(mixed(seed, kLampKey));
  std::vector<LeavingRay> rays;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [u, v] = samples.pair(i, 0, 0);
    const DirectionSample drawn = luminaire.intensity->sample(u, v);
    double lumens = 0;
    if (drawn.density_per_sr > 0)
      lumens = luminaire.intensity->intensity_cd(drawn.direction) / (drawn.density_per_sr * count);
    rays.push_back({luminaire.lamp_from_world.transpose() * drawn.direction, std::isfinite(lumens) ? lumens : 0});
  }
  return rays;
}

IndirectColumns::IndirectColumns(const RayScene& scene, std::vector<std::unique_ptr<SurfaceImportance>> fields,
                                 std::span<const CandidateLuminaire> luminaires, std::uint32_t rays_per_replicate,
                                 std::uint64_t seed)
    : scene_(scene), fields_(std::move(fields)), rays_per_replicate_(rays_per_replicate) {
  for (std::size_t l = 0; l < luminaires.size(); ++l)
    for (std::size_t k = 0; k < kReplicates; ++k)
      leaving_.push_back(leaving_rays(luminaires[l], rays_per_replicate, mixed(mixed(seed, l), k)));
}

void IndirectColumns::evaluate(std::size_t luminaire, const Vec3& lamp_world_m, bool may_give_up,
                               Column& column) const {
  const std::size_t stride = fields_.front()->stride();
  column.replicates.assign(kReplicates * stride, 0.0f);
  column.rays = 0;
  column.given_up = false;
  const double off_lamp_m = kErrorsFromLamp * scene_.surface_error_m(lamp_world_m);
  bool met_live = false;
  for (std::size_t k = 0; k < kReplicates && !column.given_up; ++k) {
    const SurfaceImportance& field = *fields_[k];
    float* sums = column.replicates.data() + k * stride;
    const auto& leaving = leaving_[luminaire * kReplicates + k];
    for (std::uint32_t i = 0; i < leaving.size(); ++i) {
      if (may_give_up && !met_live && k == 0 && i == kFirstRays) {
        column.given_up = true;
        break;
      }
      const LeavingRay& ray = leaving[i];
      if (!(ray.lumens > 0)) continue;
      ++column.rays;
      const auto hit =
          scene_.nearest(lamp_world_m + off_lamp_m * ray.direction_world, ray.direction_world, Vec3::Zero());
      if (!hit) continue;
      const double reflectance = diffuse_reflectance(scene_.material_of(hit->triangle));
      if (!(reflectance > 0)) continue;
      const std::uint32_t cell = field.surfaces().find(hit->position_world_m, hit->normal_world, column.rays);
      if (cell == SurfaceCells::kNone || !field.live(cell)) continue;
      met_live = true;
      const auto lumens = static_cast<float>(ray.lumens * reflectance);
      const float* row = field.row(cell).data();
      for (std::size_t r = 0; r < stride; ++r) sums[r] += lumens * row[r];
    }
  }
  column.lux.assign(stride, 0.0f);
  column.standard_error_lux.assign(stride, 0.0f);
  if (!met_live) return;
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
    column.standard_error_lux[r] =
        static_cast<float>(widened * std::sqrt(squares / (kReplicates * (kReplicates - 1.0))));
  }
}

std::size_t IndirectColumns::bytes() const {
  std::size_t sum = leaving_.size() * rays_per_replicate_ * sizeof(LeavingRay);
  for (const auto& field : fields_) sum += field->bytes();
  return sum;
}

}  // namespace luxrig
