#pragma once
/// Keep-out zones: whether a head's beam meets a box or a sphere, for one posture and for all that it may go through.
///
/// A beam is a cone about the lamp's axis from the pivot, as far as there is world: what stands between lamp and zone,
/// and what is reflected, does not count. Its half angle is that of the field (a tenth of the most intensity) at the
/// zoom it has, and the zone's margin. The test of one posture is exact. That of a range of postures is conservative:
/// it never misses one that meets the zone, and may report a range that passes it within kSweepSlack_rad, or one that
/// is too wide to be told in a millisecond.

#include <optional>
#include <span>
#include <vector>

#include "core/rig/rig.h"

namespace luxrig {

/// Within this of a zone's edge a range of postures may be taken to meet it.
inline constexpr double kSweepSlack_rad = rad_from_deg(1);

/// All joint angles between two postures, each joint by itself. least ≤ most.
struct JointBox {
  Joints least, most;
  [[nodiscard]] static JointBox at(const Joints& joints) { return {joints, joints}; }
  [[nodiscard]] JointBox joined(const JointBox& other) const;
  bool operator==(const JointBox&) const = default;
};

/// Largest angle from a luminaire's axis (-Z) in which it gives a tenth of its most intensity, 0…π: half the field
/// angle where it shines evenly round that axis. beam_rad: its zoom; 0: as stated. Of a measured distribution to 0.5°,
/// upwards.
[[nodiscard]] double field_half_angle_rad(const Luminaire& luminaire, double beam_rad);

/// Least angle [rad, 0…π] between a direction (unit) and those in which anything of the box, or the ball, is seen from
/// a place; 0 from within. Exact.
[[nodiscard]] double angle_to_box_rad(const Vec3& from_m, const Vec3& direction, const Eigen::AlignedBox3d& box_m);
[[nodiscard]] double angle_to_ball_rad(const Vec3& from_m, const Vec3& direction, const Vec3& centre_m,
                                       double radius_m);

class KeepOutZones {
 public:
  /// Keeps what it needs of the rig.
  explicit KeepOutZones(const Rig& rig);

  /// Fixtures that some zone holds for, rising.
  [[nodiscard]] std::span<const std::size_t> heads() const { return heads_; }
  [[nodiscard]] const std::string& name(std::size_t zone) const { return zones_[zone].name; }

  /// The first zone that the fixture's beam meets when it looks so; none for one that no zone holds for.
  [[nodiscard]] std::optional<std::size_t> met(std::size_t fixture, const Joints& joints) const;
  /// The first that it may meet while its joints are anywhere in the box.
  [[nodiscard]] std::optional<std::size_t> may_meet(std::size_t fixture, const JointBox& box) const;
  /// The first that it may meet on straight joint lines from anywhere in the box.
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
  /// From the beam's axis to the zone's edge, less margin and beam.
  [[nodiscard]] static double room_rad(const KeepOut& zone, const Beam& beam, const Joints& at, double half_angle_rad);
  [[nodiscard]] static bool box_meets(const KeepOut& zone, const Beam& beam, const JointBox& box);
  [[nodiscard]] static bool line_meets(const KeepOut& zone, const Beam& beam, const JointBox& from, const Joints& to,
                                       double begin, double end, int depth);

  std::vector<KeepOut> zones_;
  std::vector<std::size_t> heads_;
  std::vector<Beam> beams_;  ///< of heads_
};

}  // namespace luxrig
