#pragma once
/// Light that reaches a surface after reflection: paths that start there, joined with light traced from the lamps.
///
/// With L the radiance that arrives, E = ∫ L cosθ dω, and every surface sends on L = ∫ f L' cosθ' dω'. A path follows
/// that recursion from the receiver. At each vertex y the light of the next surface z comes in two ways:
///   a  the path goes on to z by chance and there asks a lamp for its direct light (next-event estimation);
///   b  y is joined with a first hit z of light that was traced from the lamps;
///   c  the path goes on from a glossy z by its gloss, and meets a luminaire with size, or nothing and sees the sky;
///   d  y is joined with a place z of a smooth plane, drawn about where that shows a lamp (mirror_images.h).
/// All densities at z are known, so they share the work by the balance heuristic (E. Veach, L. Guibas 1995): b finds
/// the bright patches that lamps make on what is near them, a the light of wide and far surfaces and corners, c what
/// mirrors sky and wide luminaires, d the highlights of lamps. Hits are
/// shared by all receivers (as the light vertex cache of T. Davidovič et al. 2014, with subpaths of one hit). A plan
/// says how many hits of which lamps: those that matter at the receiver.
/// Unbiased, whatever the roulettes.

#include "core/transport/paths/hit_pool.h"
#include "core/transport/paths/mirror_images.h"
#include "core/transport/paths/tail_ends.h"
#include "core/transport/paths/tail_records.h"

namespace luxrig {

/// Memory of one worker, reused from path to path.
struct PathScratch {
  struct Lit {
    std::size_t emitter;
    Vec3 rgb;  ///< lux at level 1 by primary, MIS weight included
  };
  Lamps::Weights weights;  ///< of the lamps at the vertex that was reached last
  double weights_sum = 0;
  Lamps::Weights image_weights;  ///< of the lamps where an image of one was drawn
  SkyOpenings::Outside outside;
  std::vector<Lit> lit;
  std::vector<double> beside;  ///< sums of a path that checks a record
  double first_leg_m = 0;      ///< of the last path; infinite when it met nothing
};

/// Records that a path may end in, at its second vertex or where it next finds one.
struct TailShare {
  const TailRecords* records = nullptr;  ///< of three channels; null: paths end by themselves
  bool link = false;                     ///< do not add what the record says, only tell which it is
  /// With link: the record that the last path ended in, and what its reflected lux counts at the path's start.
  std::optional<std::uint32_t> linked;
  Vec3 per_lux_rgb = Vec3::Zero();
  /// Where paths that end in records are kept instead of adding what these say (PathSampler::add_ends); null: added.
  TailEnds* ends = nullptr;
  /// With ends: go on all the same, to tell how far the record is off; what counts is the record, which scatters less.
  bool check = false;
  double taken_lx = 0;  ///< what was added from records, luminous at the levels, added up
};

/// What is added up: luminance only, or three primaries.
struct PathSums {
  std::span<double> values;  ///< channels × emitters: all emitters of a channel together
  std::size_t channels = 1;  ///< 1 or 3; add_ends() also takes none (empty values)

  [[nodiscard]] std::size_t emitters() const { return values.size() / channels; }
  void add(std::size_t emitter, const Vec3& rgb) const {
    if (channels == 1) {
      values[emitter] += 0.2126 * rgb.x() + 0.7152 * rgb.y() + 0.0722 * rgb.z();
    } else {
      for (std::size_t c = 0; c < 3; ++c) values[c * emitters() + emitter] += rgb[static_cast<Eigen::Index>(c)];
    }
  }
};

class PathSampler {
 public:
  /// No path is longer. Reflectances are at most 0.95 (core/scene/scene.h), so what is cut off is below
  /// 0.95^1000 / 0.05 < 1e-20 of the light.
  static constexpr std::uint32_t kLongestPath = 1000;

  /// A path whose throughput falls below this plays Russian roulette: it goes on with probability
  /// throughput / kRouletteBelow, at throughput kRouletteBelow.
  static constexpr double kRouletteBelow = 0.4;

  /// Share of the paths that leave a room by its openings, where something outside is seen: it is a bright part of what
  /// lights the room, and a small part of what a path would meet by chance.
  static constexpr double kOutsideShare = 0.2;

  PathSampler(const RayScene& scene, const Lamps& lamps, const std::vector<Bsdf>& bsdfs, const MirrorImages& images,
              std::span<const double> levels)
      : scene_(scene), lamps_(lamps), bsdfs_(bsdfs), images_(images), levels_(levels) {}

  struct Vertex {
    Vec3 position_world_m, normal_world;
    Vec3 out_world;                   ///< unit, where the path came from
    const Bsdf* bsdf = nullptr;       ///< null: the receiver, which weighs by the cosine alone
    Vec3 through_rgb = Vec3::Ones();  ///< lux at the receiver per radiance that leaves the vertex towards out_world
    /// What is seen of the outside, towards which some paths go on; null: nothing.
    const SkyOpenings::Outside* outside = nullptr;
    const ImageChoice* images = nullptr;           ///< of lamps, that are looked for from here; null: none
    std::uint32_t plane = MirrorImages::kNoPlane;  ///< that the vertex lies in, of those that show images
  };

  /// Vertex of a receiver: sums become illuminance.
  [[nodiscard]] static Vertex at(const Receiver& receiver) {
    return {receiver.position_world_m, receiver.normal_world, receiver.normal_world};
  }

  /// Joins a start with light hits: what is called b above, for as many paths as the stretches serve.
  ///
  /// cut       a connection worth less (under the levels) is made only now and then, and counts more then; 0: never
  /// squares   where given, sums of the squares of what one hit for each path would give, by group
  /// Returns the rays cast.
  std::uint64_t join_start(const Vertex& start, const HitPool& pool, const HitPlan& plan,
                           std::span<const HitStretch> stretches, double cut, std::uint64_t key, const PathSums& sums,
                           std::span<double> squares = {}) const;

  /// Adds one path: with join_start() an unbiased estimate of the reflected light that leaves `start` towards
  /// out_world, by emitter at level 1: the illuminance [lx] of a receiver, the luminance [cd/m²] of a surface.
  ///
  /// pool      hits traced from the same replicate's samples; plan as given to join_start()
  /// tails     where given, what comes after a vertex is taken from there when a record is near
  /// Returns the rays cast.
  std::uint64_t add_path(const Vertex& start, const SobolSequence& samples, std::uint32_t index, const HitPool& pool,
                         const HitPlan& plan, double cut, PathScratch& scratch, const PathSums& sums,
                         TailShare* tails = nullptr) const;

  /// What kept ends of paths add, and what checks found, luminous at the levels, added up.
  struct EndsSum {
    double taken_lx = 0;
    double checked_lx = 0;  ///< of the paths that were checked, by record
    double by_path_lx = 0;  ///< and by the path itself
    std::uint64_t rays = 0;
  };
  /// Looks up anew the ends for which there are more records by now, then adds what their records say.
  EndsSum add_ends(TailEnds& ends, const TailRecords& records, const PathSums& sums) const;

  /// Of the emitters: what paths are chosen by.
  [[nodiscard]] std::span<const double> importances() const { return levels_; }

  /// Of lamps, for a start about which nothing more is known; null: there are none.
  [[nodiscard]] const ImageChoice* images_from_anywhere() const {
    return images_.any() ? &images_.from_anywhere() : nullptr;
  }

  /// Whether nothing stands between a place of a surface and a record on it; one ray.
  [[nodiscard]] bool sees_record(const Vec3& position_world_m, const Vec3& normal_world,
                                 const TailRecords::Place& record, double distance_m) const;

 private:
  /// Light of a hit by way of a vertex, if nothing stands in between.
  struct Join {
    std::size_t emitter = 0;
    Vec3 rgb = Vec3::Zero();
    double worth = 0;  ///< luminance at the levels; 0: none, or left out this time
  };
  /// hits      expected number of hits of the group, for each path
  [[nodiscard]] Join join(const Vertex& vertex, const LightHit& hit, double hits, double cut, double chance) const;
  std::uint64_t join_deeper(const Vertex& vertex, const HitPool& pool, const HitPlan& plan, double cut, double select,
                            double chance, const PathSums& sums) const;
  /// Random numbers for an image, the place on its plane, and that on a lamp with size.
  struct ImageDice {
    double select, u, v, by_gloss, lobe, s, t, chance;
  };
  /// One image of a lamp, joined with the vertex that sees it: d above. hits: for each path, by group, at that place.
  std::uint64_t join_image(const Vertex& vertex, std::span<const double> hits, double cut, const ImageDice& dice,
                           PathScratch& scratch, const PathSums& sums) const;
  /// before: the vertex that this one was reached from.
  std::uint64_t ask_lamps(const Vertex& before, const Vertex& vertex, double density_per_m2,
                          std::span<const double> hits, double cut, double select, double u, double v, double chance,
                          PathScratch& scratch, const PathSums& sums) const;
  /// What a path that goes on from a glossy vertex sees of skies and of luminaires with size: c above. Density and hits
  /// as for ask_lamps() there, from which the scratch has the weights. free_m: so far nothing stands in the way.
  void meet_lights(const Vertex& before, const Vertex& vertex, const Bsdf::Sample& next, double free_m,
                   double density_per_m2, std::span<const double> hits, const PathScratch& scratch,
                   const PathSums& sums) const;
  /// Density [1/sr] with which gloss alone finds a light of which it knows nothing; 0 for what it never meets.
  [[nodiscard]] double met_density_per_sr(std::size_t emitter, const Bsdf& bsdf, const Vec3& normal_world,
                                          const Vec3& out_world, const Vec3& towards_world) const {
    return bsdf.matt() || !lamps_.has_size(emitter) ? 0 : bsdf.density(normal_world, out_world, towards_world);
  }
  /// Density with which join_image() draws a direction towards a place of lamps, given that with which the place is
  /// asked for it: of what has size, half of them are drawn by the gloss, which may be much narrower.
  [[nodiscard]] double image_direction_density(std::size_t place_of_lamp, double in_place, const Bsdf& bsdf,
                                               const Vec3& normal_world, const Vec3& out_world,
                                               const Vec3& towards_world) const {
    if (!lamps_.place_has_size(place_of_lamp)) return in_place;
    return in_place > 0 ? 0.5 * (in_place + bsdf.density(normal_world, out_world, towards_world)) : 0;
  }
  /// Density [1/m²] with which join_image() of a vertex draws a place of a plane, with a place of lamps.
  [[nodiscard]] double image_density_per_m2(const Vertex& from, std::uint32_t plane, std::size_t place_of_lamp,
                                            const Vec3& position_world_m) const {
    if (plane == MirrorImages::kNoPlane || from.images == nullptr) return 0;
    return images_.density_per_m2(*from.images, from.position_world_m, plane, place_of_lamp, position_world_m);
  }
  /// Where a path goes on from a vertex; the weight is f cosθ / density of all ways to draw it.
  [[nodiscard]] Bsdf::Sample next_direction(const Vertex& vertex, double u, double v, double lobe) const;
  /// Density with which it goes there, given that of the surface's own way to draw it.
  [[nodiscard]] double next_density_per_sr(const Vertex& vertex, const Vec3& direction, double of_surface) const;
  /// Looks outside from a vertex, if there are openings.
  void look_outside(Vertex& vertex, SkyOpenings::Outside& outside) const;
  /// The record that speaks for a vertex, if one is near and nothing stands in between. `so_far`: did so when there
  /// were fewer.
  [[nodiscard]] std::optional<std::uint32_t> record_for(const Vec3& position_world_m, const Vec3& normal_world,
                                                        const TailRecords& records, std::uint64_t& rays,
                                                        std::optional<std::uint32_t> so_far = {}) const;
  /// Adds what the record says; returns its luminous lux at the levels.
  double add_record(const Vec3& per_lux_rgb, const TailRecords& records, std::size_t record,
                    const PathSums& sums) const;
  /// Luminous lux of sums at the levels.
  [[nodiscard]] double worth_of(const PathSums& sums) const;
  [[nodiscard]] double level(std::size_t emitter) const { return levels_[emitter]; }
  /// What panes of glass let through. No density knows of it, so it weighs all ways of finding a path alike.
  [[nodiscard]] double through_glass(const Vec3& from_world_m, const Vec3& to_world_m) const {
    return scene_.has_panes() ? scene_.transmittance(from_world_m, to_world_m) : 1;
  }

  const RayScene& scene_;
  const Lamps& lamps_;
  const std::vector<Bsdf>& bsdfs_;
  const MirrorImages& images_;
  std::span<const double> levels_;  ///< of importance: above 0 for all
};

}  // namespace luxrig
