#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/highlight/picture/direction_map.h"
#include "core/highlight/shadow/distant_lights.h"
#include "tools/luxrig/render/render_show.h"
#include "tools/terminal/command.h"
#include "tools/terminal/picture_png.h"

namespace luxrig {
namespace {

const Vec3 kChosenRgb(0.84, 0.1, 0.1);
const Vec3 kHeadRgb(0.1, 0.1, 0.1);
/// Things nearer than this many diagonals of the object hide directions. Walls farther away do not, because lamps hang
/// in front of them.
constexpr double kReachDiagonals = 2;

/// Places of the two discs in a picture.
struct DiscLayout {
  double radius_px, middle_y_px, front_x_px, back_x_px;

  explicit DiscLayout(const RenderOptions& options)
      : radius_px(std::max(4.0, std::min(options.width_px / 4.0 - 16, options.height_px / 2.0 - 34))),
        middle_y_px(options.height_px / 2.0 + 8),
        front_x_px(options.width_px / 4.0),
        back_x_px(options.width_px * 3 / 4.0) {}

  [[nodiscard]] std::optional<DirectionMap::MapPoint> place_at(double x_px, double y_px) const {
    for (const bool behind : {false, true}) {
      const double x = (x_px - (behind ? back_x_px : front_x_px)) / radius_px, y = (middle_y_px - y_px) / radius_px;
      if (x * x + y * y <= 1) return DirectionMap::MapPoint{behind, x, y};
    }
    return std::nullopt;
  }

  [[nodiscard]] FigureLabel label_at(const DirectionMap::MapPoint& place) const {
    FigureLabel label;
    label.x_px = (place.behind ? back_x_px : front_x_px) + radius_px * place.x;
    label.y_px = middle_y_px - radius_px * place.y;
    return label;
  }
};

ColourPicture discs_of(const DirectionHistogram& histogram, const DirectionMap& map, double top_votes,
                       const RenderOptions& options) {
  const DiscLayout layout(options);
  ColourPicture picture{options.width_px, options.height_px, {}};
  for (int y = 0; y < options.height_px; ++y)
    for (int x = 0; x < options.width_px; ++x) {
      Vec3 sum = Vec3::Zero();
      for (int j = 0; j < kShowSamplesPerEdge; ++j)
        for (int i = 0; i < kShowSamplesPerEdge; ++i) {
          const auto place = layout.place_at(x + (i + 0.5) / kShowSamplesPerEdge, y + (j + 0.5) / kShowSamplesPerEdge);
          sum += place ? viridis(histogram.votes[histogram.bins.bin_of(map.direction_at(*place))] / top_votes)
                       : Vec3(Vec3::Ones());
        }
      picture.rgb.push_back((sum / (kShowSamplesPerEdge * kShowSamplesPerEdge)).cast<float>());
    }
  return picture;
}

/// Lights that could be aimed at the object: those that move. If none moves, those whose beam axis passes it.
std::vector<const Fixture*> fixtures_for(const ShownRig& rig, const ShownObject& object) {
  std::vector<const Fixture*> moving, passing;
  const Vec3 middle_m = object.study.surface.centroid_world_m();
  for (std::size_t f = 0; f < rig.rig.fixtures.size(); ++f) {
    const Fixture& fixture = rig.rig.fixtures[f];
    if (fixture.housing && *fixture.housing != f) continue;
    if (fixture.moves) moving.push_back(&fixture);
    const Pose pose = fixture.world_from_lamp(rig.look.joints[f]);
    const Vec3 way_m = middle_m - pose.translation_m, axis = pose.direction(-Vec3::UnitZ());
    if (way_m.dot(axis) > 0 && way_m.cross(axis).norm() < object.study.surface.diagonal_m())
      passing.push_back(&fixture);
  }
  return moving.empty() ? passing : moving;
}

void add_axes(Figure& figure, const DirectionMap& map, const DiscLayout& layout) {
  constexpr const char* kNames[] = {"+x", "+y", "+z"};
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      FigureLabel label = layout.label_at(map.place_of(sign * Vec3::Unit(axis)));
      label.words = kNames[axis];
      if (sign < 0) label.words[0] = '-';
      label.rgb = Vec3::Constant(0.25);
      for (const FigureLabel& mark : figure.labels)
        if (std::hypot(mark.x_px - label.x_px, mark.y_px - label.y_px) < 16) label.y_px = mark.y_px + 18;
      figure.labels.push_back(label);
    }
  for (const bool behind : {false, true}) {
    FigureLabel label;
    label.x_px = behind ? layout.back_x_px : layout.front_x_px;
    label.y_px = layout.middle_y_px - layout.radius_px - 14;
    label.words = behind ? "light from behind" : "light from the viewer's side";
    label.rgb = Vec3::Constant(0.1);
    figure.labels.push_back(label);
  }
}

}  // namespace

Result<Figure> histogram_figure(const ShownRig& rig, const ShownObject& object, const RenderOptions& options) {
  auto edges = shown_shadow_edges(object, options);
  if (!edges) return tl::unexpected(edges.error());
  const double reach_m = kReachDiagonals * object.study.surface.diagonal_m();
  if (!object.rest.triangles.empty())
    *edges = reachable_edges(*edges, object.study.points, RayScene(object.rest), reach_m, options.threads);
  const auto histogram = vote_directions(*edges, object.study.points, DirectionBins(), options.threads);
  const auto chosen = distant_lights(histogram, {options.lights, 0.33});
  if (!chosen) return tl::unexpected(chosen.error());

  const Vec3 viewer = options.eye_world_m ? Vec3(*options.eye_world_m - object.study.surface.centroid_world_m())
                                          : object.towards_viewer;
  if (!(viewer.norm() > 0)) return refusal("the eye is in the middle of the object");
  const DirectionMap map(viewer);
  const DiscLayout layout(options);
  const double top = *std::ranges::max_element(histogram.votes);
  Figure figure;
  figure.picture = discs_of(histogram, map, top, options);
  figure.caption = fmt::format(
      "The sphere of directions around the object, in two halves as the viewer sees them; left is left on both, equal "
      "areas are equal angles. {} votes: one for each direction from which the object's own relief just shades an "
      "interest point and that is clear for {:.2g} m.",
      histogram.total(), reach_m);
  figure.scale = FigureScale{fmt::format("votes per cell, {:.2g}° wide", 58.6 / histogram.bins.side()),
                             0,
                             top,
                             viridis,
                             "many shadow edges",
                             "none"};
  for (const Fixture* fixture : fixtures_for(rig, object)) {
    const Vec3 way_m = fixture->world_from_lamp().translation_m - object.study.surface.centroid_world_m();
    if (!(way_m.norm() > 0)) continue;
    FigureLabel label = layout.label_at(map.place_of(way_m));
    label.mark = FigureMark::diamond;
    label.rgb = kHeadRgb;
    label.words = fixture->name;
    figure.labels.push_back(label);
  }
  for (std::size_t i = 0; i < chosen->size(); ++i) {
    FigureLabel label = layout.label_at(map.place_of((*chosen)[i].direction));
    label.mark = FigureMark::ring;
    label.rgb = kChosenRgb;
    label.words = fmt::format("{}", i + 1);
    figure.labels.push_back(label);
  }
  add_axes(figure, map, layout);
  figure.key = {{FigureMark::ring, kChosenRgb,
                 fmt::format("{} chosen for distant lights, 1 with most votes around it", chosen->size())},
                {FigureMark::diamond, kHeadRgb, "where the rig's lamps hang"}};
  return figure;
}

}  // namespace luxrig
