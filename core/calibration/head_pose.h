#pragma once
/// How a pan-tilt head truly hangs and turns, as a small vector of parameters beside its rig file. Sent the joints (p,
/// t), coming from below (a = 1) or above (a = -1), it turns to
///   p' = sₚ p − a sgn(sₚ) bₚ / 2,   t' = sₜ t − a sgn(sₜ) bₜ / 2
/// with the scales s, negative when it turns the other way, and the play b of its gears. The beam leaves the mount's
/// pivot along
///   R · U · Rz(p') · Rx(t') · (x, y, −1) / |…|
/// R is the mount as found, U a half turn about X if the head hangs upside down. (x, y) is how the beam lies askew in
/// its lamp: y is the zero of tilt too. The zero of pan is the mount's turn about its own Z.

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "core/rig/joint_map.h"

namespace luxrig {

// Places of the parameters in the vector.
inline constexpr int kHeadOffset = 0;  ///< of the mount off its stated place, in world [m]
inline constexpr int kHeadTurn = 3;    ///< of the mount about its own place, in world, a rotation vector [rad]
inline constexpr int kHeadAskew = 6;   ///< x and y above, about [rad]
inline constexpr int kHeadPanScale = 8, kHeadTiltScale = 9;
inline constexpr int kHeadPanPlay = 10, kHeadTiltPlay = 11;  ///< [rad]
inline constexpr int kHeadParameters = 12;
using HeadVector = Eigen::Matrix<double, kHeadParameters, 1>;

struct HeadPose {
  Pose stated;  ///< world_from_mount of the rig file
  bool upside_down = false;
  HeadVector parameters = as_stated();

  [[nodiscard]] static HeadVector as_stated() {
    HeadVector stated = HeadVector::Zero();
    stated[kHeadPanScale] = stated[kHeadTiltScale] = 1;
    return stated;
  }
  /// Where the beam starts.
  [[nodiscard]] Vec3 pivot_world_m() const { return stated.translation_m + parameters.segment<3>(kHeadOffset); }
  /// As found, with the half turn of a head that hangs upside down.
  [[nodiscard]] Pose world_from_mount() const;
  /// Unit direction of the beam's axis in world.
  [[nodiscard]] Vec3 beam_world(const Joints& sent, const Approach& from) const;
  /// What to send so that the beam points along direction_world, which must not be zero. `range` is of what may be
  /// sent. Of several, the nearest to `near`. nullopt if out of reach.
  [[nodiscard]] std::optional<Joints> joints_towards(const Vec3& direction_world, const Approach& from,
                                                     const JointRange& range, const Joints& near) const;
};

/// R(v) a for a rotation vector v (Rodrigues), also for small ones and for derivatives there.
template <class T>
Eigen::Matrix<T, 3, 1> rotated(const Eigen::Matrix<T, 3, 1>& v, const Eigen::Matrix<T, 3, 1>& a) {
  using std::cos, std::sin, std::sqrt;
  const T square = v.squaredNorm();
  if (!(square > T(1e-12))) return a + v.cross(a);
  const T angle = sqrt(square);
  const Eigen::Matrix<T, 3, 1> axis = v / angle, across = axis.cross(a);
  return a + sin(angle) * across + (T(1) - cos(angle)) * axis.cross(across);
}

/// HeadPose::beam_world for numbers that carry derivatives. mount: of the rig file, after the half turn.
template <class T>
Eigen::Matrix<T, 3, 1> head_beam(const Mat3& mount, const T* parameters, const Joints& sent, const Approach& from) {
  using std::cos, std::sin;
  const auto turned = [&](double sent_rad, int side, const T& scale, const T& play) {
    return scale * T(sent_rad) - (scale < T(0) ? T(-0.5 * side) : T(0.5 * side)) * play;
  };
  const T pan = turned(sent.pan_rad, from.pan, parameters[kHeadPanScale], parameters[kHeadPanPlay]);
  const T tilt = turned(sent.tilt_rad, from.tilt, parameters[kHeadTiltScale], parameters[kHeadTiltPlay]);
  const T x = parameters[kHeadAskew], y0 = parameters[kHeadAskew + 1];
  const T y = cos(tilt) * y0 + sin(tilt), z = sin(tilt) * y0 - cos(tilt);
  Eigen::Matrix<T, 3, 1> in_mount(cos(pan) * x - sin(pan) * y, sin(pan) * x + cos(pan) * y, z);
  in_mount.normalize();
  const Eigen::Matrix<T, 3, 1> turn(parameters[kHeadTurn], parameters[kHeadTurn + 1], parameters[kHeadTurn + 2]);
  return rotated<T>(turn, mount.cast<T>() * in_mount);
}

}  // namespace luxrig
