#include "core/geometry.h"

namespace luxrig {

// Instead of Eigen's FromTwoVectors: its singular value decomposition takes a compiler seconds in every file, and its
// rotation of nearly opposite vectors is orthonormal to 2e-3 only.
Mat3 shortest_rotation(const Vec3& from, const Vec3& to) {
  // The lengths of sum and difference give half the angle without cancellation. The shorter of the two is at right
  // angles to the longer, but for rounding.
  const Vec3 difference = to - from;
  Vec3 sum = from + to;
  Eigen::Quaterniond turn;
  if (from.dot(to) > 0) {
    turn.w() = sum.norm();
    turn.vec() = sum.cross(difference) / turn.w();
  } else {
    const double length = difference.norm();
    const Vec3 along = difference / length;
    sum -= sum.dot(along) * along;
    turn.w() = sum.norm();
    turn.vec() = length * (turn.w() < 1e-15 ? along.unitOrthogonal() : Vec3(sum.cross(along) / turn.w()));
  }
  return turn.normalized().toRotationMatrix();
}

}  // namespace luxrig
