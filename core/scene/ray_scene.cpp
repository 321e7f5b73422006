#include "core/scene/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <vector>

#include "core/check.h"

namespace luxrig {
namespace {

// How far float arithmetic may see a surface from where it is, with u = 2^-24 (half a unit in the last place),
// p the point at which it matters and L the longest edge, so that every vertex of a triangle there is within
// |p| + L of the origin:
//   the vertices were rounded to float              √3 u (|p| + L)
//   the start of the ray is rounded to float        √3 u |p|
//   Embree subtracts the start from the vertices    √3 u L
//   its triangle normal (cross product of edges)     6 u L   a sliver's normal is worse, but only about its
//                                                            long side, where it moves points within the
//                                                            sliver by no more than this
//   its dot product with that normal, and division   6 u L
// together u (3.5 |p| + 15.5 L), rounded up.
constexpr double kUnit = 0x1p-24;
constexpr double kPerPosition = 4;
constexpr double kPerEdge = 16;

constexpr double kStartErrors = 2;  // the start is lifted by so many e, then set back by one (see `start`)
constexpr double kEndErrors = 32;   // 1 / cos 88.2°
constexpr double kUnitTolerance = 1e-6;

}  // namespace

struct RayScene::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  Vec3 origin_world_m = Vec3::Zero();
  std::vector<Vec3f> vertices_m;  // shared with Embree; one more than used, since it reads 16 bytes per vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> material_of_triangle;
  std::vector<Material> materials;
  Eigen::AlignedBox3d bounds_m;  // relative to the origin
  double longest_edge_m = 0;
  mutable std::once_flag tree_built;
  mutable TriangleTree tree;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  void measure() {
    for (const auto& triangle : triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 here = vertices_m[triangle[i]].cast<double>();
        const Vec3 next = vertices_m[triangle[(i + 1) % 3]].cast<double>();
        LUXRIG_CHECK(here.allFinite(), "vertex {}", triangle[i]);
        bounds_m.extend(here);
        longest_edge_m = std::max(longest_edge_m, (next - here).norm());
      }
    }
  }

  void build() {
    // No files from the working folder or home may change how we trace.
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
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(), 0,
                                 sizeof(triangles[0]), triangles.size());
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    const RTCError error = rtcGetDeviceError(device);
    LUXRIG_CHECK(error == RTC_ERROR_NONE, "Embree error {} with {} triangles", static_cast<int>(error),
                 triangles.size());
  }

  [[nodiscard]] double error_m(const Vec3& point_m) const {
    return kUnit * (kPerPosition * point_m.cwiseAbs().maxCoeff() + kPerEdge * longest_edge_m);
  }

  /// Lifts the start off its surface by 2 e along the normal, then sets it back by e along the ray: still e
  /// above the surface, but now in front of any other surface that it touches in a corner, through which it
  /// would slip otherwise.
  [[nodiscard]] Vec3 start(const Vec3& from_m, const Vec3& direction, const Vec3& normal) const {
    if (normal.isZero(0)) return from_m;
    const double error = error_m(from_m);
    return from_m + error * (kStartErrors * normal - direction);
  }
};

namespace {

void set_ray(RTCRay& ray, const Vec3f& from_m, const Vec3& direction, double length_m) {
  ray.org_x = from_m.x();
  ray.org_y = from_m.y();
  ray.org_z = from_m.z();
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = 0;
  ray.tfar = static_cast<float>(length_m);
  ray.time = 0;
  ray.mask = ~0u;
  ray.id = 0;
  ray.flags = 0;
}

}  // namespace

RayScene::RayScene(const Scene& scene) : state_(std::make_unique<State>()) {
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    for (const std::uint32_t index : scene.triangles[i]) {
      LUXRIG_CHECK(index < scene.vertices_m.size(), "triangle {} uses vertex {} of {}", i, index,
                   scene.vertices_m.size());
    }
  }
  LUXRIG_CHECK(scene.material_of_triangle.size() == scene.triangles.size(), "{} materials for {} triangles",
               scene.material_of_triangle.size(), scene.triangles.size());
  for (const std::uint32_t material : scene.material_of_triangle) {
    LUXRIG_CHECK(material < scene.materials.size(), "material {} of {}", material, scene.materials.size());
  }
  state_->origin_world_m = scene.origin_world_m;
  state_->vertices_m.reserve(scene.vertices_m.size() + 1);
  state_->vertices_m = scene.vertices_m;
  state_->vertices_m.push_back(Vec3f::Zero());
  state_->triangles = scene.triangles;
  state_->material_of_triangle = scene.material_of_triangle;
  state_->materials = scene.materials;
  state_->measure();
  state_->build();
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

std::optional<Hit> RayScene::nearest(const Vec3& from_world_m, const Vec3& direction_world,
                                     const Vec3& leaving_normal_world) const {
  LUXRIG_CHECK(std::abs(direction_world.norm() - 1) <= kUnitTolerance, "|direction| = {}", direction_world.norm());
  const State& state = *state_;
  const Vec3 from_m = from_world_m - state.origin_world_m;
  const Vec3f start_m = state.start(from_m, direction_world, leaving_normal_world).cast<float>();
  RTCRayHit query;
  set_ray(query.ray, start_m, direction_world, std::numeric_limits<double>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(state.scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  const auto& triangle = state.triangles[query.hit.primID];
  const Vec3 a = state.vertices_m[triangle[0]].cast<double>();
  const Vec3 ab = state.vertices_m[triangle[1]].cast<double>() - a;
  const Vec3 ac = state.vertices_m[triangle[2]].cast<double>() - a;
  // From the place within the triangle, not from the distance: so it lies on the surface to double rounding.
  const Vec3 position_m = a + static_cast<double>(query.hit.u) * ab + static_cast<double>(query.hit.v) * ac;
  Vec3 normal = ab.cross(ac).normalized();
  if (normal.dot(direction_world) > 0) normal = -normal;
  const double distance_m = std::max(0.0, (position_m - from_m).dot(direction_world));
  return Hit{distance_m, query.hit.primID, position_m + state.origin_world_m, normal};
}

bool RayScene::occluded(const Vec3& from_world_m, const Vec3& from_normal_world, const Vec3& to_world_m) const {
  const State& state = *state_;
  const Vec3 from_m = from_world_m - state.origin_world_m;
  const Vec3 to_m = to_world_m - state.origin_world_m;
  const double distance_m = (to_m - from_m).norm();
  if (!(distance_m > 0)) return false;
  const Vec3f start_m = state.start(from_m, (to_m - from_m) / distance_m, from_normal_world).cast<float>();
  // Aimed from where the ray really starts, so that it ends where it should.
  const Vec3 way_m = to_m - start_m.cast<double>();
  const double way_length_m = way_m.norm();
  // The end is off by the surface's error and by the rounding of the direction (√3 u per metre).
  const double end_error_m = state.error_m(to_m) + 2 * kUnit * way_length_m;
  const double length_m = way_length_m - kEndErrors * end_error_m;
  if (!(length_m > 0)) return false;
  RTCRay ray;
  set_ray(ray, start_m, way_m / way_length_m, length_m);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(state.scene, &context, &ray);
  return ray.tfar < 0;
}

void RayScene::occluded_many(const Vec3& from_world_m, const Vec3& from_normal_world, std::span<const Vec3> to_world_m,
                             std::span<std::uint8_t> occluded) const {
  LUXRIG_CHECK(occluded.size() == to_world_m.size(), "{} answers for {} targets", occluded.size(), to_world_m.size());
  for (std::size_t i = 0; i < to_world_m.size(); ++i)
    occluded[i] = this->occluded(from_world_m, from_normal_world, to_world_m[i]);
}

bool RayScene::surely_clear(const Shaft& shaft) const {
  const State& state = *state_;
  if (state.triangles.empty()) return true;
  std::call_once(state.tree_built, [&] {
    state.tree = TriangleTree(std::span(state.vertices_m).first(state.vertices_m.size() - 1), state.triangles,
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
    if (!hit || !(hit->distance_m < distance_m - kEndErrors * surface_error_m(corners_world_m[i]))) return false;
    const auto known = std::find(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(count), hit->triangle);
    of_corner[i] = static_cast<std::size_t>(known - ids.begin());
    if (of_corner[i] < count) continue;
    if (count == ids.size()) return false;
    ids[count++] = hit->triangle;
  }
  std::array<std::array<std::uint32_t, 3>, 2> vertices{};
  for (std::size_t i = 0; i < count; ++i) vertices[i] = state.triangles[ids[i]];
  if (count == 2) {
    // Both turned so that the shared edge comes first.
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

const Material& RayScene::material_of(std::uint32_t triangle) const {
  LUXRIG_CHECK(triangle < state_->triangles.size(), "triangle {} of {}", triangle, state_->triangles.size());
  return state_->materials[state_->material_of_triangle[triangle]];
}

std::span<const Material> RayScene::materials() const { return state_->materials; }

std::uint32_t RayScene::material_index_of(std::uint32_t triangle) const {
  return state_->material_of_triangle[triangle];
}

Eigen::AlignedBox3d RayScene::bounds_world_m() const {
  Eigen::AlignedBox3d bounds = state_->bounds_m;
  if (!bounds.isEmpty()) bounds.translate(state_->origin_world_m);
  return bounds;
}

double RayScene::surface_error_m(const Vec3& point_world_m) const {
  return state_->error_m(point_world_m - state_->origin_world_m);
}

}  // namespace luxrig
