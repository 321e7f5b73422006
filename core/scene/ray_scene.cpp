#include "core/scene/ray_scene.h"

#include <limits>

#include "core/check.h"
#include "core/scene/ray_scene_state.h"

namespace luxrig {
namespace {

constexpr double kUnitTolerance = 1e-6;

/// Whether an edge is longer than kNearEdgePerDistance of its distance from the origin.
bool is_near(const Vec3& from_m, const Vec3& edge_m) {
  const double length_m2 = edge_m.squaredNorm();
  if (!(length_m2 > 0)) return true;
  const Vec3 nearest_m = from_m + std::clamp(-from_m.dot(edge_m) / length_m2, 0.0, 1.0) * edge_m;
  return length_m2 > kNearEdgePerDistance * kNearEdgePerDistance * nearest_m.squaredNorm();
}

}  // namespace

void RayScene::State::measure(const std::vector<std::uint32_t>& material_of_triangle) {
  double longest_m2 = 0, longest_near_m2 = 0;
  triangles.resize(indices.size());
  for (std::size_t t = 0; t < indices.size(); ++t) {
    Triangle& triangle = triangles[t];
    triangle.material = material_of_triangle[t];
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.corners_m[i] = vertices_m[indices[t][i]];
      const Vec3 here = triangle.corners_m[i].cast<double>();
      const Vec3 next = vertices_m[indices[t][(i + 1) % 3]].cast<double>();
      LUXRIG_CHECK(here.allFinite(), "vertex {}", indices[t][i]);
      bounds_m.extend(here);
      const Vec3 edge = next - here;
      const double length_m2 = edge.squaredNorm();
      longest_m2 = std::max(longest_m2, length_m2);
      if (length_m2 > longest_near_m2 && is_near(here, edge)) longest_near_m2 = length_m2;
    }
    const Vec3 a = triangle.corners_m[0].cast<double>();
    const Vec3 normal =
        (triangle.corners_m[1].cast<double>() - a).cross(triangle.corners_m[2].cast<double>() - a).normalized();
    triangle.normal = {normal.x(), normal.y(), normal.z()};
  }
  edge_error_m = kUnit * kPerEdge * std::sqrt(longest_m2);
  near_edge_error_m = kUnit * kPerEdge * std::sqrt(longest_near_m2);
  world_error_m = kWorldUnit * origin_world_m.cwiseAbs().maxCoeff();
}

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
  state_->indices = scene.triangles;
  state_->materials = scene.materials;
  state_->panes = Panes(scene.panes);
  state_->measure(scene.material_of_triangle);
  state_->build();
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

std::optional<Hit> RayScene::nearest(const Vec3& from_world_m, const Vec3& direction_world,
                                     const Vec3& leaving_normal_world) const {
  // Squared, since a root here would cost a tenth of the ray.
  LUXRIG_CHECK(std::abs(direction_world.squaredNorm() - 1) <= 2 * kUnitTolerance, "|direction| = {}",
               direction_world.norm());
  const State& state = *state_;
  const Vec3 from_m = from_world_m - state.origin_world_m;
  const Vec3f start_m = state.start(from_m, direction_world, leaving_normal_world).cast<float>();
  const Vec3f direction = direction_world.cast<float>();
  RTCRayHit query;
  RTCRay& ray = query.ray;
  ray.org_x = start_m.x();
  ray.org_y = start_m.y();
  ray.org_z = start_m.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = 0;
  ray.tfar = std::numeric_limits<float>::infinity();
  ray.time = 0;
  ray.mask = ~0u;
  ray.id = 0;
  ray.flags = 0;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(state.scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;

  const State::Triangle& triangle = state.triangles[query.hit.primID];
  const double u = query.hit.u, v = query.hit.v;
  const Vec3 a = triangle.corners_m[0].cast<double>();
  // From barycentric coordinates, not from the distance, so that it is on the surface to double rounding.
  const Vec3 position_m =
      a + u * (triangle.corners_m[1].cast<double>() - a) + v * (triangle.corners_m[2].cast<double>() - a);
  Vec3 normal(triangle.normal[0], triangle.normal[1], triangle.normal[2]);
  if (normal.dot(direction_world) > 0) normal = -normal;
  const double distance_m = std::max(0.0, (position_m - from_m).dot(direction_world));
  return Hit{distance_m, query.hit.primID, position_m + state.origin_world_m, normal};
}

bool RayScene::has_panes() const { return !state_->panes.empty(); }

double RayScene::transmittance(const Vec3& from_world_m, const Vec3& to_world_m) const {
  if (state_->panes.empty()) return 1;
  const double near_m = 2 * std::max(surface_error_m(from_world_m), surface_error_m(to_world_m));
  return state_->panes.transmittance(from_world_m, to_world_m, near_m);
}

const Material& RayScene::material_of(std::uint32_t triangle) const {
  LUXRIG_CHECK(triangle < state_->triangles.size(), "triangle {} of {}", triangle, state_->triangles.size());
  return state_->materials[state_->triangles[triangle].material];
}

std::span<const Material> RayScene::materials() const { return state_->materials; }

std::uint32_t RayScene::material_index_of(std::uint32_t triangle) const { return state_->triangles[triangle].material; }

std::size_t RayScene::triangles() const { return state_->triangles.size(); }

std::array<Vec3, 3> RayScene::corners_world_m(std::uint32_t triangle) const {
  std::array<Vec3, 3> corners_world_m;
  for (std::size_t i = 0; i < 3; ++i)
    corners_world_m[i] = state_->triangles[triangle].corners_m[i].cast<double>() + state_->origin_world_m;
  return corners_world_m;
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
