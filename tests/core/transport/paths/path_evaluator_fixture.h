#pragma once
/// Shared by the tests of path_evaluator.

#include <gtest/gtest.h>

#include "core/transport/evaluator.h"
#include "tests/core/transport/cube_radiosity.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig::path_evaluator_fixture {

inline std::vector<Receiver> receivers_on(const Scene& scene, std::size_t count) {
  std::vector<Receiver> receivers;
  for (const WallPoint& p : spread_over_walls(scene, count, Vec3::Zero()))
    receivers.push_back({p.position_m, p.normal});
  return receivers;
}

inline Emitter bulb_at(double flux_lm, const Vec3& position_m) {
  return {make_isotropic(flux_lm), {Mat3::Identity(), position_m}};
}

inline TransportMatrix path(const RayScene& scene, const std::vector<Receiver>& receivers,
                            const std::vector<Emitter>& emitters, const EvaluateOptions& options) {
  auto result = make_path_evaluator(scene)->evaluate(receivers, emitters, options);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().detail);
  return result ? *result : TransportMatrix{};
}

}  // namespace luxrig::path_evaluator_fixture
