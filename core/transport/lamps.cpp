#include "core/transport/lamps.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace luxrig {
namespace {

auto place_of(const Emitter& emitter) {
  const Vec3& p = emitter.world_from_lamp.translation_m;
  return std::tuple(p.x(), p.y(), p.z());
}

tl::unexpected<Fault> refusal(std::string detail) {
  return tl::unexpected(Fault{Cause::invalid, "", std::move(detail), {}});
}

std::string text_of(const Vec3& v) { return fmt::format("({:g}, {:g}, {:g})", v.x(), v.y(), v.z()); }

}  // namespace

Lamps::Lamps(std::span<const Emitter> emitters) {
  std::vector<std::size_t> order(emitters.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return place_of(emitters[a]) < place_of(emitters[b]); });
  lamps_.reserve(order.size());
  for (const std::size_t e : order) {
    const Emitter& emitter = emitters[e];
    const double half_cone_rad = emitter.intensity->emission_cone_rad() / 2;
    // The margin keeps rounding from cutting off the rim of the cone, where intensity_cd() decides.
    const double cos_half_cone = half_cone_rad < kPi ? std::cos(half_cone_rad) - 1e-9 : -2.0;
    if (groups_.empty() || groups_.back().position_world_m != emitter.world_from_lamp.translation_m)
      groups_.push_back({emitter.world_from_lamp.translation_m, lamps_.size(), lamps_.size()});
    lamps_.push_back({e, emitter.world_from_lamp.direction(-Vec3::UnitZ()), cos_half_cone,
                      emitter.world_from_lamp.rotation.transpose(), emitter.intensity.get()});
    groups_.back().end = lamps_.size();
  }
}

double smallest_distance_m(const Vec3& a_world_m, const Vec3& b_world_m) {
  const double size_m = std::max(a_world_m.cwiseAbs().maxCoeff(), b_world_m.cwiseAbs().maxCoeff());
  // Error of d: each point off by size·ε/2, so 2·size·ε/2; error of d⁻² twice its relative error.
  return std::max(2e6 * size_m * std::numeric_limits<double>::epsilon(), 1e-100);
}

Result<void> check_evaluation(std::span<const Receiver> receivers, std::span<const Emitter> emitters,
                              const EvaluateOptions& options) {
  if (!(options.wanted_relative_error > 0) || !std::isfinite(options.wanted_relative_error))
    return refusal(fmt::format("wanted relative error is {:g}; it must be above 0", options.wanted_relative_error));
  if (!options.levels.empty() && options.levels.size() != emitters.size())
    return refusal(fmt::format("{} levels for {} emitters", options.levels.size(), emitters.size()));
  for (std::size_t e = 0; e < options.levels.size(); ++e)
    if (!(options.levels[e] >= 0) || !std::isfinite(options.levels[e]))
      return refusal(
          fmt::format("level of emitter {} is {:g}; it must be finite and at least 0", e, options.levels[e]));
  for (std::size_t r = 0; r < receivers.size(); ++r) {
    const Receiver& receiver = receivers[r];
    if (!receiver.position_world_m.allFinite() || !receiver.normal_world.allFinite())
      return refusal(fmt::format("receiver {} is not finite: position {}, normal {}", r,
                                 text_of(receiver.position_world_m), text_of(receiver.normal_world)));
    if (std::abs(receiver.normal_world.norm() - 1) > 1e-6)
      return refusal(fmt::format("normal of receiver {} has length {:g}, not 1", r, receiver.normal_world.norm()));
  }
  for (std::size_t e = 0; e < emitters.size(); ++e) {
    const Emitter& emitter = emitters[e];
    if (!emitter.intensity) return refusal(fmt::format("emitter {} has no intensity distribution", e));
    const Pose& pose = emitter.world_from_lamp;
    if (!pose.rotation.allFinite() || !pose.translation_m.allFinite())
      return refusal(fmt::format("pose of emitter {} is not finite", e));
    if (!(pose.rotation.transpose() * pose.rotation).isIdentity(1e-6))
      return refusal(fmt::format("rotation of emitter {} is not a rotation", e));
    for (std::size_t r = 0; r < receivers.size(); ++r) {
      const Vec3& at = receivers[r].position_world_m;
      const double distance_m = (at - pose.translation_m).norm();
      if (distance_m <= smallest_distance_m(at, pose.translation_m))
        return refusal(fmt::format("emitter {} lies in receiver {} at {} (distance {:g} m): its lux there is infinite",
                                   e, r, text_of(at), distance_m));
    }
  }
  return {};
}

}  // namespace luxrig
