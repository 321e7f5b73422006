#pragma once
/// Internal to direct light: emitters made ready for one receiver after another.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/transport/evaluator.h"
#include "core/transport/sky/sky_openings.h"
#include "core/transport/sobol.h"

namespace luxrig {

/// Keeps a view of the emitters, which must outlive it.
class DirectSources {
 public:
  explicit DirectSources(std::span<const Emitter> emitters);

  /// Room to work in, one per thread or call.
  struct Scratch {
    struct Lit {
      std::size_t emitter, target;
      double lux;
    };
    std::vector<Lit> lit;
    std::vector<Vec3> targets_world_m;
    std::vector<double> values;
    std::vector<std::uint8_t> occluded;
    std::vector<std::uint8_t> parts;
    SkyOpenings::View view;
  };

  /// Illuminance from each point luminaire [lx at level 1], called as lit(emitter, lux > 0). Returns the shadow rays
  /// cast: one per distinct place from which something could come. obstacles: null when nothing can stand between.
  template <class Lit>
  std::uint64_t add_points(const RayScene* obstacles, const Receiver& receiver, Scratch& scratch, Lit&& lit) const {
    gather_points(receiver, scratch);
    const std::size_t rays = obstacles ? scratch.targets_world_m.size() : 0;
    scratch.occluded.assign(scratch.targets_world_m.size(), 0);
    if (rays > 0)
      obstacles->occluded_many(receiver.position_world_m, receiver.normal_world, scratch.targets_world_m,
                               scratch.occluded);
    scratch.values.assign(scratch.targets_world_m.size(), 1);
    if (obstacles && obstacles->has_panes())
      for (std::size_t i = 0; i < scratch.values.size(); ++i)
        scratch.values[i] = obstacles->transmittance(receiver.position_world_m, scratch.targets_world_m[i]);
    for (const Scratch::Lit& one : scratch.lit)
      if (!scratch.occluded[one.target]) lit(one.emitter, scratch.values[one.target] * one.lux);
    return rays;
  }

  /// Emitters with size or a sky, by index.
  [[nodiscard]] std::span<const std::size_t> extended() const { return extended_; }

  /// False when no light of an emitter with size or a sky can reach the receiver: behind it, or outside its cone.
  [[nodiscard]] bool may_light(std::size_t emitter, const Receiver& receiver) const;

 private:
  void gather_points(const Receiver& receiver, Scratch& scratch) const;

  struct Lamp {
    std::size_t emitter;
    Vec3 axis_world;  ///< -Z of the lamp
    double cos_half_cone;
    Mat3 lamp_from_world;
  };
  /// Lamps in one place, such as the candidate aims of one head: they see the same.
  struct Group {
    Vec3 position_world_m;
    std::size_t begin, end;  ///< into lamps_
  };
  std::span<const Emitter> emitters_;
  std::vector<Lamp> lamps_;
  std::vector<Group> groups_;
  std::vector<std::size_t> extended_;
};

/// What can be proven about the way between a receiver and an emitter with size or a sky.
enum class Way { clear, blocked, unknown };
[[nodiscard]] Way way_between(const RayScene& scene, const Receiver& receiver, const Emitter& emitter,
                              std::uint64_t& rays);

/// Sums over samples begin … end - 1.
struct DirectSum {
  /// Light that is sampled in strata of its own: that which openings show, and the rest of a sky. All else is one part.
  static constexpr std::size_t kParts = 2;
  struct Part {
    double lux = 0;               ///< of what arrives
    double unobstructed_lux = 0;  ///< of what would arrive if nothing stood in the way
    std::uint32_t samples = 0;    ///< strata
  };
  std::array<Part, kParts> parts{};
  std::uint64_t rays = 0;
};
/// way        clear: no ray is cast
/// openings   through which skies may be seen
[[nodiscard]] DirectSum sample_direct(const RayScene& scene, const Receiver& receiver, const Emitter& emitter, Way way,
                                      const SkyOpenings& openings, const SobolSequence& samples, std::uint32_t begin,
                                      std::uint32_t end, DirectSources::Scratch& scratch);

}  // namespace luxrig
