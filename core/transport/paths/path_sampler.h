#pragma once
/// Reflected light at a surface: paths that start there, joined with light traced from the lamps.
///
/// With arriving radiance L, E = ∫ L cosθ dω, and every surface sends on L = ∫ f L' cosθ' dω'. A path follows that
/// recursion from the receiver. At each vertex y the light of the next surface z comes in four ways:
///   a  the path continues to z by chance and there draws a lamp for its direct light (next-event estimation);
///   b  y is joined with a first hit z of light traced from the lamps;
///   c  the path continues from a glossy z by its gloss and meets a luminaire with size, or nothing and sees the sky;
///   d  y is joined with a place z of a smooth plane, drawn near the image of a lamp there (mirror_images.h).
/// All densities at z are known, so the balance heuristic weights the ways (E. Veach, L. Guibas 1995): b finds the
/// bright patches that lamps make nearby, a the light of wide and distant surfaces and corners, c mirrored skies and
/// wide luminaires, d the highlights of lamps. All receivers share the hits (as in the light vertex cache of T.
/// Davidovič et al. 2014, with subpaths of one hit). A plan sets the number of hits per group of lamps, by importance
/// for the receiver.
/// Unbiased for any Russian roulette.

#include "core/transport/paths/irradiance_records.h"
#include "core/transport/paths/light_vertex_pool.h"
#include "core/transport/paths/mirror_images.h"
#include "core/transport/paths/record_lookups.h"

namespace luxrig {

/// Working memory of one thread, reused between paths.
struct PathScratch {
  struct Lit {
    std::size_t emitter;
    Vec3 rgb;  ///< lux at level 1 by primary, MIS weight included
  };
  EmitterSampler::Weights weights;  ///< of the lamps at the last vertex
  double weights_sum = 0;
  EmitterSampler::Weights image_weights;  ///< of the lamps at the place where an image was drawn
  SkyOpenings::Outside outside;
  std::vector<Lit> lit;
  std::vector<double> beside;  ///< sums of a path that checks a record
  double first_leg_m = 0;      ///< of the last path; infinite if it met nothing
};

/// Records in which a path may end, at its second vertex or at the next one with a record nearby.
struct TailShare {
  const IrradianceRecords* records = nullptr;  ///< with three channels; null = paths end by themselves
  bool link = false;                     ///< do not add the record's value, only report the record
  /// With link: the record that the last path ended in, and the weight of its reflected lux at the path's start.
  std::optional<std::uint32_t> linked;
  Vec3 per_lux_rgb = Vec3::Zero();
  /// If set, path ends are stored here instead of adding the records' values (PathSampler::add_ends).
  RecordLookups* ends = nullptr;
  /// With ends: continue the path anyway, to measure the record's bias. The result uses the record, which scatters
  /// less.
  bool check = false;
  double taken_lx = 0;  ///< luminous sum at the levels of light added from records
};

/// The sums: luminance only, or three primaries.
struct PathSums {
  std::span<double> values;  ///< channels × emitters, channel by channel
  std::size_t channels = 1;  ///< 1 or 3; add_ends() also accepts none (empty values)

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
  /// Longest path. Reflectances are at most 0.95 (core/scene/scene.h), so the part cut off is below 0.95^1000 / 0.05 <
  /// 1e-20 of the light.
  static constexpr std::uint32_t kLongestPath = 1000;

  /// A path with a throughput below this plays Russian roulette: it continues with probability throughput /
  /// kRouletteBelow, at throughput kRouletteBelow.
  static constexpr double kRouletteBelow = 0.4;

  /// Share of the paths that leave a room by its openings where the outside is visible: the outside is a bright part of
  /// a room's light, but paths seldom meet it by chance.
  static constexpr double kOutsideShare = 0.2;

  PathSampler(const RayScene& scene, const EmitterSampler& lamps, const std::vector<Bsdf>& bsdfs,
              const MirrorImages& images, std::span<const double> levels)
      : scene_(scene), lamps_(lamps), bsdfs_(bsdfs), images_(images), levels_(levels) {}

  struct Vertex {
    Vec3 position_world_m, normal_world;
    Vec3 out_world;                   ///< unit, towards the previous vertex
    const Bsdf* bsdf = nullptr;       ///< null = the receiver, which weighs by the cosine only
    Vec3 through_rgb = Vec3::Ones();  ///< lux at the receiver per radiance that leaves the vertex towards out_world
    /// Visible part of the outside, which some paths are sent to; null = none.
    const SkyOpenings::Outside* outside = nullptr;
    const ImageChoice* images = nullptr;           ///< of lamps, searched for from here; null = none
    std::uint32_t plane = MirrorImages::kNoPlane;  ///< plane of the vertex, if it shows images
  };

  /// Vertex of a receiver: the sums are then illuminance.
  [[nodiscard]] static Vertex at(const Receiver& receiver) {
    return {receiver.position_world_m, receiver.normal_world, receiver.normal_world};
  }

  /// Joins a start with light vertices (b above), for as many paths as the stretches serve.
  ///
  /// cut       connections worth less (under the levels) are made only occasionally, with more weight; 0 = make all
  /// squares   if given: adds the squares of the result of one hit per path, by group
  /// Returns the rays cast.
  std::uint64_t join_start(const Vertex& start, const LightVertexPool& pool, const LightVertexPlan& plan,
                           std::span<const LightVertexRange> stretches, double cut, std::uint64_t key,
                           const PathSums& sums, std::span<double> squares = {}) const;

  /// Adds one path. Together with join_start() it is an unbiased estimate of the reflected light that leaves `start`
  /// towards out_world, by emitter at level 1: the illuminance [lx] of a receiver, or the luminance [cd/m²] of a
  /// surface.
  ///
  /// pool      hits traced from the same replicate's samples; plan as given to join_start()
  /// tails     if given, the rest of a path is taken from a nearby record
  /// Returns the rays cast.
  std::uint64_t add_path(const Vertex& start, const SobolSequence& samples, std::uint32_t index,
                         const LightVertexPool& pool, const LightVertexPlan& plan, double cut, PathScratch& scratch,
                         const PathSums& sums, TailShare* tails = nullptr) const;

  /// Contribution of stored path ends, and result of checks; luminous sums at the levels.
  struct EndsSum {
    double taken_lx = 0;
    double checked_lx = 0;  ///< of the checked paths, by record
    double by_path_lx = 0;  ///< and by the path itself
    std::uint64_t rays = 0;
  };
  /// Looks up again the ends for which new records have come, then adds their records' values.
  EndsSum add_ends(RecordLookups& ends, const IrradianceRecords& records, const PathSums& sums) const;

  /// Of the emitters: weights for choosing paths.
  [[nodiscard]] std::span<const double> importances() const { return levels_; }

  /// Images of lamps for a start without further knowledge; null = there are none.
  [[nodiscard]] const ImageChoice* images_from_anywhere() const {
    return images_.any() ? &images_.from_anywhere() : nullptr;
  }

  /// Whether the path between a place of a surface and a record on it is clear; one ray.
  [[nodiscard]] bool sees_record(const Vec3& position_world_m, const Vec3& normal_world,
                                 const IrradianceRecords::Vertex& record, double distance_m) const;

 private:
  /// Light of a hit through a vertex, if nothing is in between.
  struct Join {
    std::size_t emitter = 0;
    Vec3 rgb = Vec3::Zero();
    double worth = 0;  ///< luminance at the levels; 0 = none, or skipped this time
  };
  /// hits      expected hits of the group per path
  [[nodiscard]] Join join(const Vertex& vertex, const LightVertex& hit, double hits, double cut, double chance) const;
  std::uint64_t join_deeper(const Vertex& vertex, const LightVertexPool& pool, const LightVertexPlan& plan, double cut,
                            double select, double chance, const PathSums& sums) const;
  /// Random numbers for an image, a place on its plane, and a place on a lamp with size.
  struct ImageDice {
    double select, u, v, by_gloss, lobe, s, t, chance;
  };
  /// Joins one image of a lamp with the vertex that sees it (d above). hits: per path, by group, at that place.
  std::uint64_t join_image(const Vertex& vertex, std::span<const double> hits, double cut, const ImageDice& dice,
                           PathScratch& scratch, const PathSums& sums) const;
  /// before: the previous vertex.
  std::uint64_t ask_lamps(const Vertex& before, const Vertex& vertex, double density_per_m2,
                          std::span<const double> hits, double cut, double select, double u, double v, double chance,
                          PathScratch& scratch, const PathSums& sums) const;
  /// Adds skies and luminaires with size that a path from a glossy vertex meets (c above). Density and hits as for
  /// ask_lamps() at that vertex, which set the weights in scratch. free_m: distance without obstacles.
  void meet_lights(const Vertex& before, const Vertex& vertex, const Bsdf::Sample& next, double free_m,
                   double density_per_m2, std::span<const double> hits, const PathScratch& scratch,
                   const PathSums& sums) const;
  /// Density [1/sr] with which gloss alone finds a light, without knowing of it; 0 for lights it never meets.
  [[nodiscard]] double met_density_per_sr(std::size_t emitter, const Bsdf& bsdf, const Vec3& normal_world,
                                          const Vec3& out_world, const Vec3& towards_world) const {
    return bsdf.matt() || !lamps_.has_size(emitter) ? 0 : bsdf.density(normal_world, out_world, towards_world);
  }
  /// Density with which join_image() draws a direction towards a place of lamps, given the density in_place of drawing
  /// it there. For lamps with size half of the directions are drawn by the gloss, which may be much narrower.
  [[nodiscard]] double image_direction_density(std::size_t place_of_lamp, double in_place, const Bsdf& bsdf,
                                               const Vec3& normal_world, const Vec3& out_world,
                                               const Vec3& towards_world) const {
    if (!lamps_.place_has_size(place_of_lamp)) return in_place;
    return in_place > 0 ? 0.5 * (in_place + bsdf.density(normal_world, out_world, towards_world)) : 0;
  }
  /// Density [1/m²] with which join_image() of a vertex draws a place of a plane together with a place of lamps.
  [[nodiscard]] double image_density_per_m2(const Vertex& from, std::uint32_t plane, std::size_t place_of_lamp,
                                            const Vec3& position_world_m) const {
    if (plane == MirrorImages::kNoPlane || from.images == nullptr) return 0;
    return images_.density_per_m2(*from.images, from.position_world_m, plane, place_of_lamp, position_world_m);
  }
  /// Next direction of a path; the weight is f cosθ / density of all ways to draw it.
  [[nodiscard]] Bsdf::Sample next_direction(const Vertex& vertex, double u, double v, double lobe) const;
  /// Density of that direction, given the density of the surface's own sampling.
  [[nodiscard]] double next_density_per_sr(const Vertex& vertex, const Vec3& direction, double of_surface) const;
  /// Finds the visible outside from a vertex, if there are openings.
  void look_outside(Vertex& vertex, SkyOpenings::Outside& outside) const;
  /// The record for a vertex, if one is near and nothing is in between. `so_far`: the record found when there were
  /// fewer.
  [[nodiscard]] std::optional<std::uint32_t> record_for(const Vec3& position_world_m, const Vec3& normal_world,
                                                        const IrradianceRecords& records, std::uint64_t& rays,
                                                        std::optional<std::uint32_t> so_far = {}) const;
  /// Adds a record's value; returns its luminous lux at the levels.
  double add_record(const Vec3& per_lux_rgb, const IrradianceRecords& records, std::size_t record,
                    const PathSums& sums) const;
  /// Luminous lux of sums at the levels.
  [[nodiscard]] double worth_of(const PathSums& sums) const;
  [[nodiscard]] double level(std::size_t emitter) const { return levels_[emitter]; }
  /// Transmittance of glass panes. No density depends on it, so it weighs all ways of finding a path equally.
  [[nodiscard]] double through_glass(const Vec3& from_world_m, const Vec3& to_world_m) const {
    return scene_.has_panes() ? scene_.transmittance(from_world_m, to_world_m) : 1;
  }

  const RayScene& scene_;
  const EmitterSampler& lamps_;
  const std::vector<Bsdf>& bsdfs_;
  const MirrorImages& images_;
  std::span<const double> levels_;  ///< importances: above 0 for all
};

}  // namespace luxrig
