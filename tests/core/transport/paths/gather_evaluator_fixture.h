#pragma once
/// Shared by the tests of gather_evaluator.

#include <gtest/gtest.h>

#include "core/transport/evaluator.h"
#include "tests/core/transport/boxes.h"

namespace luxrig::gather_evaluator_fixture {

inline TransportMatrix evaluated(const std::unique_ptr<Evaluator>& by, const std::vector<Receiver>& receivers,
                                 const std::vector<Emitter>& emitters, const EvaluateOptions& options) {
  auto result = by->evaluate(receivers, emitters, options);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().detail);
  return result ? *result : TransportMatrix{};
}

inline Emitter bulb(double flux_lm, const Vec3& position_m) {
  return {make_isotropic(flux_lm), {Mat3::Identity(), position_m}};
}

}  // namespace luxrig::gather_evaluator_fixture
