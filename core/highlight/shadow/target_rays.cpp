#include "core/highlight/shadow/target_rays.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/check.h"

namespace luxrig {

struct TargetRays::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Vec3 middle_world_m = Vec3::Zero();
  std::vector<Vec3f> vertices_m;  // relative to the middle, where float is most accurate; one extra for Embree
  std::vector<std::array<std::uint32_t, 3>> triangles;
  double diagonal_m = 0;

  [[nodiscard]] double min_lift_m() const;
  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

TargetRays::TargetRays(const Scene& target) : state_(std::make_unique<State>()) {
  State& state = *state_;
  Eigen::AlignedBox3d box;
  for (const auto& triangle : target.triangles) {
    for (const std::uint32_t vertex : triangle) {
      LUXRIG_CHECK(vertex < target.vertices_m.size(), "vertex {} of {}", vertex, target.vertices_m.size());
      LUXRIG_CHECK(target.vertices_m[vertex].allFinite(), "vertex {}", vertex);
      box.extend(target.vertices_m[vertex].cast<double>());
    }
  }
  const Vec3 middle_m = box.isEmpty() ? Vec3::Zero() : Vec3(box.center());
  state.middle_world_m = target.origin_world_m + middle_m;
  state.diagonal_m = box.isEmpty() ? 0 : box.diagonal().norm();
  for (const Vec3f& v : target.vertices_m) state.vertices_m.push_back((v.cast<double>() - middle_m).cast<float>());
  state.vertices_m.push_back(Vec3f::Zero());
  state.triangles = target.triangles;

  // No files from the working folder or home may change the tracing. Medium quality, since results must not depend on
  // thread timing.
  state.device = rtcNewDevice("ignore_config_files=1,set_affinity=0");
  LUXRIG_CHECK(state.device != nullptr, "Embree error {}", static_cast<int>(rtcGetDeviceError(nullptr)));
  state.scene = rtcNewScene(state.device);
  rtcSetSceneFlags(state.scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(state.scene, RTC_BUILD_QUALITY_MEDIUM);
  if (!state.triangles.empty()) {
    RTCGeometry geometry = rtcNewGeometry(state.device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, state.vertices_m.data(), 0,
                               sizeof(Vec3f), state.vertices_m.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, state.triangles.data(), 0,
                               sizeof(state.triangles[0]), state.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(state.scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(state.scene);
  const RTCError error = rtcGetDeviceError(state.device);
  LUXRIG_CHECK(error == RTC_ERROR_NONE, "Embree error {}", static_cast<int>(error));
}

TargetRays::~TargetRays() = default;
TargetRays::TargetRays(TargetRays&&) noexcept = default;
TargetRays& TargetRays::operator=(TargetRays&&) noexcept = default;

namespace {

/// aim(i, direction, end): sets the direction of ray i, and its end in lengths of that.
template <class Aim>
void cast_at_target(RTCScene scene, const Vec3f& start, const Aim& aim, std::span<std::uint8_t> blocked) {
  constexpr std::size_t kWide = 16;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RTCRay16 rays;
  for (std::size_t k = 0; k < kWide; ++k) {
    rays.org_x[k] = start.x();
    rays.org_y[k] = start.y();
    rays.org_z[k] = start.z();
    rays.tnear[k] = 0;
    rays.time[k] = 0;
    rays.mask[k] = ~0u;
    rays.id[k] = 0;
    rays.flags[k] = 0;
  }
  for (std::size_t begin = 0; begin < blocked.size(); begin += kWide) {
    const std::size_t count = std::min(kWide, blocked.size() - begin);
    alignas(64) std::array<int, kWide> valid{};
    for (std::size_t k = 0; k < kWide; ++k) {
      Vec3f direction;
      float end = std::numeric_limits<float>::infinity();
      aim(begin + std::min(k, count - 1), direction, end);
      valid[k] = k < count && end > 0 ? -1 : 0;
      rays.dir_x[k] = direction.x();
      rays.dir_y[k] = direction.y();
      rays.dir_z[k] = direction.z();
      // On processors without 16 lanes, Embree 3.13 also casts invalid lanes.
      rays.tfar[k] = valid[k] != 0 ? end : -std::numeric_limits<float>::infinity();
    }
    rtcOccluded16(valid.data(), scene, &context, &rays);
    for (std::size_t k = 0; k < count; ++k) blocked[begin + k] = valid[k] != 0 && rays.tfar[k] < 0;
  }
}

}  // namespace

double TargetRays::State::min_lift_m() const { return diagonal_m * 0x1p-18 * std::numbers::sqrt2 / 2; }

void TargetRays::blocked(const Vec3& from_world_m, const Vec3& normal_world, double lift_m,
                         std::span<const Vec3f> directions_world, std::span<std::uint8_t> blocked) const {
  LUXRIG_CHECK(blocked.size() == directions_world.size(), "{} answers for {} directions", blocked.size(),
               directions_world.size());
  const State& state = *state_;
  const double lifted_m = lift_m + state.min_lift_m();
  const Vec3f start = (from_world_m - state.middle_world_m + lifted_m * normal_world).cast<float>();
  cast_at_target(
      state.scene, start, [&](std::size_t i, Vec3f& direction, float&) { direction = directions_world[i]; }, blocked);
}

void TargetRays::blocked_before(const Vec3& from_world_m, const Vec3& normal_world, double lift_m,
                                std::span<const Vec3> to_world_m, std::span<std::uint8_t> blocked) const {
  LUXRIG_CHECK(blocked.size() == to_world_m.size(), "{} answers for {} places", blocked.size(), to_world_m.size());
  const State& state = *state_;
  const double min_m = state.min_lift_m();
  const Vec3f start = (from_world_m - state.middle_world_m + (lift_m + min_m) * normal_world).cast<float>();
  cast_at_target(
      state.scene, start,
      [&](std::size_t i, Vec3f& direction, float& end) {
        const Vec3 way_m = to_world_m[i] - state.middle_world_m - start.cast<double>();
        const double length_m = way_m.norm();
        direction = way_m.cast<float>();
        end = length_m > 0 ? static_cast<float>(1 - min_m / length_m) : 0;
      },
      blocked);
}

}  // namespace luxrig
