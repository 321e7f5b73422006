#pragma once
/// What goes out, as a pure function of time: the controller makes one, the output thread evaluates it
/// every cycle. Blackout and limits are applied here, last, so nothing that comes before can undo them.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/rig/rig.h"
#include "core/time.h"

namespace luxrig {

/// Share of a fade done, 0…1, at share `x` of its time (clamped): linear x, or s-curve 3x² − 2x³.
[[nodiscard]] double fade_share(FadeCurve curve, double x);

/// drive <-> level of a maker's nominal curve; both 0…1, strictly monotone, exact at 0 and 1.
[[nodiscard]] double level_from_drive(DimmerCurve curve, double drive);
[[nodiscard]] double drive_from_level(DimmerCurve curve, double level);

struct OutputProgram {
  std::uint64_t revision = 0;                ///< grows with each change
  std::vector<double> from_level, to_level;  ///< per fixture
  Time start{};
  Duration duration{};  ///< 0: at once
  FadeCurve curve = FadeCurve::s_curve;
  std::vector<double> max_level;  ///< per fixture, limits applied
  std::vector<PanTilt> joints;    ///< per fixture; where moving heads shall look
  bool blackout = false;          ///< all levels 0, at once; joints unchanged

  /// Conservation limits: rows = limited points; the most lux per level that the model allows there now
  /// (gain bounds, meter tolerance, standard errors included), and the limit itself.
  Eigen::MatrixXd worst_lux_per_level;
  Eigen::VectorXd max_lx;

  /// Levels at `now`, per fixture. Never above max_level; never with worst_lux_per_level · level above max_lx (the
  /// fixtures that light that point are then scaled down together). Allocates nothing.
  void levels_at(Time now, std::span<double> level) const;
  [[nodiscard]] bool done(Time now) const { return now >= start + duration; }
};

}  // namespace luxrig
