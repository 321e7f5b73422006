#pragma once
/// A head that hangs and turns in some way, as bad as rigs are.

#include <cmath>
#include <random>

#include "core/calibration/head_pose.h"

namespace luxrig {

inline HeadPose random_head(std::mt19937_64& random) {
  std::uniform_real_distribution<double> signed_unit(-1, 1);
  const auto vector = [&](double most) -> Vec3 {
    return most * Vec3(signed_unit(random), signed_unit(random), signed_unit(random));
  };
  HeadPose head;
  head.stated = displaced({}, vector(3), vector(2));
  head.upside_down = random() % 2;
  head.parameters.segment<3>(kHeadOffset) = vector(0.2);
  head.parameters.segment<3>(kHeadTurn) = vector(0.1);
  head.parameters.segment<2>(kHeadAskew) = 0.05 * Eigen::Vector2d(signed_unit(random), signed_unit(random));
  head.parameters[kHeadPanScale] = (random() % 2 ? 1 : -1) * (1 + 0.15 * signed_unit(random));
  head.parameters[kHeadTiltScale] = (random() % 2 ? 1 : -1) * (1 + 0.01 * signed_unit(random));
  head.parameters[kHeadPanPlay] = 0.03 * std::abs(signed_unit(random));
  head.parameters[kHeadTiltPlay] = 0.03 * std::abs(signed_unit(random));
  return head;
}

}  // namespace luxrig
