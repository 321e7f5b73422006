#include "core/highlight/lights/light_domain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/highlight/lights/light_domain_state.h"

namespace luxrig {
namespace {

constexpr int kFinestCellSide = 1024;
/// Size of the pieces of a cell's surface: share of the cell's width, and least share of the domain's size.
constexpr double kPieceOfCell = 0.25, kSmallestPiece = 0x1p-12;
/// A layer's corner moves along the mean normal by at most this many times the offset; beyond that along the
/// triangle's.
constexpr double kFarthestMitre = 4;

/// The contiguous piece of each triangle; numbered by their first triangles.
std::vector<std::uint32_t> parts_of(const TargetSurface& surface, std::uint32_t& count) {
  std::vector<std::uint32_t> parent(surface.points_m.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const auto& triangle : surface.triangles) {
    for (const std::size_t corner : {1u, 2u}) {
      const std::uint32_t a = root(triangle[0]), b = root(triangle[corner]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  constexpr std::uint32_t kUnnumbered = ~0u;
  std::vector<std::uint32_t> number(parent.size(), kUnnumbered), parts;
  count = 0;
  for (const auto& triangle : surface.triangles) {
    std::uint32_t& mine = number[root(triangle[0])];
    if (mine == kUnnumbered) mine = count++;
    parts.push_back(mine);
  }
  return parts;
}

Vec3 area_vector_m2(const std::array<Vec3, 3>& p) { return 0.5 * (p[1] - p[0]).cross(p[2] - p[0]); }

struct SurfacePiece {
  DomainCell cell;
  Vec3 middle_m;
  double area_m2;
};

}  // namespace

LightDomain::LightDomain(std::unique_ptr<State> state) : state_(std::move(state)) {}
LightDomain::~LightDomain() = default;
LightDomain::LightDomain(LightDomain&&) noexcept = default;
LightDomain& LightDomain::operator=(LightDomain&&) noexcept = default;

const Vec3& LightDomain::centre_world_m() const { return state_->centre_world_m; }
const DirectionBins& LightDomain::bins() const { return state_->bins; }
std::span<const LightDomain::Triangle> LightDomain::triangles() const { return state_->triangles; }
std::uint32_t LightDomain::groups() const { return static_cast<std::uint32_t>(state_->layer_of_group.size()); }
std::uint32_t LightDomain::layer_of(std::uint32_t group) const { return state_->layer_of_group[group]; }

LightDomain LightDomain::with(const Vec3& centre_world_m, int cell_side, std::vector<Triangle> triangles,
                              std::vector<std::uint32_t> layer_of_group) {
  auto state = std::make_unique<State>(cell_side);
  state->centre_world_m = centre_world_m;
  state->triangles = std::move(triangles);
  state->layer_of_group = std::move(layer_of_group);
  state->build();
  return LightDomain(std::move(state));
}

DomainCell LightDomain::cell_of(const Vec3& position_world_m, std::uint32_t group) const {
  const Vec3 way_m = position_world_m - state_->centre_world_m;
  return {group, state_->bins.bin_of(way_m.isZero(0) ? Vec3::UnitZ() : way_m)};
}

std::vector<LightDomain::CellCentre> LightDomain::cell_centres() const {
  const double cell_rad = std::sqrt(4 * kPi / state_->bins.count());
  std::vector<SurfacePiece> pieces;
  std::vector<std::array<Vec3, 3>> left;
  for (const Triangle& triangle : state_->triangles) {
    left.push_back(triangle.corners_m);
    while (!left.empty()) {
      const std::array<Vec3, 3> p = left.back();
      left.pop_back();
      std::size_t longest = 0;
      for (std::size_t i = 1; i < 3; ++i)
        if ((p[(i + 1) % 3] - p[i]).squaredNorm() > (p[(longest + 1) % 3] - p[longest]).squaredNorm()) longest = i;
      const Vec3 middle_m = (p[0] + p[1] + p[2]) / 3;
      const double allowed_m = std::max(kPieceOfCell * cell_rad * middle_m.norm(), kSmallestPiece * state_->size_m);
      const std::size_t next = (longest + 1) % 3;
      if ((p[next] - p[longest]).norm() <= allowed_m) {
        pieces.push_back(
            {cell_of(state_->centre_world_m + middle_m, triangle.group), middle_m, area_vector_m2(p).norm()});
        continue;
      }
      const Vec3 cut = 0.5 * (p[longest] + p[next]);
      left.push_back(p);
      left.back()[next] = cut;
      left.push_back(p);
      left.back()[longest] = cut;
    }
  }
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const SurfacePiece& a, const SurfacePiece& b) { return a.cell < b.cell; });
  std::vector<CellCentre> centres;
  for (std::size_t begin = 0, end = 0; begin < pieces.size(); begin = end) {
    double area_m2 = 0;
    Vec3 mean_m = Vec3::Zero();
    for (; end < pieces.size() && pieces[end].cell == pieces[begin].cell; ++end) {
      mean_m += pieces[end].area_m2 * pieces[end].middle_m;
      area_m2 += pieces[end].area_m2;
    }
    mean_m /= area_m2;
    const auto nearest = std::min_element(
        pieces.begin() + static_cast<std::ptrdiff_t>(begin), pieces.begin() + static_cast<std::ptrdiff_t>(end),
        [&](const SurfacePiece& a, const SurfacePiece& b) {
          return (a.middle_m - mean_m).squaredNorm() < (b.middle_m - mean_m).squaredNorm();
        });
    centres.push_back({nearest->cell, state_->centre_world_m + nearest->middle_m, area_m2});
  }
  return centres;
}

Result<LightDomain> mesh_light_domain(const Scene& scene, std::span<const std::uint8_t> of_triangles,
                                      const Vec3& centre_world_m, const LightDomainOptions& options) {
  if (options.cell_side < 1 || options.cell_side > kFinestCellSide)
    return refusal(
        fmt::format("cells of a light domain have a side of 1 to {}, not {}", kFinestCellSide, options.cell_side));
  if (options.layer_offsets_m.empty()) return refusal("a light domain without a layer has no place for luminaires");
  for (const double offset_m : options.layer_offsets_m)
    if (!std::isfinite(offset_m)) return refusal(fmt::format("a layer cannot be {} m off its surface", offset_m));
  if (!centre_world_m.allFinite()) return refusal("the target's centre is not finite");
  if (!of_triangles.empty() && of_triangles.size() != scene.triangles.size())
    return refusal(
        fmt::format("{} marks for {} triangles of the light domain", of_triangles.size(), scene.triangles.size()));
  Scene chosen;
  chosen.origin_world_m = scene.origin_world_m;
  chosen.vertices_m = scene.vertices_m;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    if (!of_triangles.empty() && !of_triangles[t]) continue;
    for (const std::uint32_t vertex : scene.triangles[t]) {
      if (vertex >= scene.vertices_m.size())
        return refusal(
            fmt::format("triangle {} of the light domain uses vertex {} of {}", t, vertex, scene.vertices_m.size()));
      if (!scene.vertices_m[vertex].allFinite())
        return refusal(fmt::format("vertex {} of the light domain is not finite", vertex));
    }
    chosen.triangles.push_back(scene.triangles[t]);
  }
  // Vertices that no chosen triangle uses do not matter.
  for (Vec3f& vertex : chosen.vertices_m)
    if (!vertex.allFinite()) vertex.setZero();
  if (!scene.origin_world_m.allFinite()) return refusal("the light domain's origin is not finite");
  const auto surface = make_target_surface(chosen);
  if (!surface) return tl::unexpected(surface.error());
  if (surface->triangles.empty())
    return refusal("the light domain is empty: none of its triangles has area, so luminaires can hang nowhere");

  std::uint32_t part_count = 0;
  const std::vector<std::uint32_t> parts = parts_of(*surface, part_count);
  std::vector<LightDomain::Triangle> triangles;
  std::vector<std::uint32_t> layer_of_group;
  for (std::uint32_t layer = 0; layer < options.layer_offsets_m.size(); ++layer) {
    const double offset_m = options.layer_offsets_m[layer];
    for (std::size_t t = 0; t < surface->triangles.size(); ++t) {
      LightDomain::Triangle placed{{}, {}, layer * part_count + parts[t]};
      std::array<Vec3, 3> p;
      for (std::size_t i = 0; i < 3; ++i) p[i] = surface->point_world_m(surface->triangles[t][i]) - centre_world_m;
      placed.normal = area_vector_m2(p).normalized();
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& mean = surface->normals[surface->triangles[t][i]];
        const double rise = mean.dot(placed.normal);
        placed.corners_m[i] = p[i] + offset_m * (rise * kFarthestMitre > 1 ? Vec3(mean / rise) : placed.normal);
      }
      triangles.push_back(placed);
    }
    layer_of_group.insert(layer_of_group.end(), part_count, layer);
  }
  return LightDomain::with(centre_world_m, options.cell_side, std::move(triangles), std::move(layer_of_group));
}

Result<LightDomain> nested_box_domain(const TargetSurface& target, const NestedBoxOptions& options) {
  if (options.boxes < 1) return refusal(fmt::format("{} boxes around a target are no light domain", options.boxes));
  if (options.cell_side < 1 || options.cell_side > kFinestCellSide)
    return refusal(
        fmt::format("cells of a light domain have a side of 1 to {}, not {}", kFinestCellSide, options.cell_side));
  const auto sensible = [](double m) { return m >= 0 && std::isfinite(m); };
  if (!sensible(options.margin_m) || !sensible(options.step_m))
    return refusal(fmt::format("boxes {} m from a target, {} m apart", options.margin_m, options.step_m));
  const double diagonal_m = target.diagonal_m();
  if (!(diagonal_m > 0)) return refusal("the target has no surface: there is nothing to put boxes around");
  const Vec3 centre_world_m = target.centroid_world_m();
  const double margin_m = options.margin_m > 0 ? options.margin_m : diagonal_m / 2;
  const double step_m = options.step_m > 0 ? options.step_m : margin_m;
  Eigen::AlignedBox3d bounds_m;
  for (const Vec3& point_m : target.points_m) bounds_m.extend(point_m + target.origin_world_m - centre_world_m);
  std::vector<LightDomain::Triangle> triangles;
  std::vector<std::uint32_t> layer_of_group;
  for (int box = 0; box < options.boxes; ++box) {
    const Vec3 out_m = Vec3::Constant(margin_m + box * step_m);
    const std::array<Vec3, 2> ends_m = {bounds_m.min() - out_m, bounds_m.max() + out_m};
    layer_of_group.push_back(static_cast<std::uint32_t>(box));
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const Eigen::Index u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const std::size_t end : {0u, 1u}) {
        const auto corner = [&](std::size_t at_u, std::size_t at_v) {
          Vec3 p;
          p[axis] = ends_m[end][axis];
          p[u] = ends_m[at_u][u];
          p[v] = ends_m[at_v][v];
          return p;
        };
        const Vec3 normal = (end == 1 ? 1.0 : -1.0) * Vec3::Unit(axis);
        const auto group = static_cast<std::uint32_t>(box);
        triangles.push_back({{corner(0, 0), corner(1, 0), corner(1, 1)}, normal, group});
        triangles.push_back({{corner(0, 0), corner(1, 1), corner(0, 1)}, normal, group});
      }
    }
  }
  return LightDomain::with(centre_world_m, options.cell_side, std::move(triangles), std::move(layer_of_group));
}

}  // namespace luxrig
