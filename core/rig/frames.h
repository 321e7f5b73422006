#pragma once
/// Frames of a fixture, and how a pan-tilt head must turn to point at something.
///
///   world    right-handed, +Z up
///   mount    the fixture's base as hung: origin in the pan-tilt pivot, X right, Y away, Z up; identity
///            rotation for a head that hangs straight (GDTF: the beam leaves along -Z at pan = tilt = 0)
///   lamp     photometric frame (core/photometry/intensity.h): -Z along the beam
///
///   world_from_lamp.rotation = world_from_mount · Rz(pan) · Rx(tilt) · Rz(roll)
///
/// Pan is positive counter-clockwise seen from above. Tilt is positive from straight down towards +Y of the panned
/// base. In frame mount the beam is d = (-sin p sin t, cos p sin t, -cos t).

#include <cmath>
#include <optional>

#include "core/geometry.h"

namespace luxrig {

struct Joints {
  double pan_rad = 0;
  double tilt_rad = 0;
  double beam_rad = 0;  ///< beam angle set by the zoom; 0 = as the luminaire states
  bool operator==(const Joints&) const = default;
};

/// Whether both point the same way, within 1e-9 rad: angles written in degrees and read again still do.
[[nodiscard]] inline bool same_aim(const Joints& a, const Joints& b) {
  constexpr double kRounding_rad = 1e-9;
  return std::abs(a.pan_rad - b.pan_rad) < kRounding_rad && std::abs(a.tilt_rad - b.tilt_rad) < kRounding_rad &&
         std::abs(a.beam_rad - b.beam_rad) < kRounding_rad;
}

/// Range of a head's joints. It zooms only if beam_max_rad is above 0.
struct JointRange {
  double pan_min_rad = -1.5 * kPi, pan_max_rad = 1.5 * kPi;      // ±270°, the usual moving head
  double tilt_min_rad = -0.75 * kPi, tilt_max_rad = 0.75 * kPi;  // ±135°
  double beam_min_rad = 0, beam_max_rad = 0;
  [[nodiscard]] bool zooms() const { return beam_max_rad > 0; }
};

/// Pose of the lamp of a head at the given joint angles.
[[nodiscard]] Pose world_from_lamp(const Pose& world_from_mount, const Joints& joints, double roll_rad = 0);

/// A mount that hangs off its place: moved by offset_world_m, and turned in its own place about the axis turn_world_rad by
/// its length.
[[nodiscard]] Pose displaced(const Pose& world_from_mount, const Vec3& offset_world_m, const Vec3& turn_world_rad);

/// Joint angles within range that point the beam along direction_world, which must not be zero and need not be unit. Of
/// several solutions, the one whose larger joint movement from `from` is least. nullopt if out of reach. Straight down
/// keeps the present pan. The zoom stays.
[[nodiscard]] std::optional<Joints> pan_tilt_towards(const Pose& world_from_mount, const Vec3& direction_world,
                                                     const JointRange& range, const Joints& from);

}  // namespace luxrig
