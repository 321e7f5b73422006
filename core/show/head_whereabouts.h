#pragma once
/// Where a head can be now, from its orders and its speed: heads on DMX report nothing.
///
/// A head obeys within head_delay_s() (its ramps included). Each joint of a head on DMX then turns by itself, at its
/// stated speed or faster. So the lower bound of a joint climbs at that speed towards the least angle ordered within
/// the last head_delay_s(), and drops to it at once. The upper bound mirrors this. A head with axes turns both joints in
/// step (head_move.h): until it must have arrived, it is on a straight line from somewhere it could be when it got the
/// order.

#include <algorithm>
#include <deque>
#include <optional>

#include "core/output/keep_out.h"

namespace luxrig {

/// Delay from a command to a head's first movement, including its ramps.
inline constexpr double kHeadDelay_s = 0.5;
/// Of this head: longer if a calibration found so.
[[nodiscard]] inline double head_delay_s(const Fixture& head) { return std::max(kHeadDelay_s, head.settles_s); }

class HeadWhereabouts {
 public:
  /// Starts anywhere within its travel.
  explicit HeadWhereabouts(const Fixture& fixture);

  /// told: the posture ordered at `now`, any one of a box. obeys: commands reach the head. While they do not, it may
  /// stay or move. Once they do again, it has its delay first, and reset_s if it had no power. Call often: an order
  /// given between two calls must be within the box of one of them.
  void step(Time now, const JointBox& told, bool obeys);
  /// Luxrig no longer controls its aim: it may be anywhere.
  void lose(Time now);

  /// Every posture that it can have now, and on the way to its last order; see on_line_to().
  [[nodiscard]] const JointBox& box() const { return box_; }
  /// If set, postures on straight lines from box() to here are possible, too, including this one.
  [[nodiscard]] const std::optional<Joints>& on_line_to() const { return line_to_; }

 private:
  struct Told {
    Time at{};  ///< when it was last ordered
    JointBox box;
  };
  void step_axes(Time now, const JointBox& told, bool obeys);

  JointBox travel_, box_;
  Joints speed_;  ///< rad/s of each joint
  std::optional<AxesPatch> axes_;
  Duration reset_{};
  Duration obeys_within_{};
  std::deque<Told> told_;  ///< orders of that time, oldest first
  std::optional<Joints> line_to_;
  std::optional<Time> obeys_since_;
  Time last_{}, arrives_{};
  bool lost_ = true;  ///< it may have had no power
};

}  // namespace luxrig
