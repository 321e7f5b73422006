#include "core/highlight/lights/light_domain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "tests/core/highlight/lights/even_layers.h"
#include "tests/core/highlight/shapes.h"

namespace luxrig {
namespace {

LightDomain domain_of(const Scene& scene, const LightDomainOptions& options, const Vec3& centre = Vec3::Zero()) {
  auto domain = mesh_light_domain(scene, {}, centre, options);
  EXPECT_TRUE(domain) << domain.error().detail;
  return std::move(*domain);
}

TEST(LightDomain, RaysHitEveryLayerAtItsPlane) {
  const LightDomain domain = domain_of(ceiling(10, 3), {even_layers_m(4, 0.1), 8});
  EXPECT_EQ(domain.groups(), 4u);
  Random random(3);
  std::vector<Vec3f> directions;
  for (int i = 0; i < 100; ++i) {
    const Vec3 d = random.direction();
    if (d.z() > 0.35) directions.push_back((random.between(0.5, 2) * d).cast<float>());
  }
  directions.push_back(Vec3f(0, 0, 1));  // a corner of eight triangles is hit once
  directions.push_back(Vec3f(1, 1, 2));  // along the edges between two triangles
  directions.push_back(Vec3f(0, 0, -1));
  std::vector<DomainHit> hits;
  const Vec3 from(0, 0, 0.25);
  domain.hits_along(from, directions, hits);
  std::size_t next = 0;
  for (std::uint32_t ray = 0; ray + 1 < directions.size(); ++ray) {
    const Vec3 direction = directions[ray].cast<double>().normalized();
    for (std::uint32_t layer = 0; layer < 4; ++layer, ++next) {
      ASSERT_LT(next, hits.size());
      EXPECT_EQ(hits[next].ray, ray);
      EXPECT_EQ(domain.layer_of(domain.triangles()[hits[next].triangle].group), layer);
      EXPECT_NEAR(hits[next].distance_m, (3 - 0.1 * layer - from.z()) / direction.z(), 1e-6);
    }
  }
  EXPECT_EQ(next, hits.size());
}

TEST(LightDomain, LayersOfABoxAreBoxes) {
  // The six sides of a cube, welded, seen from inside. Layers are smaller cubes without gaps at the edges.
  Scene cube;
  for (int i = 0; i < 8; ++i) cube.vertices_m.push_back(Vec3f(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  const std::array<std::array<std::uint32_t, 4>, 6> sides = {
      {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
  for (const auto& s : sides) {  // anticlockwise from inside
    cube.triangles.push_back({s[0], s[1], s[2]});
    cube.triangles.push_back({s[0], s[2], s[3]});
  }
  const LightDomain domain = domain_of(with_one_material(cube), {{0, 0.25}, 4});
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const Vec3 d = random.direction();
    const std::vector<Vec3f> one = {d.cast<float>()};
    std::vector<DomainHit> hits;
    domain.hits_along(Vec3::Zero(), one, hits);
    ASSERT_EQ(hits.size(), 2u);
    EXPECT_NEAR(hits[0].distance_m, 1 / d.cwiseAbs().maxCoeff(), 1e-6);
    EXPECT_NEAR(hits[1].distance_m, 0.75 / d.cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(LightDomain, SeparatePiecesAreSeparateCells) {
  const Scene two = joined(ceiling(1, 2), ceiling(1, 3));
  const LightDomain domain = domain_of(two, {{0, 0.5}, 2});
  EXPECT_EQ(domain.groups(), 4u);
  const std::vector<Vec3f> up = {Vec3f(0.1f, 0.05f, 1)};
  std::vector<DomainHit> hits;
  domain.hits_along(Vec3::Zero(), up, hits);
  ASSERT_EQ(hits.size(), 4u);
  std::set<std::uint32_t> groups;
  for (const DomainHit& hit : hits) groups.insert(domain.triangles()[hit.triangle].group);
  EXPECT_EQ(groups.size(), 4u);
}

TEST(LightDomain, CountsOnlyTheChosenTriangles) {
  const Scene two = joined(ceiling(1, 2), ceiling(1, 3));
  std::vector<std::uint8_t> upper(two.triangles.size(), 0);
  std::fill(upper.begin() + static_cast<std::ptrdiff_t>(two.triangles.size() / 2), upper.end(), 1);
  const auto domain = mesh_light_domain(two, upper, Vec3::Zero(), {});
  ASSERT_TRUE(domain);
  std::vector<DomainHit> hits;
  const std::vector<Vec3f> up = {Vec3f(0.1f, 0.05f, 1)};
  domain->hits_along(Vec3::Zero(), up, hits);
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_NEAR(hits[0].distance_m, 3 * std::sqrt(1 + 0.0125), 1e-6);
}

TEST(LightDomain, CellsShareItsAreaAndContainTheirCentres) {
  for (const Vec3& centre : {Vec3(0, 0, 0), Vec3(4e5, -2e6, 900)}) {
    Scene scene = ceiling(3, 2);
    scene.origin_world_m = centre;
    const LightDomain domain = domain_of(scene, {{0, 0.5}, 8}, centre);
    const auto cells = domain.cell_centres();
    double area = 0;
    std::set<DomainCell> seen;
    for (const auto& cell : cells) {
      area += cell.area_m2;
      EXPECT_TRUE(seen.insert(cell.cell).second);
      EXPECT_EQ(domain.cell_of(cell.position_world_m, cell.cell.group), cell.cell);
      EXPECT_NEAR(cell.position_world_m.z() - centre.z(), 2 - 0.5 * cell.cell.group, 1e-6);
    }
    EXPECT_NEAR(area, 2 * 36, 1e-6);
    EXPECT_TRUE(
        std::is_sorted(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.cell < b.cell; }));
  }
}

TEST(LightDomain, BoxesStandAroundTheTarget) {
  const Scene scene = uv_sphere(0.5, 20);
  const auto surface = make_target_surface(scene);
  const auto domain = nested_box_domain(*surface, {2, 1, 0.5, 4});
  ASSERT_TRUE(domain);
  EXPECT_EQ(domain->groups(), 2u);
  EXPECT_NEAR(domain->centre_world_m().norm(), 0, 1e-6);
  const std::vector<Vec3f> along = {Vec3f(1, 0.1f, 0.2f), Vec3f(0.1f, -1, 0.3f)};
  std::vector<DomainHit> hits;
  domain->hits_along(Vec3::Zero(), along, hits);
  ASSERT_EQ(hits.size(), 4u);
  for (const DomainHit& hit : hits) {
    const double length = along[hit.ray].cast<double>().norm();
    const double half_m = domain->triangles()[hit.triangle].group == 0 ? 1.5 : 2.0;
    EXPECT_NEAR(hit.distance_m, half_m * length, 1e-5);
  }
  EXPECT_FALSE(nested_box_domain(*surface, {0, 1, 1, 4}));
  EXPECT_FALSE(nested_box_domain(*surface, {1, -1, 1, 4}));
  EXPECT_FALSE(nested_box_domain(*surface, {1, std::numeric_limits<double>::quiet_NaN(), 1, 4}));
  EXPECT_FALSE(nested_box_domain(*make_target_surface(Scene{}), {}));
}

TEST(LightDomain, RefusesEmptyAndNonFiniteMeshes) {
  const auto detail = [](const Scene& scene, const LightDomainOptions& options) {
    const auto domain = mesh_light_domain(scene, {}, Vec3::Zero(), options);
    return domain ? std::string() : domain.error().detail;
  };
  EXPECT_NE(detail(Scene{}, {}).find("empty"), std::string::npos);
  Scene flat = ceiling(1, 2);
  for (auto& t : flat.triangles) t[2] = t[1];
  EXPECT_NE(detail(flat, {}).find("empty"), std::string::npos);
  Scene broken = ceiling(1, 2);
  broken.vertices_m[3].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(detail(broken, {}).find("not finite"), std::string::npos);
  EXPECT_NE(detail(ceiling(1, 2), {{}, 8}), "");
  EXPECT_NE(detail(ceiling(1, 2), {{0, std::numeric_limits<double>::infinity()}, 8}), "");
  EXPECT_NE(detail(ceiling(1, 2), {{0}, 0}), "");
  const std::vector<std::uint8_t> none(8, 0), few(3, 1);
  EXPECT_FALSE(mesh_light_domain(ceiling(1, 2), none, Vec3::Zero(), {}));
  EXPECT_FALSE(mesh_light_domain(ceiling(1, 2), few, Vec3::Zero(), {}));
}

TEST(LightDomain, HitsMatchThoseOfEachTriangle) {
  Random random(11);
  for (int round = 0; round < 20; ++round) {
    Scene soup;
    const Vec3 shift = round % 2 == 0 ? Vec3::Zero() : Vec3(3e6, -1e6, 2000);
    soup.origin_world_m = shift;
    for (std::uint32_t t = 0; t < 40; ++t) {
      const Vec3 middle = 3 * random.in_cube();
      for (int i = 0; i < 3; ++i) soup.vertices_m.push_back((middle + random.in_cube()).cast<float>());
      soup.triangles.push_back({3 * t, 3 * t + 1, t % 8 == 7 ? 3 * t : 3 * t + 2});
    }
    const LightDomain domain = domain_of(with_one_material(soup), {{0}, 4}, shift);
    std::vector<Vec3f> directions;
    for (int i = 0; i < 100; ++i) directions.push_back(random.direction().cast<float>());
    const Vec3 from = 0.5 * random.in_cube();
    std::vector<DomainHit> hits;
    domain.hits_along(shift + from, directions, hits);
    for (std::uint32_t ray = 0; ray < directions.size(); ++ray) {
      const Vec3 d = directions[ray].cast<double>();
      std::vector<double> expected_m;
      bool clear_cut = true;
      for (const auto& t : soup.triangles) {
        Vec3 a = soup.vertices_m[t[0]].cast<double>(), b = soup.vertices_m[t[1]].cast<double>(),
             c = soup.vertices_m[t[2]].cast<double>();
        const Vec3 normal = (b - a).cross(c - a);
        const double along = normal.dot(a - from) / normal.dot(d);
        if (!(along > 0)) continue;
        const Vec3 p = from + along * d;
        double least = 1;
        const std::array<Vec3, 3> corners = {a, b, c};
        for (std::size_t i = 0; i < 3; ++i)
          least = std::min(
              least, normal.dot((corners[(i + 1) % 3] - corners[i]).cross(p - corners[i])) / normal.squaredNorm());
        if (std::abs(least) < 1e-4 || along < 1e-4) clear_cut = false;
        if (least > 0) expected_m.push_back(along);
      }
      std::vector<double> found_m;
      for (const DomainHit& hit : hits)
        if (hit.ray == ray) found_m.push_back(hit.distance_m);
      if (!clear_cut) continue;
      std::sort(expected_m.begin(), expected_m.end());
      std::sort(found_m.begin(), found_m.end());
      ASSERT_EQ(found_m.size(), expected_m.size());
      for (std::size_t i = 0; i < found_m.size(); ++i) EXPECT_NEAR(found_m[i], expected_m[i], 1e-5);
    }
  }
}

TEST(LightDomain, ToleratesZeroAreaTrianglesAndDoubleSidedSheets) {
  Scene sheet = ceiling(1, 2);
  const std::size_t count = sheet.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    const auto [a, b, c] = sheet.triangles[t];
    sheet.triangles.push_back({a, c, b});
    sheet.triangles.push_back({a, b, b});
  }
  const LightDomain domain = domain_of(with_one_material(sheet), {{0, 0.1}, 4});
  std::vector<DomainHit> hits;
  const std::vector<Vec3f> up = {Vec3f(0.1f, 0.05f, 1)};
  domain.hits_along(Vec3::Zero(), up, hits);
  const double slant = std::sqrt(1 + 0.0125);
  ASSERT_EQ(hits.size(), 3u);  // the sheet once, its layers on both sides
  EXPECT_NEAR(hits[0].distance_m, 2 * slant, 1e-6);
  EXPECT_NEAR(hits[1].distance_m, 1.9 * slant, 1e-6);
  EXPECT_NEAR(hits[2].distance_m, 2.1 * slant, 1e-6);
}

}  // namespace
}  // namespace luxrig
