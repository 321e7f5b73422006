#pragma once
/// Keep-out zones: whether a head's beam meets a box or a sphere, for one posture or for a range of postures.
///
/// A beam is an unlimited cone about the lamp's axis from the pivot. Objects between lamp and zone are ignored, as is
/// reflected light. Its half angle is that of the field (a tenth of the peak intensity) at its present zoom, plus the
/// zone's margin. The test of one posture is exact. The test of a range is conservative: it never misses a posture that
/// meets the zone, but may report a range that passes it within kSweepSlack_rad, or one too wide to check in a
/// millisecond.

#include <optional>
#include <span>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

/// A range of postures this close to a zone's edge may be reported as meeting it.
inline constexpr double kSweepSlack_rad = rad_from_deg(1);

/// All joint angles between two postures, each joint independently. least ≤ most.
struct JointBox {
  Joints least, most;
  [[nodiscard]] static JointBox at(const Joints& joints) { return {joints, joints}; }
  [[nodiscard]] JointBox joined(const JointBox& other) const;
  bool operator==(const JointBox&) const = default;
};

/// Largest angle from a luminaire's axis (-Z) at which it gives a tenth of its peak intensity, 0…π. For a symmetric
/// beam, half the field angle. beam_rad: its zoom; 0 = as stated. A measured distribution is rounded up to 0.5°.
[[nodiscard]] double field_half_angle_rad(const Luminaire& luminaire, double beam_rad);

/// Smallest angle [rad, 0…π] between a unit direction and the directions in which the box or ball is seen from
/// `from_m`; 0 from inside. Exact.
[[nodiscard]] double angle_to_box_rad(const Vec3& from_m, const Vec3& direction, const Eigen::AlignedBox3d& box_m);
[[nodiscard]] double angle_to_ball_rad(const Vec3& from_m, const Vec3& direction, const Vec3& centre_m,
                                       double radius_m);

class KeepOutZones {
 public:
  /// Copies what it needs of the rig.
  explicit KeepOutZones(const Rig& rig);

  /// Fixtures that some zone applies to, rising.
  [[nodiscard]] std::span<const std::size_t> heads() const { return heads_; }
  [[nodiscard]] const std::string& name(std::size_t zone) const { return zones_[zone].name; }

  /// The first zone that the fixture's beam meets in this posture; none if no zone applies to it.
  [[nodiscard]] std::optional<std::size_t> met(std::size_t fixture, const Joints& joints) const;
  /// The first zone that it may meet with its joints anywhere in the box.
  [[nodiscard]] std::optional<std::size_t> may_meet(std::size_t fixture, const JointBox& box) const;
  /// The first zone that it may meet on straight joint lines from anywhere in the box.
  [[nodiscard]] std::optional<std::size_t> may_meet_on_line(std::size_t fixture, const JointBox& from,
                                                            const Joints& to) const;

 private:
  struct Beam {
    Pose world_from_mount;
    Luminaire luminaire;
    double half_angle_rad = 0;  ///< as stated
  };
  [[nodiscard]] const Beam* beam_of(std::size_t fixture) const;
  [[nodiscard]] static double half_angle_rad(const Beam& beam, double zoom_rad);
  /// Angle from the beam's axis to the zone's edge, minus margin and beam.
  [[nodiscard]] static double room_rad(const KeepOut& zone, const Beam& beam, const Joints& at, double half_angle_rad);
  [[nodiscard]] static bool box_meets(const KeepOut& zone, const Beam& beam, const JointBox& box);
  [[nodiscard]] static bool line_meets(const KeepOut& zone, const Beam& beam, const JointBox& from, const Joints& to,
                                       double begin, double end, int depth);

  std::vector<KeepOut> zones_;
  std::vector<std::size_t> heads_;
  std::vector<Beam> beams_;  ///< of heads_
};

}  // namespace luxrig
