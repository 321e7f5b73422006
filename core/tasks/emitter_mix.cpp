#include "core/tasks/emitter_mix.h"

#include <Eigen/QR>
#include <optional>

#include "core/photometry/light_colour.h"

namespace luxrig {
namespace {

/// Colours that are nearer to each other are the same.
constexpr double kSameColour_uv = 1e-4;

Eigen::Vector2d uv_of(const Vec3& rgb) {
  const Chromaticity xy = xy_of_rgb(rgb);
  const double sum = -2 * xy.x() + 12 * xy.y() + 3;
  return {4 * xy.x() / sum, 9 * xy.y() / sum};
}

/// The mix of some emitters next to the colour; none if one of them would have to take light away.
std::optional<EmitterMix> mix_of(const std::vector<EmitterLight>& emitters, const std::vector<std::size_t>& some,
                                 const Vec3& wanted_rgb) {
  Eigen::Matrix3Xd light(3, std::ssize(some));
  for (std::size_t k = 0; k < some.size(); ++k)
    light.col(static_cast<Eigen::Index>(k)) = emitters[some[k]].lumens * emitters[some[k]].rgb;
  const Eigen::VectorXd weight = light.colPivHouseholderQr().solve(wanted_rgb);
  if (!weight.allFinite() || weight.minCoeff() < 0 || !(weight.maxCoeff() > 0)) return std::nullopt;
  EmitterMix mix;
  mix.levels.assign(emitters.size(), 0);
  mix.flux_share = 0;
  for (std::size_t k = 0; k < some.size(); ++k) {
    mix.levels[some[k]] = weight[static_cast<Eigen::Index>(k)] / weight.maxCoeff();
    mix.flux_share += mix.levels[some[k]] * emitters[some[k]].lumens;
  }
  mix.off_uv = (uv_of(light * weight) - uv_of(wanted_rgb)).norm();
  return mix;
}

}  // namespace

EmitterMix mix_of_colour(const std::vector<EmitterLight>& emitters, const Vec3& wanted_rgb) {
  std::vector<std::size_t> lit;
  double all_lm = 0;
  for (std::size_t e = 0; e < emitters.size(); ++e) {
    if (emitters[e].lumens > 0) lit.push_back(e);
    all_lm += emitters[e].lumens;
  }
  std::optional<EmitterMix> best;
  const auto take = [&](const std::vector<std::size_t>& some) {
    auto mix = mix_of(emitters, some, wanted_rgb);
    if (!mix) return;
    mix->flux_share /= all_lm;
    const double nearer = best ? best->off_uv - mix->off_uv : 1;
    if (nearer > kSameColour_uv || (nearer > -kSameColour_uv && mix->flux_share > best->flux_share)) best = mix;
  };
  for (std::size_t a = 0; a < lit.size(); ++a) {
    take({lit[a]});
    for (std::size_t b = a + 1; b < lit.size(); ++b) {
      take({lit[a], lit[b]});
      for (std::size_t c = b + 1; c < lit.size(); ++c) take({lit[a], lit[b], lit[c]});
    }
  }
  return best.value_or(EmitterMix{std::vector<double>(emitters.size(), 1), 1, 0});
}

}  // namespace luxrig
