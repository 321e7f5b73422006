#include "core/calibration/camera_pose.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/calibration/scene_edges.h"
#include "core/check.h"
#include "core/photometry/light_colour.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

/// Eye to the right, up and ahead [m]; turns to the right, up and about the axis [rad]; log field of view; distortion.
constexpr Index kUnknowns = kCameraUnknowns;
using Change = Eigen::Matrix<double, kUnknowns, 1>;
using Square = CameraCovariance;
/// Standard deviations of what is stated, and steps of differences.
const Change kPrior = (Change() << 0.05, 0.05, 0.05, 0.03, 0.03, 0.03, 0.03, 0.03).finished();
const Change kStep = (Change() << 1e-3, 1e-3, 1e-3, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4).finished();

constexpr std::size_t kLeastEdges = 60;
constexpr std::size_t kHeldOutEvery = 4;  // one of so many
/// Distances within which an edge is looked for, one round after the other [px].
constexpr double kReach_px[] = {8, 8, 6, 6, 4, 4, 4, 3, 3, 3, 2, 2, 2, 2, 2, 2};
constexpr double kTestReach_px = 6;
constexpr double kMostOff_px = 0.8, kMostError_px = 0.7;
/// An edge's change of brightness is this many times what is usual in the picture.
constexpr double kOverUsual = 3;
constexpr double kFarthest = 3;  // standard deviations of what is stated
constexpr double kLeastScatter_px = 0.1;
/// Places along one edge are off together: so many count as one.
constexpr double kAlike = 9;

Camera changed(const Camera& stated, const Change& by) {
  const Vec3 to_target_m = stated.target_world_m - stated.eye_world_m, ahead = to_target_m.normalized();
  const Vec3 right = ahead.cross(std::abs(ahead.z()) > 0.999 ? Vec3::UnitY() : Vec3::UnitZ()).normalized();
  const Vec3 up = right.cross(ahead);
  Camera camera = stated;
  camera.eye_world_m += by[0] * right + by[1] * up + by[2] * ahead;
  camera.target_world_m =
      camera.eye_world_m + to_target_m.norm() * (ahead + std::tan(by[3]) * right + std::tan(by[4]) * up).normalized();
  camera.roll_rad += by[5];
  camera.vertical_fov_rad *= std::exp(by[6]);
  camera.distortion += by[7];
  return camera;
}

/// How brightness changes in a picture: of its logarithm, smoothed.
class Gradient {
 public:
  Gradient(const Picture& picture, int smoothings) : width_(picture.width_px), height_(picture.height_px) {
    std::vector<double> light;
    double mean = 0;
    for (const Vec3f& pixel : picture.luminance_cd_m2) {
      light.push_back(std::max(0.0, luminance_of_rgb(pixel.cast<double>())));
      mean += light.back() / static_cast<double>(picture.luminance_cd_m2.size());
    }
    constexpr double kDark = 0.03;  // of the mean: below, noise
    for (double& value : light) value = mean > 0 ? std::log(value / mean + kDark) : 0;
    for (int k = 0; k < smoothings; ++k) smooth(light);
    change_.resize(light.size(), Vector2d::Zero());
    for (int y = 1; y + 1 < height_; ++y)
      for (int x = 1; x + 1 < width_; ++x)
        change_[at(x, y)] = {(light[at(x + 1, y)] - light[at(x - 1, y)]) / 2,
                             (light[at(x, y + 1)] - light[at(x, y - 1)]) / 2};
    constexpr int kEvery = 5;
    std::vector<double> sizes;
    for (int y = kEvery; y + kEvery < height_; y += kEvery)
      for (int x = kEvery; x + kEvery < width_; x += kEvery)
        for (const Vector2d& normal : {Vector2d(1, 0), Vector2d(0, 1)}) sizes.push_back(across({x, y}, normal));
    if (sizes.empty()) return;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    usual_ = std::max(usual_, *middle);
  }
  /// Across an edge with this normal, at a place from the top left corner: the mean along a short piece of the edge.
  [[nodiscard]] double across(const Vector2d& place_px, const Vector2d& normal) const {
    constexpr int kAlong_px = 3;
    Vector2d sum = Vector2d::Zero();
    for (int k = -kAlong_px; k <= kAlong_px; ++k) sum += change(place_px + k * Vector2d(-normal.y(), normal.x()));
    return std::abs(sum.dot(normal)) / (2 * kAlong_px + 1);
  }
  [[nodiscard]] double usual() const { return usual_; }

 private:
  [[nodiscard]] Vector2d change(const Vector2d& place_px) const {
    const double x = place_px.x() - 0.5, y = place_px.y() - 0.5;
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    if (left < 0 || top < 0 || left + 1 >= width_ || top + 1 >= height_) return Vector2d::Zero();
    const double u = x - left, v = y - top;
    return (1 - v) * ((1 - u) * change_[at(left, top)] + u * change_[at(left + 1, top)]) +
           v * ((1 - u) * change_[at(left, top + 1)] + u * change_[at(left + 1, top + 1)]);
  }
  [[nodiscard]] std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  void smooth(std::vector<double>& light) const {
    const std::vector<double> before = light;
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        double sum = 0;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx)
            sum += (2 - std::abs(dx)) * (2 - std::abs(dy)) *
                   before[at(std::clamp(x + dx, 0, width_ - 1), std::clamp(y + dy, 0, height_ - 1))];
        light[at(x, y)] = sum / 16;
      }
  }
  int width_, height_;
  std::vector<Vector2d> change_;
  double usual_ = 1e-9;  ///< median of across()
};

std::optional<Vector2d> shown(const Camera& camera, const SceneEdge& edge) {
  const auto place = pixel_of(camera, edge.position_world_m);
  if (!place) return std::nullopt;
  return Vector2d(place->x_px, place->y_px);
}

/// How far along its normal from where it is shown an edge is seen; none = the picture shows no clear one.
std::optional<double> edge_seen_at(const Gradient& gradient, const Vector2d& shown_px, const SceneEdge& edge,
                                   double reach_px) {
  constexpr double kApart_px = 0.5, kFarther = 0.5;
  const int steps = static_cast<int>(reach_px / kApart_px);
  const auto change = [&](int k) { return gradient.across(shown_px + k * kApart_px * edge.normal_px, edge.normal_px); };
  int best = 0;
  double best_worth = -1;
  for (int k = -steps; k <= steps; ++k) {
    const double share = static_cast<double>(k) / steps, worth = change(k) * (1 - kFarther * share * share);
    if (worth > best_worth) best = k, best_worth = worth;
  }
  const double before = change(best - 1), there = change(best), after = change(best + 1);
  if (there < kOverUsual * gradient.usual() || before > there || after > there) return std::nullopt;
  const double bend = before - 2 * there + after;
  return kApart_px * (best + (bend < 0 ? 0.5 * (before - after) / bend : 0));
}

/// The turn, roll and field of view under which most edges lie on changes of brightness.
Change best_turn(const Gradient& gradient, const Camera& stated, std::span<const SceneEdge> edges) {
  const double per_px = 2 * std::tan(stated.vertical_fov_rad / 2) / stated.height_px;
  const double most_rad = std::max(0.02, 4 * per_px), step_rad = 2 * per_px;
  const int steps = static_cast<int>(std::ceil(most_rad / step_rad));
  constexpr std::size_t kEnough = 400;
  const std::size_t every = std::max<std::size_t>(1, edges.size() / kEnough);
  Change best = Change::Zero();
  double best_score = -1;
  for (const double roll_rad : {-0.012, 0.0, 0.012})
    for (const double field : {-0.015, 0.0, 0.015})
      for (int i = -steps; i <= steps; ++i)
        for (int j = -steps; j <= steps; ++j) {
          Change by = Change::Zero();
          by.segment<4>(3) << i * step_rad, j * step_rad, roll_rad, field;
          const Camera camera = changed(stated, by);
          double score = 0;
          for (std::size_t e = 0; e < edges.size(); e += every)
            if (const auto place = shown(camera, edges[e])) {
              const double change = gradient.across(*place, edges[e].normal_px);
              score +=
                  change / (change + kOverUsual * gradient.usual());  // a lamp's edge is not worth a hundred others
            }
          if (score > best_score) best = by, best_score = score;
        }
  return best;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Where an edge is seen off where a camera shows it, and how that follows from a change of the camera.
struct SeenEdge {
  double off_px = 0;
  Change slope = Change::Zero();
};

std::vector<double> distances_px(const std::vector<SeenEdge>& seen) {
  std::vector<double> off;
  for (const SeenEdge& one : seen) off.push_back(std::abs(one.off_px));
  return off;
}

class Fit {
 public:
  /// coarse: of the picture out of focus, in which edges are found from farther.
  Fit(const Gradient& coarse, const Gradient& gradient, const Camera& stated, std::span<const SceneEdge> edges)
      : gradient_(gradient), stated_(stated), edges_(edges), by_(best_turn(coarse, stated, edges)) {}

  /// Of edges with number % kHeldOutEvery == 0, or the others.
  [[nodiscard]] std::vector<SeenEdge> seen(const Change& by, bool held_out, double reach_px) const {
    const Camera camera = changed(stated_, by);
    std::vector<Camera> around;
    for (Index k = 0; k < kUnknowns; ++k) around.push_back(changed(stated_, by + kStep[k] * Change::Unit(k)));
    std::vector<SeenEdge> seen;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if ((e % kHeldOutEvery == 0) != held_out) continue;
      const auto place = shown(camera, edges_[e]);
      if (!place) continue;
      const auto off_px = edge_seen_at(gradient_, *place, edges_[e], reach_px);
      if (!off_px) continue;
      SeenEdge one{*off_px, {}};
      bool whole = true;
      for (Index k = 0; k < kUnknowns && whole; ++k) {
        const auto moved = shown(around[static_cast<std::size_t>(k)], edges_[e]);
        whole = moved.has_value();
        if (whole) one.slope[k] = edges_[e].normal_px.dot(*moved - *place) / kStep[k];
      }
      if (whole) seen.push_back(one);
    }
    return seen;
  }

  /// One round of least squares; false = too few edges are seen.
  [[nodiscard]] bool step(double reach_px) {
    const std::vector<SeenEdge> seen = this->seen(by_, false, reach_px);
    edges_seen_ = seen.size();
    if (seen.size() < kLeastEdges) return false;
    const double scatter_px = std::max(kLeastScatter_px, 1.48 * median_of(distances_px(seen))),
                 widest_px = 4.7 * scatter_px;
    information_ = kPrior.cwiseAbs2().cwiseInverse().asDiagonal();
    Change pull = -information_ * by_;
    for (const SeenEdge& one : seen) {
      const double share = one.off_px / widest_px;
      if (std::abs(share) >= 1) continue;
      const double weight = (1 - share * share) * (1 - share * share) / (scatter_px * scatter_px * kAlike);
      information_ += weight * one.slope * one.slope.transpose();
      pull += weight * one.off_px * one.slope;
    }
    by_ += information_.ldlt().solve(pull);
    return by_.allFinite();
  }
  [[nodiscard]] const Change& by() const { return by_; }
  [[nodiscard]] std::size_t edges_seen() const { return edges_seen_; }
  [[nodiscard]] Square covariance() const { return information_.ldlt().solve(Square::Identity()); }

 private:
  const Gradient& gradient_;
  const Camera& stated_;
  std::span<const SceneEdge> edges_;
  Change by_;
  Square information_ = Square::Zero();
  std::size_t edges_seen_ = 0;
};

/// Median distance across the edges between where two cameras show them.
double shown_off_px(const Camera& a, const Camera& b, std::span<const SceneEdge> edges) {
  std::vector<double> off;
  for (const SceneEdge& edge : edges) {
    const auto by_a = shown(a, edge), by_b = shown(b, edge);
    if (by_a && by_b) off.push_back(std::abs(edge.normal_px.dot(*by_a - *by_b)));
  }
  return off.empty() ? INFINITY : median_of(std::move(off));
}

/// Median over the picture of the error of where places are shown: what is at arm's length moves by much, and matters
/// little.
double error_of_places_px(const RayScene& rays, const Camera& camera, const Square& covariance) {
  constexpr int kAcross = 12;
  std::vector<double> error_px;
  for (int i = 0; i < kAcross * kAcross; ++i) {
    const double x_px = (i % kAcross + 0.5) / kAcross * camera.width_px;
    const double y_px = (i / kAcross + 0.5) / kAcross * camera.height_px;
    const auto hit = rays.nearest(camera.eye_world_m, ray_direction(camera, x_px, y_px), Vec3::Zero());
    if (!hit) continue;
    Eigen::Matrix<double, 2, kUnknowns> slope;
    for (Index k = 0; k < kUnknowns; ++k) {
      const auto place = pixel_of(changed(camera, kStep[k] * Change::Unit(k)), hit->position_world_m);
      slope.col(k).setZero();
      if (place) slope.col(k) = (Vector2d(place->x_px, place->y_px) - Vector2d(x_px, y_px)) / kStep[k];
    }
    error_px.push_back(std::sqrt((slope * covariance * slope.transpose()).trace()));
  }
  return error_px.empty() ? INFINITY : median_of(std::move(error_px));
}

/// Of a change of the camera, as one of its offset.
Square covariance_of_offset(const Camera& stated, const Change& by, const Square& covariance) {
  const CameraOffset there = offset_between(stated, changed(stated, by));
  Square slope;
  for (Index k = 0; k < kUnknowns; ++k)
    slope.col(k) = (offset_between(stated, changed(stated, by + kStep[k] * Change::Unit(k))) - there) / kStep[k];
  return slope * covariance * slope.transpose();
}

}  // namespace

Result<FoundCamera> find_camera(const RayScene& rays, const Camera& stated, const Picture& picture) {
  LUXRIG_CHECK(picture.width_px == stated.width_px && picture.height_px == stated.height_px,
               "a picture of {} × {} pixels by a camera of {} × {}", picture.width_px, picture.height_px,
               stated.width_px, stated.height_px);
  const std::vector<SceneEdge> edges = scene_edges(rays, stated);
  if (edges.size() < kLeastEdges)
    return refusal(fmt::format("the camera would see edges of the scene at {} places; it takes {} to find where it is",
                               edges.size(), kLeastEdges));
  const Gradient coarse(picture, 8), fine(picture, 1);
  Fit fit(coarse, fine, stated, edges);
  for (const double reach_px : kReach_px)
    if (!fit.step(reach_px))
      return refusal(
          fmt::format("the picture shows the scene's edges at {} places; it takes {} to find where the "
                      "camera is: light more of the room, or check the camera in the rig file",
                      fit.edges_seen(), kLeastEdges));
  FoundCamera found;
  found.camera = changed(stated, fit.by());
  found.edges = fit.edges_seen();
  std::vector<double> off_px = distances_px(fit.seen(fit.by(), true, kTestReach_px));
  found.off_px = off_px.empty() ? INFINITY : median_of(std::move(off_px));
  found.stated_off_px = shown_off_px(stated, found.camera, edges);
  found.standard_error_px = error_of_places_px(rays, found.camera, fit.covariance());
  found.covariance = covariance_of_offset(stated, fit.by(), fit.covariance());
  if (!(found.off_px <= kMostOff_px))
    return refusal(
        fmt::format("edges of the scene are seen {:.1f} px off wherever the camera is taken to be: it is "
                    "farther off than can be found, or the room is another than the scene",
                    found.off_px));
  if (!(found.standard_error_px <= kMostError_px))
    return refusal(
        fmt::format("the edges in the picture fix what the camera sees to {:.1f} px only: light more of the "
                    "room",
                    found.standard_error_px));
  const Change off = fit.by().cwiseQuotient(kPrior);
  if (off.cwiseAbs().maxCoeff() > kFarthest)
    return refusal("the camera would be far from where the rig file has it, or another lens: check it there");
  return found;
}

}  // namespace luxrig
