#pragma once
/// Internal to light_domain*.cpp: the data of a LightDomain.

#include <embree3/rtcore.h>

#include "core/highlight/lights/light_domain.h"

namespace luxrig {

struct LightDomain::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Vec3 centre_world_m = Vec3::Zero();
  DirectionBins bins;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> layer_of_group;
  double size_m = 0;              // from the centre to the farthest corner
  std::vector<Vec3f> vertices_m;  // three per triangle, and one extra for Embree
  std::vector<std::array<std::uint32_t, 3>> indices;

  explicit State(int cell_side) : bins(cell_side) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  void build();  // light_domain_rays.cpp
};

}  // namespace luxrig
