#include "core/transport/sky/opening_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/photometry/shapes/shape_sampling.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxOpenings = 24;
/// An opening is worth its cost if this many glimpses pass it and it is a small part of their sky.
constexpr std::size_t kMinThrough = 6;
constexpr double kMinGain = 1.0;  ///< mean of log(2π / solid angle)
/// Share of glimpses that may stay unexplained.
constexpr double kLeftOver = 0.01;
/// Margin beside a rectangle, as a share of its size, within which rays still belong to it; and margin added at the
/// end.
constexpr double kBeside = 0.1, kFitMargin = 0.02;
constexpr int kMaxGrowth = 32;
/// Planes seen edge-on are rejected.
constexpr double kMinSlope = 0.1;

/// A plane with axes: x is level.
struct OpeningPlane {
  Vec3 origin_world_m;
  Mat3 axes;

  static std::optional<OpeningPlane> of(const Vec3& origin_world_m, Vec3 normal, const Vec3& outwards) {
    if (!(normal.norm() > 0.5) || !normal.allFinite()) return std::nullopt;
    normal.normalize();
    if (normal.dot(outwards) < 0) normal = -normal;
    // A nearly level or upright plane is made exactly so.
    if (std::abs(normal.z()) > 0.9998) normal = Vec3(0, 0, normal.z() > 0 ? 1 : -1);
    if (std::abs(normal.z()) < 0.02) normal = Vec3(normal.x(), normal.y(), 0).normalized();
    OpeningPlane plane{origin_world_m, Mat3::Identity()};
    Vec3 x = Vec3::UnitZ().cross(normal);
    if (!(x.norm() > 1e-6)) x = Vec3::UnitX();
    x.normalize();
    Vec3 y = normal.cross(x);
    if (y.z() < 0) x = -x, y = -y;
    plane.axes << x, y, normal;
    return plane;
  }

  /// Where an outgoing ray meets the plane; empty if it does not.
  [[nodiscard]] std::optional<Eigen::Vector2d> met(const Vec3& from_world_m, const Vec3& direction_world) const {
    const Vec3 from_m = axes.transpose() * (from_world_m - origin_world_m), d = axes.transpose() * direction_world;
    if (!(from_m.z() < 0) || !(d.z() > kMinSlope)) return std::nullopt;
    return Eigen::Vector2d(from_m.head<2>() - from_m.z() / d.z() * d.head<2>());
  }
};

using Box2 = Eigen::AlignedBox2d;

Box2 widened(const Box2& box, double part) {
  const Eigen::Vector2d by = part * box.sizes();
  return {box.min() - by, box.max() + by};
}

class OpeningFit {
 public:
  OpeningFit(const std::vector<SkyGlimpse>& glimpses, const std::vector<OpeningRim>& rims)
      : glimpses_(glimpses), rims_(rims), left_(glimpses.size(), true), rim_of_(glimpses.size(), nullptr) {
    for (const OpeningRim& rim : rims) rim_of_[rim.glimpse] = &rim;
  }

  FoundOpenings run() {
    std::vector<Candidate> candidates;
    for (const OpeningRim& rim : rims_) propose(rim, candidates);
    std::vector<SkyOpening> openings;
    std::size_t left = glimpses_.size();
    while (openings.size() < kMaxOpenings &&
           static_cast<double>(left) > kLeftOver * static_cast<double>(glimpses_.size())) {
      Candidate* best = nullptr;
      for (Candidate& candidate : candidates) {
        rate(candidate);
        if (!best || candidate.gain > best->gain) best = &candidate;
      }
      if (!best || best->through < kMinThrough || best->gain < kMinGain * static_cast<double>(best->through)) break;
      openings.push_back(opening_of(*best));
      for (std::size_t i = 0; i < glimpses_.size(); ++i) {
        const SkyGlimpse& g = glimpses_[i];
        if (!left_[i] || !openings.back().passed_by(g.from_world_m, g.direction_world)) continue;
        left_[i] = false;
        --left;
      }
    }
    return {std::move(openings), (static_cast<double>(left) + 1) / static_cast<double>(glimpses_.size() + 2)};
  }

 private:
  struct Candidate {
    OpeningPlane plane;
    Box2 box;
    double gain = 0;
    std::size_t through = 0;
  };

  /// Candidate planes of the rim seen from one place: those of its stops, and one through all of them.
  void propose(const OpeningRim& rim, std::vector<Candidate>& candidates) const {
    if (rim.stops.size() < 3) return;
    const SkyGlimpse& glimpse = glimpses_[rim.glimpse];
    Vec3 middle_m = Vec3::Zero();
    for (const auto& stop : rim.stops) middle_m += stop.position_world_m / static_cast<double>(rim.stops.size());
    Mat3 scatter = Mat3::Zero();
    for (const auto& stop : rim.stops) {
      const Vec3 from_middle_m = stop.position_world_m - middle_m;
      scatter += from_middle_m * from_middle_m.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(scatter);
    if (axes.info() == Eigen::Success) add(rim, middle_m, axes.eigenvectors().col(0), candidates);
    for (const auto& stop : rim.stops) {
      if (std::abs(stop.normal_world.dot(glimpse.direction_world)) < kMinSlope) continue;
      add(rim, stop.position_world_m, stop.normal_world, candidates);
      // The outer edge of a thick wall, if its inner face does not end the view.
      for (const auto& other : rim.stops)
        if (std::abs(other.normal_world.dot(stop.normal_world)) < 0.1)
          add(rim, other.position_world_m, stop.normal_world, candidates);
    }
  }

  void add(const OpeningRim& rim, const Vec3& origin_world_m, const Vec3& normal,
           std::vector<Candidate>& candidates) const {
    const SkyGlimpse& glimpse = glimpses_[rim.glimpse];
    const auto plane = OpeningPlane::of(origin_world_m, normal, glimpse.direction_world);
    if (!plane) return;
    const auto at = plane->met(glimpse.from_world_m, glimpse.direction_world);
    if (!at) return;
    Candidate candidate{*plane, Box2(*at)};
    for (const Vec3& free : rim.free_world)
      if (const auto edge = plane->met(glimpse.from_world_m, free)) candidate.box.extend(*edge);
    for (const Candidate& known : candidates) {
      if (known.plane.axes.col(2).dot(plane->axes.col(2)) < 0.9999) continue;
      const double apart_m = plane->axes.col(2).dot(known.plane.origin_world_m - plane->origin_world_m);
      const double size_m = candidate.box.diagonal().norm();
      if (std::abs(apart_m) > 0.01 * size_m) continue;
      const Vec3 shift_m = known.plane.axes.transpose() * (plane->origin_world_m - known.plane.origin_world_m);
      if (known.box.contains(*at + shift_m.head<2>())) return;  // already proposed
    }
    grow(candidate);
    candidates.push_back(candidate);
  }

  /// Adds the rays that pass it or just miss it, and the rims around them, until it no longer grows.
  void grow(Candidate& candidate) const {
    for (int round = 0; round < kMaxGrowth; ++round) {
      const Box2 reach = widened(candidate.box, kBeside);
      Box2 grown = candidate.box;
      for (std::size_t i = 0; i < glimpses_.size(); ++i) {
        const SkyGlimpse& g = glimpses_[i];
        const auto at = candidate.plane.met(g.from_world_m, g.direction_world);
        if (!at || !reach.contains(*at)) continue;
        grown.extend(*at);
        if (!rim_of_[i]) continue;
        for (const Vec3& free : rim_of_[i]->free_world)
          if (const auto edge = candidate.plane.met(g.from_world_m, free); edge && reach.contains(*edge))
            grown.extend(*edge);
      }
      if (grown.isApprox(candidate.box)) return;
      candidate.box = grown;
    }
  }

  /// Gain in aim at the remaining glimpses over the whole sky: sum of the log ratio of densities.
  void rate(Candidate& candidate) const {
    candidate.gain = 0;
    candidate.through = 0;
    const Vec3 middle_m(candidate.box.center().x(), candidate.box.center().y(), 0);
    const LuminousShape shape{LuminousShape::Kind::rectangle,
                              {candidate.box.sizes().x(), candidate.box.sizes().y(), 0}};
    if (!(shape.size_m.head<2>().minCoeff() > 0)) return;
    for (std::size_t i = 0; i < glimpses_.size(); ++i) {
      if (!left_[i]) continue;
      const SkyGlimpse& g = glimpses_[i];
      const auto at = candidate.plane.met(g.from_world_m, g.direction_world);
      if (!at || !candidate.box.contains(*at)) continue;
      const Vec3 from_m =
          candidate.plane.axes.transpose() * (g.from_world_m - candidate.plane.origin_world_m) - middle_m;
      const double density = density_seen_from(shape, from_m, candidate.plane.axes.transpose() * g.direction_world);
      if (!(density > 0)) continue;
      ++candidate.through;
      candidate.gain += std::log(2 * kPi * density);
    }
  }

  SkyOpening opening_of(const Candidate& candidate) const {
    const Box2 box = widened(candidate.box, kFitMargin);
    SkyOpening opening;
    opening.world_from_opening = candidate.plane.axes;
    opening.centre_world_m =
        candidate.plane.origin_world_m + candidate.plane.axes * Vec3(box.center().x(), box.center().y(), 0);
    opening.half_x_m = 0.5 * box.sizes().x();
    opening.half_y_m = 0.5 * box.sizes().y();
    return opening;
  }

  const std::vector<SkyGlimpse>& glimpses_;
  const std::vector<OpeningRim>& rims_;
  std::vector<bool> left_;  ///< glimpses that no opening explains yet
  std::vector<const OpeningRim*> rim_of_;
};

}  // namespace

FoundOpenings fit_openings(const std::vector<SkyGlimpse>& glimpses, const std::vector<OpeningRim>& rims) {
  return OpeningFit(glimpses, rims).run();
}

}  // namespace luxrig
