#include "core/output/keep_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace luxrig {
namespace {

/// Most parts of a range of postures to examine. If they do not suffice, the beam counts as meeting the zone.
constexpr int kMaxParts = 1000;
constexpr int kMaxHalvings = 10;  ///< of a straight line
constexpr double kFieldShare = 0.1;
constexpr double kGammaStep_rad = rad_from_deg(0.5), kAzimuthStep_rad = rad_from_deg(5);

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Angle between a unit direction and the great-circle arc in which the line from a to b is seen from the origin.
double angle_to_edge_rad(const Vec3& direction, const Vec3& a, const Vec3& b) {
  const double ends = std::min(angle_between(direction, a), angle_between(direction, b));
  const Vec3 across = a.cross(b);
  const double area = across.norm();
  if (!(area > 1e-12 * a.norm() * b.norm())) return ends;  // seen end-on
  const Vec3 normal = across / area;
  const Vec3 foot = direction - direction.dot(normal) * normal;
  // The foot lies between the ends if it is on the inner side of both.
  if (across.dot(a.cross(foot)) < 0 || across.dot(foot.cross(b)) < 0) return ends;
  return std::min(ends, std::abs(std::asin(std::clamp(direction.dot(normal), -1.0, 1.0))));
}

/// Whether a ray from the origin goes through the box.
bool ray_meets(const Vec3& direction, const Vec3& min_m, const Vec3& max_m) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      if (min_m[axis] > 0 || max_m[axis] < 0) return false;
      continue;
    }
    const double one = min_m[axis] / direction[axis], other = max_m[axis] / direction[axis];
    enter = std::max(enter, std::min(one, other));
    leave = std::min(leave, std::max(one, other));
  }
  return enter <= leave;
}

Joints middle_of(const JointBox& box) {
  return {(box.least.pan_rad + box.most.pan_rad) / 2, (box.least.tilt_rad + box.most.tilt_rad) / 2,
          (box.least.beam_rad + box.most.beam_rad) / 2};
}

/// Largest |sin| between two angles.
double max_sine(double from_rad, double to_rad) {
  const double half_turn = std::floor((to_rad - kPi / 2) / kPi) * kPi + kPi / 2;
  if (half_turn >= from_rad) return 1;
  return std::max(std::abs(std::sin(from_rad)), std::abs(std::sin(to_rad)));
}

Joints on_line(const Joints& from, const Joints& to, double share) {
  return {from.pan_rad + (to.pan_rad - from.pan_rad) * share, from.tilt_rad + (to.tilt_rad - from.tilt_rad) * share,
          from.beam_rad + (to.beam_rad - from.beam_rad) * share};
}

}  // namespace

JointBox JointBox::joined(const JointBox& other) const {
  return {{std::min(least.pan_rad, other.least.pan_rad), std::min(least.tilt_rad, other.least.tilt_rad),
           std::min(least.beam_rad, other.least.beam_rad)},
          {std::max(most.pan_rad, other.most.pan_rad), std::max(most.tilt_rad, other.most.tilt_rad),
           std::max(most.beam_rad, other.most.beam_rad)}};
}

double field_half_angle_rad(const Luminaire& luminaire, double beam_rad) {
  if (luminaire.model == LuminaireModel::spot) {
    const double zoomed = beam_rad > 0 && luminaire.beam_angle_rad > 0 ? beam_rad / luminaire.beam_angle_rad : 1.0;
    return std::min(kPi, zoomed * luminaire.field_angle_rad / 2);
  }
  const double min_cd = kFieldShare * luminaire.intensity->max_intensity_cd();
  for (double gamma = kPi; gamma > 0; gamma -= kGammaStep_rad) {
    for (double azimuth = 0; azimuth < 2 * kPi; azimuth += kAzimuthStep_rad) {
      const Vec3 direction(std::sin(gamma) * std::cos(azimuth), std::sin(gamma) * std::sin(azimuth), -std::cos(gamma));
      if (luminaire.intensity->intensity_cd(direction) >= min_cd) return std::min(kPi, gamma + kGammaStep_rad);
    }
  }
  return kGammaStep_rad;
}

double angle_to_ball_rad(const Vec3& from_m, const Vec3& direction, const Vec3& centre_m, double radius_m) {
  const Vec3 towards = centre_m - from_m;
  const double distance_m = towards.norm();
  if (distance_m <= radius_m) return 0;
  return std::max(0.0, angle_between(direction, towards) - std::asin(radius_m / distance_m));
}

/// From outside, a box is a convex polygon on the sphere of directions. If a direction does not meet it, its nearest
/// point lies on the outline, which consists of edges of the box.
double angle_to_box_rad(const Vec3& from_m, const Vec3& direction, const Eigen::AlignedBox3d& box_m) {
  const Vec3 low = box_m.min() - from_m, high = box_m.max() - from_m;
  if (ray_meets(direction, low, high)) return 0;
  std::array<Vec3, 8> corner;
  for (unsigned i = 0; i < 8; ++i)
    corner[i] = Vec3((i & 1u) != 0 ? high.x() : low.x(), (i & 2u) != 0 ? high.y() : low.y(),
                     (i & 4u) != 0 ? high.z() : low.z());
  double min_rad = kPi;
  for (unsigned i = 0; i < 8; ++i) {
    for (const unsigned bit : {1u, 2u, 4u}) {
      if ((i & bit) == 0) min_rad = std::min(min_rad, angle_to_edge_rad(direction, corner[i], corner[i | bit]));
    }
  }
  return min_rad;
}

KeepOutZones::KeepOutZones(const Rig& rig) : zones_(rig.keep_outs) {
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const bool any = std::any_of(zones_.begin(), zones_.end(), [f](const KeepOut& zone) {
      return std::binary_search(zone.heads.begin(), zone.heads.end(), f);
    });
    if (!any) continue;
    heads_.push_back(f);
    const Luminaire& luminaire = rig.luminaires[rig.fixtures[f].luminaire];
    beams_.push_back({rig.fixtures[f].world_from_mount, luminaire, field_half_angle_rad(luminaire, 0)});
  }
}

const KeepOutZones::Beam* KeepOutZones::beam_of(std::size_t fixture) const {
  const auto found = std::lower_bound(heads_.begin(), heads_.end(), fixture);
  if (found == heads_.end() || *found != fixture) return nullptr;
  return &beams_[static_cast<std::size_t>(found - heads_.begin())];
}

double KeepOutZones::half_angle_rad(const Beam& beam, double zoom_rad) {
  return zoom_rad > 0 ? field_half_angle_rad(beam.luminaire, zoom_rad) : beam.half_angle_rad;
}

double KeepOutZones::room_rad(const KeepOut& zone, const Beam& beam, const Joints& at, double half_angle_rad) {
  const Vec3 axis = world_from_lamp(beam.world_from_mount, at).rotation * -Vec3::UnitZ();
  const Vec3& from_m = beam.world_from_mount.translation_m;
  const double angle_rad = zone.box_world_m ? angle_to_box_rad(from_m, axis, *zone.box_world_m)
                                            : angle_to_ball_rad(from_m, axis, zone.centre_world_m, zone.radius_m);
  return angle_rad - half_angle_rad - zone.margin_rad;
}

std::optional<std::size_t> KeepOutZones::met(std::size_t fixture, const Joints& joints) const {
  const Beam* beam = beam_of(fixture);
  for (std::size_t z = 0; beam != nullptr && z < zones_.size(); ++z) {
    const auto& heads = zones_[z].heads;
    if (std::binary_search(heads.begin(), heads.end(), fixture) &&
        room_rad(zones_[z], *beam, joints, half_angle_rad(*beam, joints.beam_rad)) <= 0)
      return z;
  }
  return std::nullopt;
}

/// Bounds the angle between the axis of any posture of a part and that of its middle: half the tilt range, plus half
/// the pan range times the largest sine of a tilt (a parallel is shorter than the equator).
bool KeepOutZones::box_meets(const KeepOut& zone, const Beam& beam, const JointBox& whole) {
  const double half_angle = half_angle_rad(beam, whole.most.beam_rad);
  std::vector<JointBox> parts = {whole};
  for (int looked = 0; !parts.empty(); ++looked) {
    if (looked >= kMaxParts) return true;
    const JointBox part = parts.back();
    parts.pop_back();
    const double pan_rad = (part.most.pan_rad - part.least.pan_rad) / 2;
    const double tilt_rad = (part.most.tilt_rad - part.least.tilt_rad) / 2;
    const double pan_reach_rad = pan_rad * max_sine(part.least.tilt_rad, part.most.tilt_rad);
    const Joints middle = middle_of(part);
    const double room = room_rad(zone, beam, middle, half_angle);
    if (room <= 0) return true;
    const double reach_rad = tilt_rad + pan_reach_rad;
    if (room > reach_rad) continue;
    if (reach_rad <= kSweepSlack_rad) return true;
    JointBox one = part, other = part;
    if (tilt_rad >= pan_reach_rad) {
      one.most.tilt_rad = other.least.tilt_rad = middle.tilt_rad;
    } else {
      one.most.pan_rad = other.least.pan_rad = middle.pan_rad;
    }
    parts.push_back(one);
    parts.push_back(other);
  }
  return false;
}

std::optional<std::size_t> KeepOutZones::may_meet(std::size_t fixture, const JointBox& box) const {
  const Beam* beam = beam_of(fixture);
  for (std::size_t z = 0; beam != nullptr && z < zones_.size(); ++z) {
    const auto& heads = zones_[z].heads;
    if (std::binary_search(heads.begin(), heads.end(), fixture) && box_meets(zones_[z], *beam, box)) return z;
  }
  return std::nullopt;
}

bool KeepOutZones::line_meets(const KeepOut& zone, const Beam& beam, const JointBox& from, const Joints& to,
                              double begin, double end, int depth) {
  const JointBox at_begin{on_line(from.least, to, begin), on_line(from.most, to, begin)};
  const JointBox at_end{on_line(from.least, to, end), on_line(from.most, to, end)};
  if (!box_meets(zone, beam, at_begin.joined(at_end))) return false;
  if (depth >= kMaxHalvings || box_meets(zone, beam, at_begin) || box_meets(zone, beam, at_end)) return true;
  const double middle = (begin + end) / 2;
  return line_meets(zone, beam, from, to, begin, middle, depth + 1) ||
         line_meets(zone, beam, from, to, middle, end, depth + 1);
}

std::optional<std::size_t> KeepOutZones::may_meet_on_line(std::size_t fixture, const JointBox& from,
                                                          const Joints& to) const {
  const Beam* beam = beam_of(fixture);
  for (std::size_t z = 0; beam != nullptr && z < zones_.size(); ++z) {
    const auto& heads = zones_[z].heads;
    if (std::binary_search(heads.begin(), heads.end(), fixture) && line_meets(zones_[z], *beam, from, to, 0, 1, 0))
      return z;
  }
  return std::nullopt;
}

}  // namespace luxrig
