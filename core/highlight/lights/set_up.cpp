#include "core/highlight/lights/set_up.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

struct Angles {
  double aside_min_deg, aside_max_deg, above_min_deg, above_max_deg;
};
/// By SetUp, for those that are beside the camera.
constexpr Angles kPortrait[] = {
    {0, 180, -90, 90}, {30, 60, 30, 60}, {30, 45, 10, 35}, {80, 100, -15, 30}, {30, 60, 10, 50}};
constexpr double kRakingMin_deg = 5, kRakingMax_deg = 15;  // off the surface
constexpr double kCopyMin_deg = 40, kCopyMax_deg = 50;     // off its normal
constexpr double kCopyRows_deg = 20;                       // off the picture's rows
constexpr double kRimMin_deg = 100;                        // from the direction to the camera
/// Share of the seen surface by which a side must light more to be the broad one.
constexpr double kBroader = 0.02;

bool within(double value_rad, double min_deg, double max_deg) {
  return value_rad >= rad_from_deg(min_deg) && value_rad <= rad_from_deg(max_deg);
}

double angle_of_two(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// At these angles, on the picture's right (side 1) or left (-1).
Vec3 portrait_direction(const SetUpFrame& frame, int side, double aside_rad, double above_rad) {
  const Vec3 level = Vec3(frame.to_camera.x(), frame.to_camera.y(), 0).normalized();
  return std::cos(above_rad) * (std::cos(aside_rad) * level + side * std::sin(aside_rad) * frame.right) +
         std::sin(above_rad) * Vec3::UnitZ();
}

}  // namespace

SetUpFrame set_up_frame(const SeenContrast& seen, const Vec3& middle_world_m, const Vec3& eye_world_m) {
  SetUpFrame frame;
  frame.to_camera = (eye_world_m - middle_world_m).normalized();
  const Vec3 across = Vec3::UnitZ().cross(frame.to_camera);
  frame.right = across.norm() > 1e-6 ? Vec3(across.normalized()) : Vec3(Vec3::UnitX());
  Vec3 sum = Vec3::Zero();
  double objects = 0, left = 0, right = 0;
  const Vec3 from_right = portrait_direction(frame, 1, rad_from_deg(45), rad_from_deg(30)),
             from_left = portrait_direction(frame, -1, rad_from_deg(45), rad_from_deg(30));
  for (std::size_t s = 0; s < seen.samples().size(); ++s) {
    if (!seen.of_object(s)) continue;
    const Vec3& normal = seen.samples()[s].normal;
    sum += normal;
    ++objects;
    right += normal.dot(from_right) > 0 ? 1 : 0;
    left += normal.dot(from_left) > 0 ? 1 : 0;
  }
  frame.surface = sum.norm() > 1e-6 * objects ? Vec3(sum.normalized()) : frame.to_camera;
  if (std::abs(right - left) > kBroader * objects) frame.broad_side = right > left ? 1 : -1;
  return frame;
}

AsideAbove aside_above(const SetUpFrame& frame, const Vec3& towards) {
  const Vec3 level_camera(frame.to_camera.x(), frame.to_camera.y(), 0), level_light(towards.x(), towards.y(), 0);
  return {angle_of_two(level_camera, level_light), std::atan2(towards.z(), level_light.norm())};
}

std::optional<int> LightWindow::lights() const {
  if (set_up_ == SetUp::none) return std::nullopt;
  return set_up_ == SetUp::copy ? 2 : 1;
}

bool LightWindow::has(const Vec3& towards) const {
  if (role_ == LightRole::rim && angle_of_two(towards, frame_.to_camera) < rad_from_deg(kRimMin_deg)) return false;
  const double off_normal_rad = angle_of_two(towards, frame_.surface);
  switch (set_up_) {
    case SetUp::none:
      return true;
    case SetUp::raking:
      return within(kPi / 2 - off_normal_rad, kRakingMin_deg, kRakingMax_deg);
    case SetUp::copy: {
      const Vec3 down = frame_.surface.cross(frame_.right).normalized();
      return within(off_normal_rad, kCopyMin_deg, kCopyMax_deg) &&
             std::abs(towards.dot(down)) <= std::sin(rad_from_deg(kCopyRows_deg)) * towards.norm();
    }
    case SetUp::rembrandt:
    case SetUp::loop:
    case SetUp::split:
    case SetUp::broad:
      break;
  }
  const Angles& of = kPortrait[static_cast<int>(set_up_)];
  const AsideAbove at = aside_above(frame_, towards);
  if (set_up_ == SetUp::broad && frame_.broad_side != 0 && side_of(towards) != frame_.broad_side) return false;
  return within(at.aside_rad, of.aside_min_deg, of.aside_max_deg) &&
         within(at.above_rad, of.above_min_deg, of.above_max_deg);
}

Vec3 LightWindow::middle(int side) const {
  if (set_up_ == SetUp::broad && frame_.broad_side != 0) side = frame_.broad_side;
  const auto off_surface = [&](double degrees) {
    const double rad = rad_from_deg(degrees);
    const Vec3 along = (frame_.right - frame_.right.dot(frame_.surface) * frame_.surface).normalized();
    return Vec3(std::sin(rad) * frame_.surface + side * std::cos(rad) * along);
  };
  if (set_up_ == SetUp::raking) return off_surface((kRakingMin_deg + kRakingMax_deg) / 2);
  if (set_up_ == SetUp::copy) return off_surface(90 - (kCopyMin_deg + kCopyMax_deg) / 2);
  if (set_up_ == SetUp::none) return portrait_direction(frame_, side, rad_from_deg(145), rad_from_deg(40));
  const Angles& of = kPortrait[static_cast<int>(set_up_)];
  return portrait_direction(frame_, side, rad_from_deg(of.aside_min_deg + of.aside_max_deg) / 2,
                            rad_from_deg(of.above_min_deg + of.above_max_deg) / 2);
}

std::string LightWindow::words() const {
  if (set_up_ == SetUp::none)
    return fmt::format("a rim light stands {:g}° or more from the camera's side", kRimMin_deg);
  const std::string name = fmt::format("set_up \"{}\" wants its light", name_of(set_up_));
  if (set_up_ == SetUp::raking)
    return fmt::format("{} {:g} to {:g}° off the surface", name, kRakingMin_deg, kRakingMax_deg);
  if (set_up_ == SetUp::copy)
    return fmt::format("set_up \"copy\" wants one light on either side, {:g} to {:g}° from straight before the surface",
                       kCopyMin_deg, kCopyMax_deg);
  const Angles& of = kPortrait[static_cast<int>(set_up_)];
  return fmt::format("{} {:g} to {:g}° aside of the camera and {:g} to {:g}° above the level{}", name, of.aside_min_deg,
                     of.aside_max_deg, of.above_min_deg, of.above_max_deg,
                     set_up_ == SetUp::broad && frame_.broad_side != 0
                         ? (frame_.broad_side > 0 ? ", on the picture's right" : ", on the picture's left")
                         : "");
}

}  // namespace luxrig
