#include "core/transport/candidates/direct_columns.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr double kRoundings = 2e6 * std::numeric_limits<double>::epsilon();

}  // namespace

std::vector<CandidateLuminaire> luminaires_ready(std::span<const Emitter> luminaires) {
  std::vector<CandidateLuminaire> ready;
  for (const Emitter& e : luminaires) {
    const double half_cone_rad = e.intensity->emission_cone_rad() / 2;
    ready.push_back({e.world_from_lamp.rotation.transpose(), e.world_from_lamp.translation_m,
                     e.world_from_lamp.direction(-Vec3::UnitZ()),
                     // The margin keeps rounding from cutting off the rim, where intensity_cd() decides.
                     half_cone_rad < kPi ? std::cos(half_cone_rad) - 1e-9 : -2.0, e.intensity.get(),
                     e.intensity->max_intensity_cd()});
  }
  return ready;
}

double unobstructed_lux(const CandidateLuminaire& luminaire, const Vec3& lamp_world_m, const Receiver& receiver) {
  const Vec3 towards_m = lamp_world_m - receiver.position_world_m;
  const double height_m = receiver.normal_world.dot(towards_m);
  if (!(height_m > 0)) return 0;
  const double distance_squared_m2 = towards_m.squaredNorm();
  // As in smallest_distance_m() of core/transport/direct/emitter_sampler.h: nearer, coordinates cannot distinguish the two.
  const double rounding_m = kRoundings * receiver.position_world_m.cwiseAbs().maxCoeff();
  if (distance_squared_m2 <= rounding_m * rounding_m) return 0;
  const double per_distance = 1 / std::sqrt(distance_squared_m2);
  const Vec3 leaving_world = -per_distance * towards_m;
  if (luminaire.axis_world.dot(leaving_world) < luminaire.cos_half_cone) return 0;
  const double lux_per_candela = height_m * per_distance / distance_squared_m2;
  if (!std::isfinite(lux_per_candela)) return 0;
  const double lux = lux_per_candela * luminaire.intensity->intensity_cd(luminaire.lamp_from_world * leaving_world);
  return lux > 0 ? std::min<double>(lux, std::numeric_limits<float>::max()) : 0;
}

bool direct_of_block(const VisibilityScene& scene, std::span<const Receiver> receivers,
                     std::span<const Vec3> positions_world_m, const std::vector<std::uint8_t>& use,
                     std::span<const CandidateLuminaire> luminaires, const CandidateOptions& options,
                     std::vector<float>& lux, CandidateStatistics& statistics) {
  const std::size_t positions = positions_world_m.size(), kinds = luminaires.size();
  lux.assign(receivers.size() * positions * kinds, 0.0f);
  // Luminaires at one place share their shadow rays: one group of luminaires per distinct offset.
  for (std::size_t first = 0; first < kinds; ++first) {
    const Vec3& offset_m = luminaires[first].offset_world_m;
    std::vector<std::size_t> group;
    bool done_before = false;
    for (std::size_t l = 0; l < kinds; ++l)
      if (luminaires[l].offset_world_m == offset_m) {
        done_before |= l < first;
        group.push_back(l);
      }
    if (done_before) continue;
    std::vector<Vec3> lamps_world_m;  // of the positions in use
    std::vector<std::uint32_t> position_of_lamp;
    double peak_cd = 0;
    for (const std::size_t l : group) peak_cd = std::max(peak_cd, luminaires[l].peak_cd);
    for (std::uint32_t p = 0; p < positions; ++p)
      if (use[p]) {
        lamps_world_m.push_back(positions_world_m[p] + offset_m);
        position_of_lamp.push_back(p);
      }
    const PointTree tree(lamps_world_m);
    std::vector<CandidateStatistics> counted(receivers.size());
    parallel_for(receivers.size(), options.threads, [&](std::size_t r) {
      if (options.watch.stop.stop_requested()) return;
      CandidateStatistics& count = counted[r];
      float* row = lux.data() + r * positions * kinds;
      std::vector<double> possible_lux(group.size());
      VisiblePoints visible(scene, receivers[r], options.skips, peak_cd, options.min_lux);
      visible.visit(
          tree, lamps_world_m,
          [&](std::uint32_t point) {
            double max_lux = 0;
            for (std::size_t g = 0; g < group.size(); ++g) {
              possible_lux[g] = unobstructed_lux(luminaires[group[g]], lamps_world_m[point], receivers[r]);
              if (possible_lux[g] == 0) ++count.pairs_dark;
              max_lux = std::max(max_lux, possible_lux[g]);
            }
            if (max_lux == 0) return false;
            if (options.skips.reach && max_lux < options.min_lux) {
              for (const double possible : possible_lux) count.pairs_out_of_reach += possible > 0;
              return false;
            }
            for (const double possible : possible_lux) count.pairs_traced += possible > 0;
            return true;
          },
          [&](std::uint32_t point) {
            const double through =
                scene.rays ? scene.rays->transmittance(receivers[r].position_world_m, lamps_world_m[point]) : 1;
            for (std::size_t g = 0; g < group.size(); ++g) {
              count.pairs_lit += possible_lux[g] > 0;
              row[position_of_lamp[point] * kinds + group[g]] = static_cast<float>(through * possible_lux[g]);
            }
          });
      count.pairs_behind = visible.behind * group.size();
      count.pairs_out_of_reach += visible.out_of_reach * group.size();
      count.pairs_blocked_in_groups = visible.blocked_in_groups * group.size();
      count.rays = visible.rays;
    });
    if (options.watch.stop.stop_requested()) return false;
    for (const CandidateStatistics& count : counted) statistics.add(count);
  }
  return true;
}

}  // namespace luxrig
