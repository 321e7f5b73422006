#pragma once
/// What is sent to a head so that it truly turns to the wanted joints, once it is known how it turns. All else deals in
/// true joints: those of a head that hangs as Fixture::world_from_mount says and points its beam as frames.h says.
///
/// Sent the joints (p, t), coming from below (a = 1) or above (a = -1), a head turns to
///   p' = sₚ p − a sgn(sₚ) bₚ / 2,   t' = sₜ t − a sgn(sₜ) bₜ / 2
/// with the scales s, negative when it turns the other way, and the play b of its gears. Its beam leaves along
///   Rz(p') · Rx(t') · (x, y, −1) / |…|
/// in the frame of its mount; (x, y) is how it lies askew in its lamp, and y the zero of tilt too.

#include <optional>

#include "core/rig/frames.h"

namespace luxrig {

/// From which side each joint comes to where it is sent: 1 from below, its command grew; -1 from above. 0: between both.
struct Approach {
  int pan = 1, tilt = 1;
  bool operator==(const Approach&) const = default;
};

struct JointMap {
  double pan_scale = 1, tilt_scale = 1;  ///< true over sent; not 0
  double pan_play_rad = 0, tilt_play_rad = 0;
  double askew_x = 0, askew_y = 0;  ///< about [rad]
  JointRange sent{};                ///< of what may be sent
  bool operator==(const JointMap&) const;

  /// What to send for true joints; the zoom stays. Within `sent`. Straight down is out of reach of a beam that lies
  /// askew: the nearest then.
  [[nodiscard]] Joints sent_for(const Joints& wanted, const Approach& from) const;
  /// The inverse.
  [[nodiscard]] Joints reached_by(const Joints& sent, const Approach& from) const;
  /// True joints that are reached from both sides, at all tilts but next to straight down.
  [[nodiscard]] JointRange reach() const;
};

/// Sends a head to true joints, one after the other, and keeps in mind from which side it comes to them.
class JointSender {
 public:
  [[nodiscard]] Joints send(const JointMap& map, const Joints& wanted);
  /// Beside them, by more than the play: whence it comes from is known then. For a head of which nobody knows that, until
  /// it may have arrived.
  [[nodiscard]] Joints send_beside(const JointMap& map, const Joints& wanted);

 private:
  Approach from_;
  Joints middle_;  ///< what would be sent without play; heads start at 0
};

}  // namespace luxrig
