#include "core/calibration/lux_map.h"

#include <algorithm>
#include <cmath>

#include "core/calibration/seen_surface.h"
#include "core/check.h"
#include "core/output/dimming.h"
#include "core/parallel.h"
#include "core/tasks/rig_transport.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The light is smooth, and what is not known of it is more than what pixels would add.
constexpr int kMapWidth_px = 400, kMapPasses = 48;
constexpr double kMapNoise = 0.04;
constexpr double kReach_m = 0.15;
constexpr double kSameFacing = 0.8, kFacesElsewhere = 0.02;
/// What is found over what is traced; farther off, one of both is another surface.
const double kMostLogRatio = std::log(1.5);
/// Places with less than this of the brightest say nothing of the light around, relative to it.
constexpr double kMapDarkest = 0.01;
/// More is as good as unknown.
constexpr double kMostErrorShare = 1;

/// The same view in fewer pixels.
Camera smaller(Camera camera) {
  if (camera.width_px <= kMapWidth_px) return camera;
  camera.height_px = std::max(
      1, static_cast<int>(std::lround(static_cast<double>(camera.height_px) * kMapWidth_px / camera.width_px)));
  camera.width_px = kMapWidth_px;
  return camera;
}

/// What is known at one place.
struct Node {
  Vec3 position_m, normal;
  double log_ratio = 0, error_share2 = 0;
};

/// Mean of the pixels around a place that see a surface; 0 = none does.
double traced_at(const Picture& traced, const PixelPlace& at) {
  double sum = 0;
  int count = 0;
  const int middle_x = static_cast<int>(at.x_px), middle_y = static_cast<int>(at.y_px);
  for (int y = std::max(0, middle_y - 1); y <= std::min(traced.height_px - 1, middle_y + 1); ++y)
    for (int x = std::max(0, middle_x - 1); x <= std::min(traced.width_px - 1, middle_x + 1); ++x) {
      const float lux = traced.illuminance_lx[static_cast<std::size_t>(y) * static_cast<std::size_t>(traced.width_px) +
                                              static_cast<std::size_t>(x)];
      if (lux >= 0) sum += lux, ++count;
    }
  return count > 0 ? sum / count : 0;
}

std::vector<Node> nodes_of(const Picture& traced, const Camera& camera, std::span<const LuxMap::Place> places) {
  double brightest = 0;
  for (const LuxMap::Place& place : places) brightest = std::max(brightest, place.light.lux);
  std::vector<Node> nodes;
  for (const LuxMap::Place& place : places) {
    if (!(place.light.lux > kMapDarkest * brightest)) continue;
    Node node{place.position_world_m, place.normal_world, 0,
              std::pow(std::min(kMostErrorShare, place.light.share_of_error()), 2)};
    const auto at = pixel_of(camera, place.position_world_m);
    const double lux = at ? traced_at(traced, *at) : 0;
    if (lux > 0) node.log_ratio = std::clamp(std::log(place.light.lux / lux), -kMostLogRatio, kMostLogRatio);
    nodes.push_back(node);
  }
  return nodes;
}

/// Both of a pixel by the places around.
Node between(const std::vector<Node>& nodes, const Vec3& position_m, const Vec3& normal) {
  Node mean{position_m, normal};
  double weights = 0;
  for (const Node& node : nodes) {
    const double distance2_m2 = (node.position_m - position_m).squaredNorm() + kReach_m * kReach_m;
    const double weight = (node.normal.dot(normal) > kSameFacing ? 1 : kFacesElsewhere) / (distance2_m2 * distance2_m2);
    mean.log_ratio += weight * node.log_ratio;
    mean.error_share2 += weight * node.error_share2;
    weights += weight;
  }
  mean.log_ratio /= weights;
  mean.error_share2 /= weights;
  return mean;
}

}  // namespace

LampShares lamp_shares(const LightUnknowns& known, std::span<const LampCurve> curves, std::span<const double> level,
                       double dimmer_exponent) {
  LUXRIG_CHECK(level.size() == curves.size(), "{} levels and {} curves", level.size(), curves.size());
  const auto fixtures = static_cast<Index>(level.size());
  LampShares shares{VectorXd::Zero(fixtures), VectorXd::Zero(fixtures)};
  for (std::size_t f = 0; f < level.size(); ++f) {
    if (!(level[f] > 0)) continue;
    const auto j = static_cast<Index>(f);
    shares.share[j] = share_at_level(curves[f].of_level, level[f]);
    shares.error[j] = curves[f].of_level.empty() ? dimmer_exponent * std::abs(std::log(level[f] / known.read_at(f)))
                                                 : curves[f].error;
  }
  return shares;
}

std::vector<LuxMap::Place> map_places(const Rig& rig, const RigLight& light, const Camera& camera,
                                      std::span<const SeenPlace> places, std::size_t first_receiver,
                                      const LampShares& shares) {
  const LightUnknowns& known = light.known();
  std::vector<LuxMap::Place> map;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const std::size_t receiver = first_receiver + k;
    const auto shown = pixel_of(camera, places[k].position_world_m);
    if (!shown) continue;
    LuxMap::Place place{{},          places[k].position_world_m,      places[k].normal_world, shown->x_px,
                        shown->y_px, known.at(receiver, shares.share)};
    for (const Point& point : rig.points)
      if (point.position_world_m == place.position_world_m) place.point = point.name;
    double variance = std::pow(place.light.standard_error_lx, 2);
    for (Index j = 0; j < shares.share.size(); ++j)
      variance += std::pow(shares.error[j] * shares.share[j] * known.gain(static_cast<std::size_t>(j)) *
                               light.stated_lux()(static_cast<Index>(receiver), j),
                           2);
    place.light.lux = std::max(0.0, place.light.lux);
    place.light.standard_error_lx = std::sqrt(variance);
    map.push_back(std::move(place));
  }
  return map;
}

Result<LuxMapPictures> map_pictures(const Session& found, const Camera& camera, std::span<const LuxMap::Place> places,
                                    const VectorXd& share, const Run& run) {
  const Camera view = smaller(camera);
  PictureOptions how;
  how.run() = run;
  how.max_passes = kMapPasses;
  how.wanted_relative_error = kMapNoise;
  const std::vector<double> levels(share.begin(), share.end());
  auto traced = render_picture(*found.rays, emitters_of(found.rig), levels, view, how);
  if (!traced) return tl::unexpected(traced.error());
  traced->luminance_cd_m2.clear();
  LuxMapPictures map{*traced, *traced};
  const std::vector<Node> nodes = nodes_of(*traced, view, places);
  const SeenSurface surface = seen_surface(*found.rays, view, run.threads);
  parallel_for(static_cast<std::size_t>(view.height_px), run.threads, [&](std::size_t row) {
    for (std::size_t i = row * static_cast<std::size_t>(view.width_px), x = 0;
         x < static_cast<std::size_t>(view.width_px); ++x, ++i) {
      const SurfacePixel& pixel = surface.pixels[i];
      float& lux = map.lux.illuminance_lx[i];
      float& error = map.error_percent.illuminance_lx[i];
      if (!pixel.seen() || lux < 0 || nodes.empty()) {
        lux = error = -1;
        continue;
      }
      const Node here = between(nodes, surface.position_world_m(pixel), pixel.normal.cast<double>());
      lux = static_cast<float>(lux * std::exp(here.log_ratio));
      error = static_cast<float>(100 * std::sqrt(here.error_share2));
    }
  });
  return map;
}

}  // namespace luxrig
