#pragma once
/// Shared by the tests of what is seen: shapes, and the light of a distant lamp on their samples.

#include <gtest/gtest.h>

#include "core/highlight/seen/seen_contrast.h"
#include "tests/core/highlight/shapes.h"

namespace luxrig::seen_fixture {

inline SeenView view_on(const RayScene& room, const RayScene& object, const Vec3& eye_m, int across_px = 96) {
  SeenViewOptions options;
  options.across_px = across_px;
  auto view = see_object(room, object, eye_m, options);
  EXPECT_TRUE(view) << view.error().detail;
  return std::move(*view);
}

/// Lux of 1 lx from a direction (unit, towards the light), shadows included.
inline std::vector<float> distant_lux(const RayScene& room, std::span<const OrientedPoint> samples,
                                      const Vec3& towards) {
  std::vector<float> lux;
  for (const OrientedPoint& at : samples) {
    const double cosine = at.normal.dot(towards);
    const bool lit = cosine > 0 && !room.occluded(at.position_world_m, at.normal, at.position_world_m + 1e3 * towards);
    lux.push_back(lit ? static_cast<float>(cosine) : 0);
  }
  return lux;
}

/// Ridges along y on a square of 1 m that faces up: height amplitude · cos.
inline Scene ridges(int count, double amplitude_m) {
  return parametric(
      400, 4, [=](double u, double v) { return Vec3(u - 0.5, v - 0.5, amplitude_m * std::cos(2 * kPi * count * u)); });
}

/// Towards a light at this height above the plane z = 0, from +x.
inline Vec3 at_height(double height_deg) {
  return {std::cos(rad_from_deg(height_deg)), 0, std::sin(rad_from_deg(height_deg))};
}

}  // namespace luxrig::seen_fixture
