#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/highlight/picture/feature_palette.h"
#include "tools/luxrig/render/render_show.h"
#include "tools/terminal/command.h"
#include "tools/terminal/picture_png.h"

namespace luxrig {
namespace {

const Vec3 kPlainObject = Vec3::Constant(0.86);
const Vec3 kUnknownCurvature(0.55, 0.55, 0.5);
const Vec3 kInterestRgb(0.80, 0.27, 0.0);
const Vec3 kSmallFeature = Vec3::Constant(0.45);
/// Features with fewer points have no visible shape.
constexpr std::uint32_t kFeaturePoints = 4;

/// Okabe and Ito's colours for all kinds of colour vision, without black.
const std::vector<Vec3> kFeatureRgb = {{0.00, 0.45, 0.70}, {0.90, 0.62, 0.00}, {0.00, 0.62, 0.45}, {0.80, 0.47, 0.65},
                                       {0.84, 0.37, 0.00}, {0.34, 0.71, 0.91}, {0.94, 0.89, 0.26}};

CutAwayCamera camera_on_object(const ShownObject& object, const RenderOptions& options) {
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < object.study.mesh.points_m.size(); ++i)
    points.push_back(object.study.mesh.point_world_m(i));
  constexpr double kFill = 0.75;
  return as_asked({camera_that_shows(points, object.towards_viewer, kFill,
                                     rad_from_deg(options.vertical_fov_deg.value_or(kShowFov_deg)), options.width_px,
                                     options.height_px),
                   0, 0},
                  options);
}

/// The object alone on white, coloured by colour_of(corners).
template <class ColourOf>
Result<SurfacePicture> object_picture(const ShownObject& object, const RenderOptions& options,
                                      const ColourOf& colour_of) {
  const CutAwayCamera view = camera_on_object(object, options);
  if (!((view.camera.target_world_m - view.camera.eye_world_m).norm() > 0))
    return refusal("camera's target lies in its eye");
  SurfacePicture picture(view.camera, kShowSamplesPerEdge, view.near_m, Vec3f::Ones());
  const RayScene rays(object.target);
  const bool done =
      picture.draw(rays,
                   [&](const Hit& hit, const Vec3& towards_eye) {
                     const auto corners = corners_at(object.target, object.study.mesh, hit);
                     if (!corners) return shaded(kUnknownCurvature, hit.normal_world, towards_eye);
                     const Vec3 smooth = corners->normal(object.study.mesh);
                     return shaded(colour_of(*corners), smooth.isZero(0) ? hit.normal_world : smooth, towards_eye);
                   },
                   options.threads, {stop_on_signals(), progress_line("drawing")});
  if (!done) return tl::unexpected(Fault{Cause::cancelled, "", "the drawing was stopped", {}});
  return picture;
}

/// Not exceeded in absolute value on 95 % of the known area.
double usual_curvature_per_m(const TargetSurface& surface, std::span<const Curvature> curvature) {
  std::vector<std::pair<double, double>> sizes;  // and areas
  double area_m2 = 0;
  for (std::size_t i = 0; i < curvature.size(); ++i) {
    if (!curvature[i].known()) continue;
    sizes.emplace_back(std::abs(curvature[i].mean_per_m()), surface.areas_m2[i]);
    area_m2 += surface.areas_m2[i];
  }
  std::ranges::sort(sizes);
  double below_m2 = 0;
  for (const auto& [size, area] : sizes) {
    below_m2 += area;
    if (below_m2 >= 0.95 * area_m2) return size;
  }
  return sizes.empty() ? 0 : sizes.back().first;
}

/// Discs on the surface at the interest points, as large as they have room for.
std::vector<Disc> interest_discs(const ShownObject& object, double size) {
  const ReliefStudy& study = object.study;
  double area_m2 = 0;
  for (const std::uint32_t i : study.interest) area_m2 += study.surface.areas_m2[i];
  const double radius_m =
      size * std::max(0.0025 * study.surface.diagonal_m(),
                      std::sqrt(area_m2 / static_cast<double>(std::max<std::size_t>(1, study.interest.size())) / kPi));
  std::vector<Disc> discs;
  for (const OrientedPoint& point : study.points)
    discs.push_back({point.position_world_m, point.normal, radius_m, 1.5 * radius_m, kInterestRgb.cast<float>(), 1});
  return discs;
}

}  // namespace

Result<Figure> curvature_figure(const ShownObject& object, const RenderOptions& options) {
  const ReliefStudy& study = object.study;
  // Drawn between the corners of the mesh. The study has curvature at its own points only.
  const auto curvature =
      curvature_of(study.mesh, {{.threads = options.threads, .watch = {stop_on_signals(), {}}}, study.scale_m});
  if (!curvature) return tl::unexpected(curvature.error());
  std::vector<double> mean_per_m;
  bool all_known = true;
  for (const Curvature& c : *curvature) {
    mean_per_m.push_back(c.known() ? c.mean_per_m() : std::numeric_limits<double>::quiet_NaN());
    all_known = all_known && c.known();
  }
  const double top = round_up_1_2_5(std::max(1e-6, usual_curvature_per_m(study.mesh, *curvature)));
  const auto picture = object_picture(object, options, [&](const SurfaceCorners& corners) {
    const double value = corners.value(mean_per_m);
    return std::isnan(value) ? kUnknownCurvature : blue_white_red(0.5 + value / (2 * top));
  });
  if (!picture) return tl::unexpected(picture.error());
  Figure figure;
  figure.picture = picture->resolved();
  figure.caption =
      fmt::format("Mean curvature of the surface, fitted over {:.3g} mm around each point.", 1e3 * study.scale_m);
  figure.scale = FigureScale{"mean curvature, 1/m", -top, top, blue_white_red, "ridge", "recess"};
  figure.key = {
      {FigureMark::none, Vec3::Zero(),
       fmt::format("{:g} 1/m: as a ball of {:.3g} mm radius. Darker where the surface turns away.", top, 1e3 / top)}};
  if (!all_known) figure.key.push_back({FigureMark::dot, kUnknownCurvature, "not known: too few points around"});
  return figure;
}

Result<Figure> interest_figure(const ShownObject& object, const RenderOptions& options) {
  auto picture = object_picture(object, options, [](const SurfaceCorners&) { return kPlainObject; });
  if (!picture) return tl::unexpected(picture.error());
  picture->draw(interest_discs(object, 0.7));
  double min_recess_per_m = -std::numeric_limits<double>::infinity(), area_m2 = 0;
  for (const std::uint32_t i : object.study.interest) {
    min_recess_per_m = std::max(min_recess_per_m, object.study.curvature[i].mean_per_m());
    area_m2 += object.study.surface.areas_m2[i];
  }
  Figure figure;
  figure.picture = picture->resolved();
  figure.caption =
      "Places that are recessed, at which light and shadow can tell the relief. " + relief_words(object.study);
  figure.key = {{FigureMark::dot, kInterestRgb,
                 fmt::format("interest point ({} in all, those behind not seen)", object.study.interest.size())},
                {FigureMark::none, Vec3::Zero(),
                 fmt::format("mean curvature below {:.3g} 1/m; together {:.2g} % of the surface", min_recess_per_m,
                             100 * area_m2 / object.study.surface.area_m2())}};
  return figure;
}

Result<Figure> feature_figure(const ShownObject& object, const RenderOptions& options) {
  const FeatureClusters& features = object.study.features;
  auto picture = object_picture(object, options, [](const SurfaceCorners&) { return kPlainObject; });
  if (!picture) return tl::unexpected(picture.error());
  const auto colours = feature_colours(object.study.points, features, 0.05 * object.study.surface.diagonal_m(),
                                       static_cast<std::uint32_t>(kFeatureRgb.size()));
  std::vector<Disc> discs = interest_discs(object, 1.1);
  std::size_t in_small = 0;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const std::uint32_t cluster = features.cluster_of_point[i];
    const bool small = features.sizes[cluster] < kFeaturePoints;
    in_small += small;
    discs[i].rgb = (small ? kSmallFeature : kFeatureRgb[colours[cluster]]).cast<float>();
    if (small) discs[i].radius_m *= 0.6;
  }
  picture->draw(discs);
  const auto large = static_cast<std::size_t>(
      std::ranges::count_if(features.sizes, [](std::uint32_t size) { return size >= kFeaturePoints; }));
  Figure figure;
  figure.picture = picture->resolved();
  figure.caption = "Recessed places that belong together: near each other and facing much the same way. " +
                   relief_words(object.study);
  figure.key = {
      {FigureMark::dot, kFeatureRgb[0],
       fmt::format("a colour for each of {} features of {} points or more (largest: {}); few colours, but neighbours "
                   "differ",
                   large, kFeaturePoints, features.sizes.empty() ? 0 : *std::ranges::max_element(features.sizes))}};
  if (in_small > 0)
    figure.key.push_back(
        {FigureMark::dot, kSmallFeature,
         fmt::format("points of {} smaller features ({} points)", features.sizes.size() - large, in_small)});
  return figure;
}

}  // namespace luxrig
