#pragma once
/// Openings through which a sky shines into rooms, and light drawn or traced through them.
///
/// A window is a small part of the sky as seen from a desk, and a small part of the area that the sky shines on. With
/// known openings, directions towards the sky are drawn over their solid angle (the rectangle of C. Ureña et al. 2013),
/// and light from the sky is traced through their area. These are like the portals that some renderers let their users
/// place, but they are found automatically (sky_opening_finder.h) and are only one of two strategies: the other is the
/// whole sky. Estimates divide by the density of both together (balance heuristic, E. Veach 1997), so light that misses
/// the openings still counts, only with more noise.

#include <optional>
#include <span>
#include <vector>

#include "core/photometry/sky/sky_luminance.h"

namespace luxrig {

/// A rectangle that contains an opening or lies in it: openings need not be rectangles.
struct SkyOpening {
  Vec3 centre_world_m = Vec3::Zero();
  Mat3 world_from_opening = Mat3::Identity();  ///< x level, y up along the slope (if any), z outwards
  double half_x_m = 0, half_y_m = 0;
  Eigen::AlignedBox3d seen_from_world_m;  ///< bounds of the surfaces that see the sky through it
  /// Of the view through it below and above the horizon, the shares that are surfaces outside, not sky or nothing.
  double surfaces_below = 0, surfaces_above = 0;

  [[nodiscard]] Vec3 outwards_world() const { return world_from_opening.col(2); }
  [[nodiscard]] double area_m2() const { return 4 * half_x_m * half_y_m; }
  /// A place in the frame of the opening.
  [[nodiscard]] Vec3 local_m(const Vec3& position_world_m) const {
    return world_from_opening.transpose() * (position_world_m - centre_world_m);
  }
  /// Whether a straight line passes through it, or at most margin_m beside it.
  [[nodiscard]] bool passed_by(const Vec3& position_world_m, const Vec3& direction_world, double margin_m = 0) const;
};

class SkyOpenings {
 public:
  SkyOpenings() = default;
  /// missed_share   approximate share of the sky's light that enters elsewhere
  SkyOpenings(std::vector<SkyOpening> openings, double missed_share);

  [[nodiscard]] bool empty() const { return openings_.empty(); }
  [[nodiscard]] std::span<const SkyOpening> openings() const { return openings_; }
  [[nodiscard]] double missed_share() const { return missed_share_; }

  /// The openings as seen from a surface point; reused between points.
  struct View {
    bool within = false;  ///< whether the point is where the sky is seen through openings
    double sum = 0;       ///< of the weights: approximate ∫ cosθ dω [sr] over the openings without obstacles
    std::vector<double> weights;
  };
  /// The part of an opening below the point's horizon, where no sky shines, is excluded.
  void view(const Vec3& position_world_m, const Vec3& normal_world, View& view) const;

  /// Reflecting surfaces outside the openings, as seen from a surface point.
  struct Outside {
    double sum = 0;
    std::vector<double> weights;  ///< by opening: below the horizon, above it
  };
  void look_outside(const Vec3& position_world_m, const Vec3& normal_world, Outside& outside) const;
  /// A direction towards them; requires outside.sum > 0. The density is that of all openings together.
  [[nodiscard]] DirectionSample sample_outside(const Outside& outside, const Vec3& position_world_m, double u,
                                               double v) const;
  [[nodiscard]] double outside_density_per_sr(const Outside& outside, const Vec3& position_world_m,
                                              const Vec3& direction_world) const;

  /// Share of the directions towards the sky that are drawn over the whole sky, not through openings.
  [[nodiscard]] double whole_sky_share(const View& view) const {
    return view.within && view.sum > 0 ? inside_whole_share_ : 1;
  }
  /// Direction through an opening, chosen by `select`: even over the solid angle of its part above the horizon.
  /// Requires view.sum > 0.
  [[nodiscard]] DirectionSample sample(const View& view, const Vec3& position_world_m, double select, double u,
                                       double v) const;
  /// Density with which sample() draws a direction, over all openings together.
  [[nodiscard]] double density_per_sr(const View& view, const Vec3& position_world_m,
                                      const Vec3& direction_world) const;

  /// Approximate share of a point's sky that is visible: 1 outside all rooms, otherwise what the openings show of it.
  /// towards   direction of all light of the sky, if it is a single one
  [[nodiscard]] double lit_share(const View& view, const Vec3& position_world_m, const Vec3* towards_world) const;

  /// Light that falls along -towards_world: a line drawn evenly over the openings' area seen from that direction.
  /// false   no opening faces that way
  [[nodiscard]] bool sample_line(const Vec3& towards_world, double s, double t, Vec3& on_line_world_m) const;
  /// Density [1/m², across the line] with which sample_line() draws the line through a point.
  [[nodiscard]] double line_density_per_m2(const Vec3& towards_world, const Vec3& position_world_m) const;
  /// Share of traced light that is sent over the whole scene, not through openings.
  [[nodiscard]] double whole_scene_share(const Vec3& towards_world) const {
    return facing_area_m2(towards_world) > 0 ? kWholeSceneShare : 1;
  }

 private:
  static constexpr double kWholeSceneShare = 0.25;
  [[nodiscard]] double facing_area_m2(const Vec3& towards_world) const;

  std::vector<SkyOpening> openings_;
  double missed_share_ = 1;
  double inside_whole_share_ = 1;
};

/// The approximate single direction of a sky's light (a sun); otherwise empty.
[[nodiscard]] std::optional<Vec3> only_direction(const SkyLuminance& sky);

}  // namespace luxrig
