#include "tools/luxrig/render/dark_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/transport/sobol.h"

namespace luxrig {
namespace {

constexpr double kDark_lx = 0.1;  // full moon
constexpr double kClose_m = 0.1;
constexpr std::uint32_t kLampRays = 64;
constexpr double kNearlyAll = 0.9;
constexpr std::size_t kMaxLampsNamed = 6;

/// Where the light of a lamp goes: the fate of nine rays in ten.
std::string fate_of(const RayScene& scene, const Emitter& lamp) {
  std::vector<double> distances_m;
  std::uint32_t sent = 0;
  const SobolSequence samples(mixed(1, 0xda4c));
  for (std::uint32_t i = 0; i < kLampRays; ++i) {
    const auto [u, v] = samples.pair(i, 0, 0);
    const DirectionSample drawn = lamp.intensity->sample(u, v);
    if (!(drawn.density_per_sr > 0) || !(lamp.intensity->intensity_cd(drawn.direction) > 0)) continue;
    ++sent;
    const auto hit = scene.nearest(lamp.world_from_lamp.translation_m, lamp.world_from_lamp.rotation * drawn.direction,
                                   Vec3::Zero());
    if (hit) distances_m.push_back(hit->distance_m);
  }
  std::sort(distances_m.begin(), distances_m.end());
  const auto enough = static_cast<std::size_t>(kNearlyAll * sent);
  if (distances_m.size() <= sent - enough) return "shines past everything";
  if (enough > 0 && distances_m.size() >= enough && distances_m[enough - 1] < kClose_m)
    return fmt::format("is blocked: its light ends within {:.0f} mm", 1e3 * distances_m[enough - 1]);
  return "lights what is not in view";
}

}  // namespace

std::string why_dark(const Picture& picture, const RayScene& scene, const Rig& rig, std::span<const Emitter> emitters,
                     std::span<const double> levels, const std::string& when_set) {
  std::vector<float> lux;
  for (const float lx : picture.illuminance_lx)
    if (lx >= 0) lux.push_back(lx);
  if (lux.empty()) return "the picture shows nothing: no surface is in view; look elsewhere with --eye and --target";
  std::sort(lux.begin(), lux.end());
  const double max_lx = lux[static_cast<std::size_t>(0.999 * static_cast<double>(lux.size() - 1))];
  if (max_lx >= kDark_lx) return "";
  std::vector<std::size_t> on;
  bool daylight = false;
  double lumens = 0;
  for (std::size_t e = 0; e < emitters.size(); ++e) {
    if (!(levels[e] > 0)) continue;
    if (emitters[e].sky) {
      daylight = true;
    } else {
      on.push_back(e);
      lumens += levels[e] * emitters[e].intensity->flux_lm();
    }
  }
  if (rig.fixtures.empty() && !daylight) return "the picture is dark: the rig has no fixture and no daylight";
  if (on.empty() && !daylight) {
    return fmt::format("the picture is dark: no lamp gives light, all {} are at level 0 {}", rig.fixtures.size(),
                       when_set);
  }
  std::string text = fmt::format("the picture is dark: nothing in view gets more than {:.2g} lx", max_lx);
  if (daylight) text += "; no daylight comes in where the camera looks";
  if (on.empty()) return text;
  text += fmt::format(". {} on {}, {:.3g} lm together:",
                      on.size() == 1 ? "One lamp is" : fmt::format("{} lamps are", on.size()), when_set, lumens);
  for (std::size_t i = 0; i < std::min(on.size(), kMaxLampsNamed); ++i)
    text += fmt::format("{} {} {}", i == 0 ? "" : ",", rig.fixtures[on[i]].name, fate_of(scene, emitters[on[i]]));
  if (on.size() > kMaxLampsNamed) text += fmt::format(", and {} more", on.size() - kMaxLampsNamed);
  return text;
}

}  // namespace luxrig
