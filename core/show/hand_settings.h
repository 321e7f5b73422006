#pragma once
/// Levels and goals that are set by hand, and the plan's levels without them.

#include <optional>
#include <span>
#include <vector>

#include "core/plan/look.h"
#include "core/rig/rig.h"
#include "core/show/by_hand.h"

namespace luxrig {

class HandSettings {
 public:
  explicit HandSettings(const Rig& rig)
      : level_(rig.fixtures.size()), goal_(rig.points.size()), levels_without_(rig.fixtures.size(), 0.0) {}

  /// Asserted: each setting is of the rig and has no complaint.
  void set(const Rig& rig, std::span<const ByHand> wanted);
  /// Returns how many were set.
  std::size_t release(std::span<const std::size_t> fixtures, std::span<const std::size_t> points);

  struct Over {
    std::vector<std::size_t> fixtures, points;
    [[nodiscard]] bool empty() const { return fixtures.empty() && points.empty(); }
  };
  [[nodiscard]] Over over(Time now) const;

  /// A new plan ends settings that the last plan brought. Settings made in the running show stay. Returns whether any
  /// stay: the levels must then be solved around them.
  /// levels      of the plan
  /// max_level   per fixture
  bool take_plan(Time now, const std::vector<double>& levels, const Look& look, std::span<const double> max_level);
  /// The points of a rig that was read again; goals stay by name.
  void exchange_points(const std::vector<Point>& before, const std::vector<Point>& after);

  [[nodiscard]] const std::optional<ByHand>& level(std::size_t fixture) const { return level_[fixture]; }
  [[nodiscard]] const std::optional<ByHand>& goal(std::size_t point) const { return goal_[point]; }
  [[nodiscard]] std::vector<ByHand> all() const;

  /// The plan's levels as corrected before settings by hand; a release goes there.
  [[nodiscard]] const std::vector<double>& levels_without() const { return levels_without_; }
  void correct(const std::vector<double>& levels) { levels_without_ = levels; }

 private:
  std::vector<std::optional<ByHand>> level_;  ///< per fixture
  std::vector<std::optional<ByHand>> goal_;   ///< per point
  std::vector<double> levels_without_;        ///< per fixture
};

}  // namespace luxrig
