#pragma once
/// Where a head can be now, from what it was told and how fast it turns: nobody hears from heads on DMX.
///
/// A head obeys within kHeadDelay_s (its ramps included), and each joint of a head on DMX then turns at its stated
/// speed or faster, by itself. So the least that a joint can be at climbs towards the least angle it was told within
/// the last kHeadDelay_s, at that speed, and drops to it at once; the most is the same turned round. A head with axes
/// turns both joints in step (head_move.h): until it must have arrived it is somewhere on straight lines from where it
/// could be when it was told.

#include <deque>
#include <optional>

#include "core/output/keep_out.h"

namespace luxrig {

/// From the command to a head's first movement, and for its ramps.
inline constexpr double kHeadDelay_s = 0.5;

class HeadWhereabouts {
 public:
  /// Anywhere within its travel.
  explicit HeadWhereabouts(const Fixture& fixture);

  /// What it is told at `now`: to look at any one posture of a box. obeys: commands reach it; while they do not, it may
  /// stay or go, and has its delay, and reset_s when it had no power, before it once they do again. Call it often: what
  /// is told between two calls must be within the box of one of them.
  void step(Time now, const JointBox& told, bool obeys);
  /// Somebody else turns it: anywhere.
  void lose(Time now);

  /// Every posture that it can have now, and on the way to what it was told last.
  [[nodiscard]] const JointBox& box() const { return box_; }
  /// Those are on straight lines from the box to here, and there.
  [[nodiscard]] const std::optional<Joints>& on_line_to() const { return line_to_; }

 private:
  struct Told {
    Time at{};  ///< when it was told last
    JointBox box;
  };
  void step_axes(Time now, const JointBox& told, bool obeys);

  JointBox travel_, box_;
  Joints speed_;  ///< rad/s of each joint
  std::optional<AxesPatch> axes_;
  Duration reset_{};
  std::deque<Told> told_;  ///< the last kHeadDelay_s of it, oldest first
  std::optional<Joints> line_to_;
  std::optional<Time> obeys_since_;
  Time last_{}, arrives_{};
  bool lost_ = true;  ///< it may have had no power
};

}  // namespace luxrig
