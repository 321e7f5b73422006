#pragma once
/// Shared by the tests of aim_heads.

#include <gtest/gtest.h>

#include <algorithm>

#include "core/highlight/aim/aim_heads.h"
#include "core/highlight/surface/relief_study.h"
#include "tests/core/highlight/shapes.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig::aim_heads_fixture {

/// A coarse version of the carved relief, and heads on a rail 2 m in front of it.
struct AimedRelief {
  Scene scene = make_carved_relief(0.02);
  RayScene room{scene};
  ReliefStudy study;
  ContrastSamples samples;

  AimedRelief() : study(of(scene)), samples(one_ring_samples(study.surface, study.interest)) {}
  static ReliefStudy of(const Scene& scene) {
    ReliefStudyOptions options;
    options.interest.max_points = 600;
    auto study = study_relief(scene, options);
    EXPECT_TRUE(study);
    return std::move(*study);
  }
  Result<HeadAims> aims(std::vector<HangingHead> heads, AimWishes wishes = {}, AimOptions options = {}) const {
    return HeadAims::make(samples, study.features, room, std::move(heads), std::move(wishes), options);
  }
};

inline const AimedRelief& aimed_relief() {
  static const AimedRelief relief;
  return relief;
}

inline HangingHead head_at(const Vec3& place_m, double exponent = 60) {
  HangingHead head;
  head.world_from_mount.translation_m = place_m;
  head.zoom = {{make_cosine_power(2000, exponent)}};
  head.watts = 50;
  return head;
}

inline std::vector<HangingHead> rail_of_heads(int count) {
  std::vector<HangingHead> heads;
  for (int i = 0; i < count; ++i)
    heads.push_back(head_at({-1.8 + 3.6 * i / std::max(1, count - 1), -0.6 - 0.25 * (i % 3), 1.5}));
  return heads;
}

inline HeadSetting looking(const HangingHead& head, const Vec3& aim_m, double level, std::size_t zoom = 0) {
  const auto joints =
      pan_tilt_towards(head.world_from_mount, aim_m - head.world_from_mount.translation_m, head.range, head.present);
  EXPECT_TRUE(joints);
  return {*joints, zoom, level};
}

}  // namespace luxrig::aim_heads_fixture
