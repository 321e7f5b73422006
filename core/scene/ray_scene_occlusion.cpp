/// Shadow rays.
///
/// A ray runs to its target, minus a margin for rounding. A target is often on a surface (a lamp flush with the
/// ceiling). A slanted ray may hit that surface before its end, by the rounding error divided by the cosine. But a
/// straight line that ends in a plane crosses it nowhere else. So a triangle whose plane contains the target, within
/// rounding, is no obstacle, and a filter lets the ray pass it. Ending rays earlier instead (by 32 e, for up to 88°)
/// missed obstacles within that distance of a lamp: a third of a millimetre in a room of 10 m.

#include <limits>

#include "core/check.h"
#include "core/scene/ray_scene_state.h"

namespace luxrig {

/// Targets and scene for the filter. Embree passes the context through.
struct RayScene::State::Targets {
  RTCIntersectContext context;  // must be first: Embree's pointer to it also points to this struct
  const State* state;
  const Vec3* to_m;       ///< by ray id
  const double* error_m;  ///< by ray id
};

namespace {

/// A triangle within this many surface errors of the target is taken to hold it: its own error and the target's.
constexpr double kOnSurface = 2;
/// Only hits in the last part of a ray are examined. Earlier hits are obstacles, unless the ray grazes the target's
/// surface to within e over that part of its length.
constexpr float kLastPart = 1.0f / 16;

}  // namespace

void RayScene::State::pass_what_holds_the_target(const RTCFilterFunctionNArguments* arguments) {
  const auto* targets = reinterpret_cast<const Targets*>(arguments->context);
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    // The ray's length is 1 in units of its direction.
    if (RTCRayN_tfar(arguments->ray, arguments->N, i) < 1 - kLastPart) continue;
    const unsigned id = RTCRayN_id(arguments->ray, arguments->N, i);
    const auto& triangle = targets->state->triangles[RTCHitN_primID(arguments->hit, arguments->N, i)];
    const Vec3 normal(triangle.normal[0], triangle.normal[1], triangle.normal[2]);
    const double above_m = normal.dot(targets->to_m[id] - triangle.corners_m[0].cast<double>());
    if (std::abs(above_m) <= kOnSurface * targets->error_m[id]) arguments->valid[i] = 0;
  }
}

/// Sets up a ray from a surface point; false if it has no length. Its direction is not unit: it reaches the target at
/// 1.
bool RayScene::State::aim(const Vec3& from_m, const Vec3& normal, const Vec3& to_m, double error_m, RTCRay& ray) const {
  const Vec3 straight_m = to_m - from_m;
  // In float, which is faster and precise enough for offsets of a few e. Infinite below 1e-19 m, which counts as no
  // length.
  const double per_distance = 1 / std::sqrt(static_cast<float>(straight_m.squaredNorm()));
  if (!std::isfinite(per_distance)) return false;
  const Vec3f start_m = start(from_m, per_distance * straight_m, normal).cast<float>();
  // Aimed from its actual start, so that it ends in the right place.
  const Vec3f way_m = (to_m - start_m.cast<double>()).cast<float>();
  // The end is off by the surface error and by the rounding of the direction (√3 u per metre).
  const double length = 1 - error_m * per_distance - 2 * kUnit;
  if (!(length > 0)) return false;
  ray.org_x = start_m.x();
  ray.org_y = start_m.y();
  ray.org_z = start_m.z();
  ray.dir_x = way_m.x();
  ray.dir_y = way_m.y();
  ray.dir_z = way_m.z();
  ray.tnear = 0;
  ray.tfar = static_cast<float>(length);
  ray.time = 0;
  ray.mask = ~0u;
  ray.id = 0;
  ray.flags = 0;
  return true;
}

void RayScene::State::build() {
  // Files in the working folder or home must not change how rays are traced.
  device = rtcNewDevice("ignore_config_files=1,set_affinity=0");
  LUXRIG_CHECK(device != nullptr, "Embree error {}", static_cast<int>(rtcGetDeviceError(nullptr)));
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);  // watertight along shared edges
  // Medium, not high: spatial splits depend on thread timing, and results must not.
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  if (!triangles.empty()) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_m.data(), 0,
                               sizeof(Vec3f), vertices_m.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0,
                               sizeof(indices[0]), indices.size());
    rtcSetGeometryOccludedFilterFunction(geometry, pass_what_holds_the_target);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene);
  const RTCError error = rtcGetDeviceError(device);
  LUXRIG_CHECK(error == RTC_ERROR_NONE, "Embree error {} with {} triangles", static_cast<int>(error), triangles.size());
}

bool RayScene::occluded(const Vec3& from_world_m, const Vec3& from_normal_world, const Vec3& to_world_m) const {
  const State& state = *state_;
  const Vec3 to_m = to_world_m - state.origin_world_m;
  const double error_m = state.error_m(to_m);
  RTCRay ray;
  if (!state.aim(from_world_m - state.origin_world_m, from_normal_world, to_m, error_m, ray)) return false;
  State::Targets targets;
  rtcInitIntersectContext(&targets.context);
  targets.state = &state;
  targets.to_m = &to_m;
  targets.error_m = &error_m;
  rtcOccluded1(state.scene, &targets.context, &ray);
  return ray.tfar < 0;
}

namespace {

/// Number of rays passed to Embree at once. The queries are the same as for single rays.
constexpr std::size_t kBatch = 64;
/// Below this cosine between any two directions of a batch, independent packets of 8 are faster.
constexpr double kCoherent = 0.9;

}  // namespace

void RayScene::occluded_many(const Vec3& from_world_m, const Vec3& from_normal_world, std::span<const Vec3> to_world_m,
                             std::span<std::uint8_t> occluded) const {
  LUXRIG_CHECK(occluded.size() == to_world_m.size(), "{} answers for {} targets", occluded.size(), to_world_m.size());
  const State& state = *state_;
  const Vec3 from_m = from_world_m - state.origin_world_m;
  std::array<RTCRay, kBatch> rays;
  std::array<Vec3, kBatch> to_m;
  std::array<double, kBatch> error_m{};
  std::array<std::size_t, kBatch> of{};
  State::Targets targets;
  rtcInitIntersectContext(&targets.context);
  targets.state = &state;
  targets.to_m = to_m.data();
  targets.error_m = error_m.data();
  for (std::size_t begin = 0; begin < to_world_m.size(); begin += kBatch) {
    const std::size_t end = std::min(begin + kBatch, to_world_m.size());
    std::size_t count = 0;
    double min_cosine = 1;
    for (std::size_t i = begin; i < end; ++i) {
      occluded[i] = 0;
      to_m[count] = to_world_m[i] - state.origin_world_m;
      error_m[count] = state.error_m(to_m[count]);
      RTCRay& ray = rays[count];
      if (!state.aim(from_m, from_normal_world, to_m[count], error_m[count], ray)) continue;
      ray.id = static_cast<unsigned>(count);
      const Vec3 way = to_m[count] - from_m, first = to_m[0] - from_m;
      min_cosine = std::min(min_cosine, way.dot(first) / std::sqrt(way.squaredNorm() * first.squaredNorm()));
      of[count++] = i;
    }
    if (count == 0) continue;
    targets.context.flags =
        min_cosine > kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    if (count < 3)
      for (std::size_t k = 0; k < count; ++k) rtcOccluded1(state.scene, &targets.context, &rays[k]);
    else
      rtcOccluded1M(state.scene, &targets.context, rays.data(), static_cast<unsigned>(count), sizeof(RTCRay));
    for (std::size_t k = 0; k < count; ++k) occluded[of[k]] = rays[k].tfar < 0;
  }
}

bool RayScene::surely_clear(const Shaft& shaft) const {
  const State& state = *state_;
  if (state.triangles.empty()) return true;
  std::call_once(state.tree_built, [&] {
    state.tree = TriangleTree(std::span(state.vertices_m).first(state.vertices_m.size() - 1), state.indices,
                              state.origin_world_m);
  });
  double error_m = 0;
  for (const Vec3& corner : shaft.corners_world_m) error_m = std::max(error_m, surface_error_m(corner));
  return state.tree.keeps_out_of(shaft, 2 * error_m);
}

bool RayScene::surely_blocked(const Vec3& from_world_m, const Vec3& from_normal_world,
                              std::span<const Vec3> corners_world_m, std::uint64_t& rays) const {
  const State& state = *state_;
  std::array<std::uint32_t, 2> ids{};
  std::size_t count = 0;
  std::array<std::size_t, 8> of_corner{};
  LUXRIG_CHECK(corners_world_m.size() <= of_corner.size(), "{} corners", corners_world_m.size());
  for (std::size_t i = 0; i < corners_world_m.size(); ++i) {
    const Vec3 way_m = corners_world_m[i] - from_world_m;
    const double distance_m = way_m.norm();
    if (!(way_m.dot(from_normal_world) > 0) && !from_normal_world.isZero(0)) return false;
    ++rays;
    const auto hit = nearest(from_world_m, way_m / distance_m, from_normal_world);
    if (!hit || !(hit->distance_m < distance_m - 2 * surface_error_m(corners_world_m[i]))) return false;
    const auto known = std::find(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count), hit->triangle);
    of_corner[i] = static_cast<std::size_t>(known - ids.begin());
    if (of_corner[i] < count) continue;
    if (count == ids.size()) return false;
    ids[count++] = hit->triangle;
  }
  std::array<std::array<std::uint32_t, 3>, 2> vertices{};
  for (std::size_t i = 0; i < count; ++i) vertices[i] = state.indices[ids[i]];
  if (count == 2) {
    // Both rotated so that the shared edge comes first.
    const auto place = [&](std::uint32_t vertex) { return state.vertices_m[vertex]; };
    bool found = false;
    for (int i = 0; i < 3 && !found; ++i) {
      for (int j = 0; j < 3 && !found; ++j) {
        const auto &a = vertices[0], &b = vertices[1];
        found = (place(a[0]) == place(b[0]) && place(a[1]) == place(b[1])) ||
                (place(a[0]) == place(b[1]) && place(a[1]) == place(b[0]));
        if (!found) std::rotate(vertices[1].begin(), vertices[1].begin() + 1, vertices[1].end());
      }
      if (!found) std::rotate(vertices[0].begin(), vertices[0].begin() + 1, vertices[0].end());
    }
    if (!found) return false;
  }
  std::array<std::array<Vec3, 3>, 2> triangles_m;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      triangles_m[i][k] = state.vertices_m[vertices[i][k]].cast<double>() + state.origin_world_m;
  return hull_lies_behind(from_world_m, corners_world_m, std::span(triangles_m).first(count),
                          std::span(of_corner).first(corners_world_m.size()));
}

}  // namespace luxrig
