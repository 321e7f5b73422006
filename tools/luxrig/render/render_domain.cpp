#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/highlight/lights/domain_votes.h"
#include "core/solve/placement/scene/mounting.h"
#include "tools/luxrig/render/render_show.h"
#include "tools/terminal/command.h"
#include "tools/terminal/picture_png.h"

namespace luxrig {
namespace {

const Vec3 kRoom = Vec3::Constant(0.78), kShownObject(0.60, 0.56, 0.50);
/// Cells with less than this share of the heaviest are left out: they would be specks. Those of boxes would also stand
/// between eye and object.
constexpr double kMinShareMounted = 0.02, kMinShareOfBoxes = 0.15;

struct WeighedCell {
  Vec3 centre_world_m;
  Vec3 normal;
  double radius_m;
  double weight;
};

struct WeighedDomain {
  std::vector<WeighedCell> cells;
  bool mounted = false;  ///< on the rig's surfaces, not on boxes
  std::uint32_t layers = 1;
};

/// Normal of the domain at a cell's centre; towards the target if it cannot be found.
Vec3 normal_at(const LightDomain& domain, const DomainVotes::Cell& cell) {
  const Vec3 way_m = cell.centre_world_m - domain.centre_world_m();
  std::vector<DomainHit> hits;
  const Vec3f direction = way_m.cast<float>();
  domain.hits_along(domain.centre_world_m(), {&direction, 1}, hits);
  Vec3 normal = way_m.normalized();
  double nearest_m = 1e-3 * way_m.norm();
  for (const DomainHit& hit : hits) {
    const LightDomain::Triangle& triangle = domain.triangles()[hit.triangle];
    if (triangle.group != cell.cell.group || std::abs(hit.distance_m - way_m.norm()) > nearest_m) continue;
    nearest_m = std::abs(hit.distance_m - way_m.norm());
    normal = triangle.normal;
  }
  return normal;
}

/// The rig's mounting surfaces, with luminaires midway between the offsets, on both sides. Without mounting surfaces,
/// boxes.
Result<LightDomain> domain_of(const ShownRig& rig, const ShownObject& object, const Mounting& mounting) {
  if (mounting.is_surface().empty()) return nested_box_domain(object.study.surface, {});
  const double off_m = (rig.rig.mounting.offset_min_m + rig.rig.mounting.offset_max_m) / 2;
  LightDomainOptions how;
  how.layer_offsets_m = {off_m, -off_m};
  return mesh_light_domain(rig.scene, mounting.is_surface(), object.study.surface.centroid_world_m(), how);
}

Result<WeighedDomain> weigh(const ShownRig& rig, const ShownObject& object, const RayScene& rays,
                            const RenderOptions& options) {
  const auto mounting = Mounting::make(rig.rig.mounting, rig.rig.file, rig.scene, rays);
  if (!mounting) return refusal(mounting.error().front().text());
  const auto domain = domain_of(rig, object, *mounting);
  if (!domain) return tl::unexpected(domain.error());
  const auto edges = shown_shadow_edges(object, options);
  if (!edges) return tl::unexpected(edges.error());
  const RayScene rest(object.rest);
  DomainVoteOptions how;
  how.surroundings.environment = &rest;
  how.threads = options.threads;
  how.watch = {stop_on_signals(), progress_line("votes on the light domain")};
  const auto votes = vote_on_domain(*domain, *edges, object.study.points, object.study.features.cluster_of_point, how);
  if (!votes) return tl::unexpected(votes.error());

  WeighedDomain weighed;
  weighed.mounted = !mounting->is_surface().empty();
  weighed.layers = domain->layer_of(domain->groups() - 1) + 1;
  const double cell_rad = std::sqrt(4 * kPi / domain->bins().count());
  for (std::size_t c = 0; c < votes->cells.size(); ++c) {
    const DomainVotes::Cell& cell = votes->cells[c];
    if (weighed.mounted && !mounting->may_hang(cell.centre_world_m)) continue;
    double weight = 0;
    for (const DomainVote& vote : votes->of(c)) weight += votes->weight(vote);
    const double away_m = (cell.centre_world_m - domain->centre_world_m()).norm();
    weighed.cells.push_back(
        {cell.centre_world_m, normal_at(*domain, cell), 0.45 * cell_rad * away_m, weight * votes->every});
  }
  if (weighed.cells.empty())
    return refusal(
        "no shadow edge of the object reaches a place where [mounting] lets a light hang: widen its "
        "surfaces, box or offsets");
  return weighed;
}

/// From beside and above the viewer, for whom the near sides of the boxes would hide the object.
CutAwayCamera view_of_boxes(std::span<const Vec3> shown, const Vec3& towards_viewer, double fov_rad,
                            const RenderOptions& options) {
  const Vec3 beside = Eigen::AngleAxisd(rad_from_deg(40), Vec3::UnitZ()) * towards_viewer;
  CutAwayCamera view;
  view.camera =
      camera_that_shows(shown, beside + 0.3 * Vec3::UnitZ(), 0.9, fov_rad, options.width_px, options.height_px);
  view.near_m = std::numeric_limits<double>::infinity();
  for (const Vec3& point : shown) view.near_m = std::min(view.near_m, (point - view.camera.eye_world_m).norm());
  view.near_m *= 0.98;
  return view;
}

}  // namespace

Result<Figure> domain_figure(const ShownRig& rig, const ShownObject& object, const RenderOptions& options) {
  const RayScene rays(rig.scene);
  const auto domain = weigh(rig, object, rays, options);
  if (!domain) return tl::unexpected(domain.error());
  const auto heaviest = std::ranges::max_element(domain->cells, {}, &WeighedCell::weight);

  std::vector<Vec3> shown;
  std::vector<Sight> wanted;
  for (const OrientedPoint& point : object.study.points) {
    shown.push_back(point.position_world_m);
    wanted.push_back({point.position_world_m, point.normal, 1.0 / static_cast<double>(object.study.points.size())});
  }
  const double min_share = domain->mounted ? kMinShareMounted : kMinShareOfBoxes;
  double weight_sum = 0;
  for (const WeighedCell& cell : domain->cells) weight_sum += cell.weight;
  for (const WeighedCell& cell : domain->cells) {
    if (cell.weight >= min_share * heaviest->weight) shown.push_back(cell.centre_world_m);
    wanted.push_back({cell.centre_world_m, Vec3::Zero(), cell.weight / weight_sum});
  }
  const double fov_rad = rad_from_deg(options.vertical_fov_deg.value_or(kShowFov_deg));
  const CutAwayCamera view = as_asked(
      domain->mounted ? camera_that_sees(rays, shown, wanted, 0.9, fov_rad, options.width_px, options.height_px)
                      : view_of_boxes(shown, object.towards_viewer, fov_rad, options),
      options);
  if (!((view.camera.target_world_m - view.camera.eye_world_m).norm() > 0))
    return refusal("camera's target lies in its eye");
  SurfacePicture picture(view.camera, kShowSamplesPerEdge, view.near_m, Vec3f::Ones());
  const bool done = picture.draw(
      rays,
      [&](const Hit& hit, const Vec3& towards_eye) {
        const bool of_it = rig.scene.object_names[rig.scene.object_of_triangle[hit.triangle]] == object.name;
        return shaded(of_it ? kShownObject : kRoom, hit.normal_world, towards_eye);
      },
      options.threads, {stop_on_signals(), progress_line("drawing")});
  if (!done) return tl::unexpected(Fault{Cause::cancelled, "", "the drawing was stopped", {}});
  std::vector<Disc> discs;
  for (const WeighedCell& cell : domain->cells) {
    const double share = cell.weight / heaviest->weight;
    if (share < min_share) continue;
    Disc disc{cell.centre_world_m, cell.normal, cell.radius_m, 0, viridis(share).cast<float>(), 1};
    // Boxes stand before the object. Cells of little weight are small and pale, so that the object shows through.
    if (!domain->mounted) {
      disc.radius_m *= std::sqrt(share);
      disc.opacity = std::min(1.0, 0.2 + share);
    }
    discs.push_back(disc);
  }
  picture.draw(discs);

  Figure figure;
  figure.picture = picture.resolved();
  figure.caption = fmt::format(
      "{} Each spot is a place for a lamp; its colour says how many of the object's shadow edges it is on, each "
      "counting 1 / distance².",
      domain->mounted ? "Where [mounting] lets lights hang."
                      : fmt::format("{} boxes around the object, as the rig has no mounting surfaces; larger spots "
                                    "weigh more.",
                                    domain->layers));
  figure.scale = FigureScale{"weight of votes, 1/m²", 0, heaviest->weight, viridis, "", ""};
  if (const auto place = place_in_picture(view.camera, heaviest->centre_world_m)) {
    FigureLabel label;
    label.x_px = place->x_px, label.y_px = place->y_px;
    label.mark = FigureMark::ring;
    label.rgb = Vec3(0.84, 0.1, 0.1);
    figure.labels.push_back(label);
    const Vec3& at = heaviest->centre_world_m;
    figure.key.push_back({FigureMark::ring, label.rgb,
                          fmt::format("the heaviest, at {:.2f}, {:.2f}, {:.2f} m", at.x(), at.y(), at.z())});
  }
  figure.key.push_back({FigureMark::dot, kShownObject, object.name});
  figure.key.push_back({FigureMark::none, Vec3::Zero(),
                        fmt::format("{} places; those below {:g} % of the heaviest are left out", domain->cells.size(),
                                    100 * min_share)});
  return figure;
}

}  // namespace luxrig
