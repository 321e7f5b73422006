#pragma once
/// Emitters prepared for many queries: direct light at a point, and first landing places of traced light.
///
/// Lamps at one position, such as the candidate aims of one head, share visibility and form one Place. Each luminaire
/// with size and each sky is its own Place. Places form groups, from which light is traced: one group per place as long
/// as there are few.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/photometry/shapes/shape_sampling.h"
#include "core/transport/direct/lamp_cells.h"
#include "core/transport/evaluator.h"
#include "core/transport/sky/sky_openings.h"

namespace luxrig {

/// A place of light, or a point or direction of it, chosen from a surface point (next-event estimation).
struct EmitterChoice {
  std::size_t place = 0;
  Vec3 direction_world = Vec3::UnitZ();  ///< unit, towards the light
  Vec3 target_world_m = Vec3::Zero();    ///< where a shadow ray ends
  double density = 0;     ///< probability of the place, times the density per sr of the direction if it has a choice
  double in_place = 1;    ///< that density without the probability of the place; 1 for a point
  double factor = 0;      ///< lux = intensity [cd] (of a sky: luminance [cd/m²]) times this, per 1 / density
  double hit_factor = 0;  ///< density of light-traced first hits of the group = direction density times this
};

/// A ray of light as it leaves a lamp.
struct EmitterRay {
  std::size_t emitter = 0;
  Vec3 from_world_m = Vec3::Zero();
  Vec3 direction_world = Vec3::UnitZ();
  double flux_lm = 0;   ///< of this sample; the mean over samples is the flux of all lamps of the group; 0 = none
  double density = 0;   ///< probability of the lamp in its group, times the density per sr of the direction
  double per_area = 0;  ///< 1 / projected area [1/m²] for lamps with size; 0 for a point
};

/// Keeps pointers into the emitters' distributions and to the openings: they must outlive it.
class EmitterSampler {
 public:
  /// levels    weights for choosing lamps. Empty = all 1. Lamps at 0 are chosen seldom, but not never.
  /// bounds    of all geometry: a sky's light enters through the sphere around it
  /// openings  where skies shine into rooms; null or empty = unknown
  explicit EmitterSampler(std::span<const Emitter> emitters, std::span<const double> levels = {},
                          const Eigen::AlignedBox3d& bounds_world_m = {}, const SkyOpenings* openings = nullptr);

  /// Direct illuminance [lx at level 1] at a surface point from each point luminaire that lights it,
  ///   E = I(ω) cosθ V / d²   (photometric distance law)
  ///
  /// scene         possible obstacles; null = none, and no ray is cast
  /// normal_world  unit, on the lit side
  /// lit           called as lit(emitter index, lux > 0), once per contributing emitter
  /// returns       shadow rays cast: one per distinct lamp position that could send light; none for lamps behind the
  ///               surface, with a cone that misses the point, or without intensity towards it
  template <class Lit>
  std::uint64_t light(const RayScene* scene, const Vec3& position_world_m, const Vec3& normal_world, Lit&& lit) const {
    std::uint64_t rays = 0;
    for (const Site& place : places_) {
      if (place.kind != Kind::point) continue;
      const Vec3 towards_m = place.position_world_m - position_world_m;
      const double height_m = normal_world.dot(towards_m);
      if (!(height_m > 0)) continue;
      const double distance_squared_m2 = towards_m.squaredNorm();
      const double per_distance = 1 / std::sqrt(distance_squared_m2);
      const Vec3 direction_world = towards_m * per_distance;
      const double lux_per_candela = height_m * per_distance / distance_squared_m2;
      if (!std::isfinite(lux_per_candela)) continue;
      bool sees = scene == nullptr;
      double through = 1;
      for (std::size_t i = place.begin; i < place.end; ++i) {
        const Lamp& lamp = lamps_[i];
        if (-lamp.axis_world.dot(direction_world) < lamp.cos_half_cone) continue;
        const double lux = lux_per_candela * lamp.intensity->intensity_cd(-(lamp.lamp_from_world * direction_world));
        if (!(lux > 0)) continue;
        if (!sees) {
          ++rays;
          if (scene->occluded(position_world_m, normal_world, place.position_world_m)) break;
          sees = true;
          if (scene->has_panes()) through = scene->transmittance(position_world_m, place.position_world_m);
        }
        lit(lamp.emitter, through * lux);
      }
    }
    return rays;
  }

  /// Weights of a cell's places for one surface point, in place order, and the openings it sees; reused between calls.
  struct Weights {
    const LampCells::Cell* cell = nullptr;
    std::vector<double> places;
    SkyOpenings::View view;
  };

  /// Approximate unshadowed lux (times level) of each place; above 0 for every place that could give any. With many
  /// places, only those that matter in the cell are weighed here, the others as in lamp_cells.h. Returns the sum.
  double weigh(const Vec3& position_world_m, const Vec3& normal_world, Weights& weights) const;

  /// Chooses one of the weighed places by `select` in [0, 1), and a direction by u and v if it has size. density 0 =
  /// none.
  [[nodiscard]] EmitterChoice choose(const Vec3& position_world_m, const Vec3& normal_world, const Weights& weights,
                                     double sum, double select, double u, double v) const;

  /// The same for a given place of luminaires that was drawn with this probability.
  [[nodiscard]] EmitterChoice ask_place(std::size_t place, double probability, const Vec3& position_world_m,
                                        const Vec3& normal_world, double u, double v) const;

  /// The same for a place with size, in a direction drawn by other means; density 0 = the direction misses it.
  [[nodiscard]] EmitterChoice place_towards(std::size_t place, const Vec3& position_world_m, const Vec3& normal_world,
                                            const Vec3& direction_world) const;

  /// Unshadowed light of each lamp of the chosen place, as lit(emitter, lux / choice.density, density with which emit()
  /// of its group makes a first hit here, in the unit of choice.density).
  template <class Lit>
  void light(const EmitterChoice& choice, Lit&& lit) const {
    const Site& place = places_[choice.place];
    const double per_density = choice.factor / choice.density;
    for (std::size_t i = place.begin; i < place.end; ++i) {
      const Lamp& lamp = lamps_[i];
      if (place.kind == Kind::sky) {
        const double lux = per_density * lamp.sky->luminance_cd_m2(choice.direction_world);
        if (lux > 0)
          lit(lamp.emitter, lux, lamp.share * lamp.sky->density_per_sr(choice.direction_world) * choice.hit_factor);
        continue;
      }
      if (-lamp.axis_world.dot(choice.direction_world) < lamp.cos_half_cone) continue;
      const Vec3 leaving_lamp = -(lamp.lamp_from_world * choice.direction_world);
      const double lux = per_density * lamp.intensity->intensity_cd(leaving_lamp);
      if (lux > 0)
        lit(lamp.emitter, lux, lamp.share * lamp.intensity->density_per_sr(leaving_lamp) * choice.hit_factor);
    }
  }

  /// Light of luminaires with size and of skies in a direction above the horizon of a surface point, as lit(
  ///   emitter,
  ///   luminance [cd/m²] at level 1,
  ///   density per sr with which choose() draws it,
  ///   density of ask_place() (0 for a sky),
  ///   density with which emit() of its group makes a first hit here, in the same unit,
  ///   position of the light).
  /// Weights and their sum as from weigh() there.
  /// free_m   distance without obstacles; infinite = skies are visible
  template <class Lit>
  void each_towards(const Vec3& position_world_m, const Vec3& normal_world, const Vec3& direction_world, double free_m,
                    const Weights& weights, double sum, Lit&& lit) const {
    for (const std::size_t p : shapes_) {
      const Site& place = places_[p];
      const Vec3 towards_m = place.position_world_m - position_world_m;
      if (towards_m.cross(direction_world).squaredNorm() > place.radius_m * place.radius_m) continue;
      const double in_place = density_in_place(p, position_world_m, direction_world),
                   asked = place_probability(p, weights, sum) * in_place;
      if (!(asked > 0)) continue;
      const Vec3 leaving = -(place.world_from_lamp.transpose() * direction_world);
      const double area_m2 = projected_area_m2(place.shape, leaving);
      const double way_m = distance_towards_m(place.shape, at_lamp_m(place, position_world_m), -leaving);
      if (!(area_m2 > 0) || !(way_m <= free_m)) continue;
      const Lamp& lamp = lamps_[place.begin];
      const double luminance_cd_m2 = lamp.intensity->intensity_cd(leaving) / area_m2;
      if (luminance_cd_m2 > 0)
        lit(lamp.emitter, luminance_cd_m2, asked, in_place,
            lamp.share * lamp.intensity->density_per_sr(leaving) * normal_world.dot(direction_world) / area_m2,
            Vec3(position_world_m + way_m * direction_world));
    }
    if (std::isfinite(free_m)) return;
    for (std::size_t p = places_.size(); p > 0 && places_[p - 1].kind == Kind::sky; --p) {
      const Lamp& lamp = lamps_[places_[p - 1].begin];
      const double luminance_cd_m2 = lamp.sky->luminance_cd_m2(direction_world);
      if (!(luminance_cd_m2 > 0)) continue;
      lit(lamp.emitter, luminance_cd_m2, choice_density(lamp.emitter, position_world_m, direction_world, weights, sum),
          0.0,
          lamp.share * lamp.sky->density_per_sr(direction_world) * normal_world.dot(direction_world) *
              line_density_per_m2(direction_world, position_world_m),
          beyond_world_m(position_world_m, direction_world));
    }
  }
  /// A point outside all geometry.
  [[nodiscard]] Vec3 beyond_world_m(const Vec3& position_world_m, const Vec3& direction_world) const;
  [[nodiscard]] bool is_sky(std::size_t emitter) const { return places_[place_of_emitter_[emitter]].kind == Kind::sky; }
  [[nodiscard]] bool any_sky() const { return !places_.empty() && places_.back().kind == Kind::sky; }
  /// Whether a path can meet it by chance.
  [[nodiscard]] bool has_size(std::size_t emitter) const { return place_has_size(place_of_emitter_[emitter]); }
  [[nodiscard]] bool place_has_size(std::size_t place) const { return places_[place].kind != Kind::point; }

  /// Light that leaves a group: a lamp by its share and a direction by (u, v), a place on it by (s, t).
  [[nodiscard]] EmitterRay emit(std::size_t group, double u, double v, double s, double t) const;

  static constexpr std::size_t kMaxGroups = 64;  ///< of luminaires; each sky is one more
  [[nodiscard]] std::size_t groups() const { return groups_.size(); }
  /// Approximate share of a group in all light, weighted by importance; above 0 unless it gives none. Shares sum to 1.
  [[nodiscard]] double group_share(std::size_t group) const { return groups_[group].share; }
  [[nodiscard]] std::size_t group_of(std::size_t emitter) const { return group_of_emitter_[emitter]; }

  /// Places of luminaires; those of skies come after them.
  [[nodiscard]] std::size_t luminous_places() const { return luminous_places_; }
  [[nodiscard]] std::size_t place_of(std::size_t emitter) const { return place_of_emitter_[emitter]; }
  [[nodiscard]] const Vec3& place_world_m(std::size_t place) const { return places_[place].position_world_m; }
  [[nodiscard]] double radius_m(std::size_t place) const { return places_[place].radius_m; }
  /// Intensity of its lamps in a direction, times importance [cd].
  [[nodiscard]] double importance_cd(std::size_t place, const Vec3& leaving_world) const;
  /// Share of a place of luminaires in all light, weighted by importance.
  [[nodiscard]] double place_share(std::size_t place) const;

  /// Density with which choose() draws an emitter's place and this direction from a surface point. Weights as from
  /// weigh() there.
  [[nodiscard]] double choice_density(std::size_t emitter, const Vec3& position_world_m, const Vec3& direction_world,
                                      const Weights& weights, double sum) const;
  /// Probability with which choose() chooses a place.
  [[nodiscard]] double place_probability(std::size_t place, const Weights& weights, double sum) const;
  /// Density with which ask_place() draws a direction; 1 for a point.
  [[nodiscard]] double density_in_place(std::size_t place, const Vec3& position_world_m,
                                        const Vec3& direction_world) const;

  [[nodiscard]] const Vec3& colour_rgb(std::size_t emitter) const { return colours_rgb_[emitter]; }
  /// Level of an emitter for choices: above 0 for all.
  [[nodiscard]] double importance(std::size_t emitter) const { return importances_[emitter]; }
  [[nodiscard]] std::size_t emitters() const { return colours_rgb_.size(); }
  /// Whether choose() uses u and v at all.
  [[nodiscard]] bool have_size() const { return have_size_; }
  [[nodiscard]] bool any() const { return !lamps_.empty(); }
  /// Openings through which skies shine into rooms; null if unknown.
  [[nodiscard]] const SkyOpenings* openings() const { return openings_; }

 private:
  enum class Kind { point, shape, sky };
  struct Lamp {
    std::size_t emitter;
    Vec3 axis_world;  ///< -Z of the lamp
    double cos_half_cone;
    Mat3 lamp_from_world;
    const IntensityDistribution* intensity;
    const SkyLuminance* sky;
    double importance;   ///< level, or a small value if that is 0
    double share;        ///< probability that emit() chooses it within its group
    double share_begin;  ///< sum of the previous shares in the group
  };
  struct Group {
    double share;
    std::size_t begin, end;  ///< into lamps_
  };
  struct Site {
    Kind kind;
    Vec3 position_world_m;
    std::size_t begin, end;  ///< into lamps_
    LuminousShape shape;
    double radius_m;  ///< around the position: encloses the shape
    Mat3 world_from_lamp;
    std::optional<Vec3> towards_sun_world;  ///< for a sky with light from one direction
  };
  void form_groups();
  void form_cells(const Eigen::AlignedBox3d& bounds_world_m);
  void share_out();
  /// Approximate share of a lamp's light that can meet the sphere around all geometry.
  [[nodiscard]] double inward_share(const Lamp& lamp, const Site& place) const;
  [[nodiscard]] static Vec3 at_lamp_m(const Site& place, const Vec3& position_world_m) {
    return place.world_from_lamp.transpose() * (position_world_m - place.position_world_m);
  }
  void fill_in(EmitterChoice& choice, const Vec3& position_world_m, double distance_m, double density_per_sr,
               const Vec3& normal_world, const Vec3& direction_world) const;
  void weigh_skies(const Vec3& position_world_m, const Vec3& normal_world, Weights& weights) const;
  [[nodiscard]] EmitterRay emit_sky(const Lamp& lamp, double u, double v, double s, double t) const;
  /// Density [1/sr] with which choose() draws a direction towards the sky.
  [[nodiscard]] double sky_density_per_sr(const Site& place, const Vec3& position_world_m, const Vec3& direction_world,
                                          const Weights& weights) const;
  /// Share of the directions towards the sky that are drawn from the whole sky.
  [[nodiscard]] double whole_sky_share(const Site& place, const Weights& weights) const {
    return openings_ && !place.towards_sun_world ? openings_->whole_sky_share(weights.view) : 1;
  }
  /// Density [1/m², across the line] with which emit() draws the line of light through a point.
  [[nodiscard]] double line_density_per_m2(const Vec3& towards_world, const Vec3& position_world_m) const;

  std::vector<Lamp> lamps_;
  std::vector<Site> places_;
  LampCells cells_;
  std::vector<Group> groups_;
  std::size_t luminous_places_ = 0;
  std::vector<std::size_t> shapes_;  ///< places of luminaires with size
  std::vector<std::size_t> place_of_emitter_, group_of_emitter_;
  std::vector<Vec3> colours_rgb_;
  std::vector<double> importances_;
  Vec3 centre_world_m_ = Vec3::Zero();  ///< of the sphere around all geometry
  double radius_m_ = 1;
  const SkyOpenings* openings_ = nullptr;  ///< null if there are none
  bool have_size_ = false;
};

/// Refuses invalid inputs, naming receiver or emitter and the figure: not finite, a normal or rotation that is not
/// unit, no distribution, levels of the wrong number or sign, and an emitter in a receiver.
[[nodiscard]] Result<void> check_evaluation(std::span<const Receiver> receivers, std::span<const Emitter> emitters,
                                            const EvaluateOptions& options);

/// Smallest distance [m] at which two points are distinct enough for 1/d²: coordinates of size M are rounded to M·2⁻⁵³,
/// which at this distance changes the illuminance by one part in a million.
[[nodiscard]] double smallest_distance_m(const Vec3& a_world_m, const Vec3& b_world_m);

}  // namespace luxrig
