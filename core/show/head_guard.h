#pragma once
/// Heads go dark before their beam can meet a keep-out zone, and are lit again when it no longer can.

#include <optional>
#include <vector>

#include "core/output/keep_out.h"
#include "core/output/output_program.h"
#include "core/show/head_whereabouts.h"
#include "core/show/health_watch.h"
#include "core/show/show_controller.h"

namespace luxrig {

class HeadGuard {
 public:
  explicit HeadGuard(const Rig& rig);

  /// The dims of a program that starts: dark, since no aim is known yet. step() keeps them in this order.
  [[nodiscard]] std::vector<HeadDim> first_dims() const;

  /// Covers what may happen until the next step: the aims wanted now, and those at the end of the running fade.
  void step(Time now, OutputProgram& program, const HealthWatch& health);

  /// Adds dark heads and their alarms to the status.
  /// shared   a desk shares control of the light
  void tell(ShowStatus& status, const Rig& rig, const OutputProgram& program, bool shared) const;

  [[nodiscard]] const KeepOutZones& zones() const { return zones_; }

 private:
  struct Head {
    std::size_t fixture = 0;
    HeadWhereabouts where;
    std::optional<Joints> told{};     ///< order at the last step
    std::optional<JointBox> swept{};  ///< postures that `zone` was computed for
    std::optional<Joints> swept_to{};
    std::optional<std::size_t> zone{};  ///< that its beam could meet now
  };
  /// The orders of a head at one step.
  struct Order {
    Joints wanted, at_last;  ///< aim now, and at the end of the running fade
    bool lit = false, obeys = false;
  };
  /// Returns whether it changed the dim.
  bool step(Time now, Head& head, HeadDim& dim, const Order& order) const;

  KeepOutZones zones_;
  std::vector<Head> heads_;
};

/// A head that should be lit is dimmed for a zone.
[[nodiscard]] bool any_dimmed_for_a_zone(const OutputProgram& program, Time now);

}  // namespace luxrig
