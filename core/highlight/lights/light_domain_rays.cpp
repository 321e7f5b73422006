// Every hit of a ray with a light domain: Embree's filter records each and lets the ray continue.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/check.h"
#include "core/highlight/lights/light_domain_state.h"

namespace luxrig {
namespace {

constexpr std::size_t kDomainPacket = 16;
/// Hits of one group nearer together than this share of their distance count as one, at an edge shared by triangles.
constexpr double kSameHit = 1e-5;

struct FoundOnDomain {
  std::uint32_t ray, triangle;
  float along;  // in lengths of the direction
};

struct DomainQuery {
  RTCIntersectContext context;  // must be first: Embree's pointer to it is also a pointer to DomainQuery
  std::vector<FoundOnDomain>* found;
};

void note_domain_hits(const RTCFilterFunctionNArguments* arguments) {
  auto& found = *reinterpret_cast<DomainQuery*>(arguments->context)->found;
  for (unsigned i = 0; i < arguments->N; ++i) {
    if (arguments->valid[i] == 0) continue;
    found.push_back({RTCRayN_id(arguments->ray, arguments->N, i), RTCHitN_primID(arguments->hit, arguments->N, i),
                     RTCRayN_tfar(arguments->ray, arguments->N, i)});
    arguments->valid[i] = 0;
  }
}

}  // namespace

void LightDomain::State::build() {
  for (const Triangle& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(vertices_m.size());
    indices.push_back({first, first + 1, first + 2});
    for (const Vec3& corner : triangle.corners_m) {
      size_m = std::max(size_m, corner.norm());
      vertices_m.push_back(corner.cast<float>());
    }
  }
  vertices_m.push_back(Vec3f::Zero());
  device = rtcNewDevice("ignore_config_files=1,set_affinity=0");
  LUXRIG_CHECK(device != nullptr, "Embree error {}", static_cast<int>(rtcGetDeviceError(nullptr)));
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  // Medium: results must not depend on thread timing, and no triangle may be split, or its hits come twice.
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_m.data(), 0,
                             sizeof(Vec3f), vertices_m.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices.data(), 0,
                             sizeof(indices[0]), indices.size());
  rtcSetGeometryOccludedFilterFunction(geometry, note_domain_hits);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  const RTCError error = rtcGetDeviceError(device);
  LUXRIG_CHECK(error == RTC_ERROR_NONE, "Embree error {} with {} triangles", static_cast<int>(error), triangles.size());
}

void LightDomain::hits_along(const Vec3& from_world_m, std::span<const Vec3f> directions_world,
                             std::vector<DomainHit>& hits) const {
  const State& state = *state_;
  const Vec3 from_m = from_world_m - state.centre_world_m;
  const Vec3f start = from_m.cast<float>();
  std::vector<FoundOnDomain> found;
  DomainQuery query;
  rtcInitIntersectContext(&query.context);
  query.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  query.found = &found;
  RTCRay16 rays;
  for (std::size_t begin = 0; begin < directions_world.size(); begin += kDomainPacket) {
    const std::size_t count = std::min(kDomainPacket, directions_world.size() - begin);
    alignas(64) std::array<int, kDomainPacket> valid{};
    for (std::size_t k = 0; k < kDomainPacket; ++k) {
      const Vec3f& direction = directions_world[begin + std::min(k, count - 1)];
      valid[k] = k < count ? -1 : 0;
      rays.org_x[k] = start.x();
      rays.org_y[k] = start.y();
      rays.org_z[k] = start.z();
      rays.tnear[k] = 0;
      rays.dir_x[k] = direction.x();
      rays.dir_y[k] = direction.y();
      rays.dir_z[k] = direction.z();
      // On processors without 16 lanes, Embree 3.13 casts 8 twice and ignores the valid mask. A ray that ends before it
      // begins has no hits.
      rays.tfar[k] = valid[k] != 0 ? std::numeric_limits<float>::infinity() : -std::numeric_limits<float>::infinity();
      rays.time[k] = 0;
      rays.mask[k] = ~0u;
      rays.id[k] = static_cast<unsigned>(begin + k);
      rays.flags[k] = 0;
    }
    rtcOccluded16(valid.data(), state.scene, &query.context, &rays);
  }
  const std::size_t before = hits.size();
  for (const FoundOnDomain& one : found) {
    const Vec3 direction = directions_world[one.ray].cast<double>();
    const Triangle& triangle = state.triangles[one.triangle];
    // Distance to the triangle's plane in double, unless the ray is so nearly parallel to it that this is less
    // accurate.
    const double length = direction.norm(), across = triangle.normal.dot(direction);
    double distance_m = one.along * length;
    const double exact_m = triangle.normal.dot(triangle.corners_m[0] - from_m) / across * length;
    if (std::abs(exact_m - distance_m) <= 1e-4 * distance_m) distance_m = exact_m;
    if (distance_m > 0) hits.push_back({one.ray, one.triangle, distance_m});
  }
  const auto group = [&](const DomainHit& hit) { return state.triangles[hit.triangle].group; };
  const auto first = hits.begin() + static_cast<std::ptrdiff_t>(before);
  std::sort(first, hits.end(), [&](const DomainHit& a, const DomainHit& b) {
    return std::tuple(a.ray, group(a), a.distance_m, a.triangle) <
           std::tuple(b.ray, group(b), b.distance_m, b.triangle);
  });
  hits.erase(std::unique(first, hits.end(),
                         [&](const DomainHit& a, const DomainHit& b) {
                           return a.ray == b.ray && group(a) == group(b) &&
                                  b.distance_m - a.distance_m <= kSameHit * a.distance_m;
                         }),
             hits.end());
}

}  // namespace luxrig
