#pragma once
/// Fixtures whose lamp or axes do not answer, while the rest goes on: held at their last level, then sent to their safe
/// level.

#include <optional>
#include <vector>

#include "core/show/health_watch.h"

namespace luxrig {

/// A device is back only after this long without a fault; drivers report several times within it.
inline constexpr Duration kHealthyFor = std::chrono::milliseconds(500);

struct LostFixture {
  Time since{};
  double level = 0;      ///< it is held at this
  double most = 0;       ///< highest that it may have taken last
  bool lamp = true;      ///< false: only its motion is lost
  bool to_safe = false;  ///< held for long enough
  std::optional<Time> well_since{};
};

class LostFixtures {
 public:
  explicit LostFixtures(std::size_t fixtures) : lost_(fixtures), taken_level_(fixtures, 0.0) {}

  /// Levels of fixtures when the show learns of a loss.
  struct Levels {
    std::vector<double> present, before;  ///< before: as long ago as a loss can go unnoticed
  };
  /// Looks for losses. Returns whether anything changed.
  /// apart    per fixture, 1: its loss is tracked by itself; the others go to their safe look with the whole rig
  /// levels   gives the levels; called only for a new loss
  /// hold     from the loss until it is sent to its safe level
  template <class GetLevels>
  bool step(Time now, const HealthWatch& health, const std::vector<std::uint8_t>& apart, const GetLevels& levels,
            Duration hold) {
    bool changed = false;
    std::optional<Levels> known;
    for (std::size_t f = 0; f < lost_.size(); ++f) {
      const bool lamp = health.lamp_lost(f), gone = apart[f] != 0 && (lamp || health.motion_lost(f));
      if (gone && !lost_[f]) {
        if (!known) known = levels();
        lose(f, now, *known, lamp);
        changed = true;
      } else if (go_on(f, now, gone, lamp, hold)) {
        changed = true;
      }
    }
    return changed;
  }
  void forget_all() { lost_.assign(lost_.size(), std::nullopt); }

  /// Remembers the levels of lamps whose devices answer.
  void remember_levels(const HealthWatch& health, const std::vector<double>& level);
  /// Per fixture: last level that its device took, as far as known.
  [[nodiscard]] const std::vector<double>& taken_level() const { return taken_level_; }

  [[nodiscard]] const std::optional<LostFixture>& operator[](std::size_t fixture) const { return lost_[fixture]; }
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] bool any() const { return count() > 0; }
  /// Puts in the levels sent to lost fixtures: held at first, then their safe level unless they were darker. They may
  /// take it at any instant, so limits count on the level before.
  void put_in(std::vector<double>& levels, const std::vector<double>& safe_levels) const;

 private:
  void lose(std::size_t fixture, Time now, const Levels& levels, bool lamp);
  bool go_on(std::size_t fixture, Time now, bool gone, bool lamp, Duration hold);

  std::vector<std::optional<LostFixture>> lost_;
  std::vector<double> taken_level_;
};

}  // namespace luxrig
