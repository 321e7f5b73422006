#pragma once
/// Heads that were turned by hand in a rig whose points have limits: the model holds for them only at Luxrig's own aims.
/// From the order on, until they are surely back and their light has been given free, their light is bounded for any aim
/// (GainEstimator::worst_of_any).

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/output/output_program.h"
#include "core/show/head_whereabouts.h"
#include "core/show/health_watch.h"

namespace luxrig {

class TurnedHeads {
 public:
  /// fixtures: the emitters of one head, the first of which turns it.
  void turn(const Rig& rig, Time now, const std::vector<std::size_t>& fixtures);
  /// Returns whether turned() or home_at() has changed. Call it every tick.
  bool step(Time now, const OutputProgram& program, const HealthWatch& health);
  /// Per fixture, 1 = its light is bounded for any aim; empty = none is.
  [[nodiscard]] const std::vector<std::uint8_t>& turned() const { return turned_; }
  /// Since when all of them are back; Time::max() while one is not.
  [[nodiscard]] Time home_at() const { return home_at_; }
  [[nodiscard]] bool away(Time now) const { return home_at_ > now; }

 private:
  struct Head {
    std::vector<std::size_t> fixtures;
    HeadWhereabouts where;
    std::optional<Time> home_since{};
  };
  std::vector<Head> heads_;
  std::vector<std::uint8_t> turned_;
  Time home_at_{};
};

}  // namespace luxrig
