#pragma once
/// Internal to direct light: emitters prepared for many receivers.

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

  /// Working memory, one per thread or call.
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

  /// Illuminance from each point luminaire [lx at level 1], reported as lit(emitter, lux > 0). Returns the shadow rays
  /// cast: one per distinct place that could send light. obstacles: null when nothing can be in between.
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

  /// Emitters with size and skies, by index.
  [[nodiscard]] std::span<const std::size_t> extended() const { return extended_; }

  /// False when no light of an emitter with size or a sky can reach the receiver: it is behind it, or the receiver is
  /// outside its cone.
  [[nodiscard]] bool may_light(std::size_t emitter, const Receiver& receiver) const;

 private:
  void gather_points(const Receiver& receiver, Scratch& scratch) const;

  struct Lamp {
    std::size_t emitter;
    Vec3 axis_world;  ///< -Z of the lamp
    double cos_half_cone;
    Mat3 lamp_from_world;
  };
  /// Lamps at one position, such as the candidate aims of one head: they share visibility.
  struct Group {
    Vec3 position_world_m;
    std::size_t begin, end;  ///< into lamps_
  };
  std::span<const Emitter> emitters_;
  std::vector<Lamp> lamps_;
  std::vector<Group> groups_;
  std::vector<std::size_t> extended_;
};

/// Provable state of the path between a receiver and an emitter with size or a sky.
enum class Way { clear, blocked, unknown };
[[nodiscard]] Way way_between(const RayScene& scene, const Receiver& receiver, const Emitter& emitter,
                              std::uint64_t& rays);

/// Sums over samples begin … end - 1.
struct DirectSum {
  /// Light sampled in separate strata: through openings, and the rest of a sky. All other light is one part.
  static constexpr std::size_t kParts = 2;
  struct Part {
    double lux = 0;               ///< light that arrives
    double unobstructed_lux = 0;  ///< light that would arrive without obstacles
    std::uint32_t samples = 0;    ///< strata
  };
  std::array<Part, kParts> parts{};
  std::uint64_t rays = 0;
};
/// way        clear = no ray is cast
/// openings   through which skies may be seen
[[nodiscard]] DirectSum sample_direct(const RayScene& scene, const Receiver& receiver, const Emitter& emitter, Way way,
                                      const SkyOpenings& openings, const SobolSequence& samples, std::uint32_t begin,
                                      std::uint32_t end, DirectSources::Scratch& scratch);

}  // namespace luxrig
