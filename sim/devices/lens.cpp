#include "sim/devices/lens.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/picture/rig_camera.h"
#include "sim/world/random.h"

namespace luxrig::sim {
namespace {

constexpr int kCloser = 6;  // of an offset that leads through a surface; then there is none
/// Standard deviation of a halo, as a share of the picture's height.
constexpr double kLeastHalo = 0.01, kMostHalo = 0.04;
constexpr int kBlurs = 3;  // boxes after which a blur is nearly Gaussian

/// A box along one line, in place. The line's edges mirror the light, so that none is lost.
void blur_line(Vec3f* line, int count, int stride, int reach, std::vector<Vec3f>& copy) {
  copy.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) copy[static_cast<std::size_t>(i)] = line[i * stride];
  const auto at = [&](int i) -> const Vec3f& {
    i = (i % (2 * count) + 2 * count) % (2 * count);
    return copy[static_cast<std::size_t>(i < count ? i : 2 * count - 1 - i)];
  };
  Vec3 sum = Vec3::Zero();
  for (int i = -reach; i <= reach; ++i) sum += at(i).cast<double>();
  for (int i = 0; i < count; ++i) {
    line[i * stride] = (sum / (2 * reach + 1)).cast<float>();
    sum += (at(i + reach + 1) - at(i - reach)).cast<double>();
  }
}

std::vector<Vec3f> blurred(std::vector<Vec3f> light, int width_px, int height_px, double reach_px) {
  // Three boxes of half width h have a variance of h (h + 1).
  const int reach = static_cast<int>(std::lround((std::sqrt(1 + 4 * reach_px * reach_px) - 1) / 2));
  if (reach < 1) return light;
  std::vector<Vec3f> copy;
  for (int k = 0; k < kBlurs; ++k) {
    for (int y = 0; y < height_px; ++y)
      blur_line(light.data() + static_cast<std::ptrdiff_t>(y) * width_px, width_px, 1, reach, copy);
    for (int x = 0; x < width_px; ++x) blur_line(light.data() + x, height_px, width_px, reach, copy);
  }
  return light;
}

}  // namespace

CameraTruth draw_camera(const Rig& rig, const PictureCamera& camera, std::size_t index, const Deviations& deviations,
                        const RayScene* room) {
  const std::uint64_t seed = deviations.seed;
  CameraTruth truth;
  truth.view = view_of(camera);
  Vec3 offset_m, turn_rad;
  for (int axis = 0; axis < 3; ++axis) {
    const auto counter = static_cast<std::uint64_t>(axis);
    offset_m[axis] =
        deviations.camera_position_m / std::sqrt(3) * random_signed(seed, Draw::camera_place, index, counter);
    turn_rad[axis] =
        deviations.camera_angle_rad / std::sqrt(3) * random_signed(seed, Draw::camera_place, index, 3 + counter);
  }
  const Vec3 stated_m = truth.view.eye_world_m;
  for (int k = 0; room && k < kCloser && room->occluded(stated_m, Vec3::Zero(), stated_m + offset_m); ++k)
    offset_m *= k + 1 < kCloser ? 0.5 : 0.0;
  // About two axes across the direction that it looks along, and about that one.
  const Vec3 to_target_m = truth.view.target_world_m - stated_m, ahead = to_target_m.normalized();
  const Vec3 side = ahead.unitOrthogonal();
  const Mat3 turn = Eigen::AngleAxisd(turn_rad.x(), side).toRotationMatrix() *
                    Eigen::AngleAxisd(turn_rad.y(), ahead.cross(side)).toRotationMatrix();
  truth.view.eye_world_m += offset_m;
  truth.view.target_world_m = truth.view.eye_world_m + turn * to_target_m;
  truth.view.roll_rad = turn_rad.z();

  const auto drawn = [&](std::uint64_t counter) { return random_unit(seed, Draw::camera_lens, index, counter); };
  truth.view.vertical_fov_rad *= 1 + deviations.camera_field_share * (2 * drawn(0) - 1);
  truth.view.distortion = deviations.camera_distortion * (2 * drawn(1) - 1);
  truth.corner_loss = deviations.camera_vignetting * drawn(2);
  truth.flare = deviations.camera_flare * drawn(3);
  truth.halo = deviations.camera_halo * drawn(4);
  truth.halo_reach_px = camera.height_px * (kLeastHalo + (kMostHalo - kLeastHalo) * drawn(5));
  if (deviations.camera_log_response > 0)
    for (std::size_t l = 0; l <= rig.luminaires.size(); ++l)
      truth.response.push_back(
          std::exp(deviations.camera_log_response * random_signed(seed, Draw::camera_response, index, l)));
  return truth;
}

void through_lens(const CameraTruth& truth, Picture& picture) {
  const int width_px = picture.width_px, height_px = picture.height_px;
  const double corner2_px2 = (width_px * width_px + height_px * height_px) / 4.0;
  const double tan2_of_corner = 1 / std::sqrt(1 - truth.corner_loss) - 1;
  Vec3 sum = Vec3::Zero();
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      const double aside_px = x + 0.5 - width_px / 2.0, down_px = y + 0.5 - height_px / 2.0;
      const double stretch = 1 + tan2_of_corner * (aside_px * aside_px + down_px * down_px) / corner2_px2;
      Vec3f& pixel = picture.luminance_cd_m2[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) +
                                             static_cast<std::size_t>(x)];
      pixel *= static_cast<float>(1 / (stretch * stretch));  // cos⁴ = (1 + tan²)⁻²
      sum += pixel.cast<double>();
    }
  if (!(truth.flare > 0 || truth.halo > 0)) return;
  const std::vector<Vec3f> around = truth.halo > 0
                                        ? blurred(picture.luminance_cd_m2, width_px, height_px, truth.halo_reach_px)
                                        : picture.luminance_cd_m2;
  const auto kept = static_cast<float>(1 - truth.flare - truth.halo), halo = static_cast<float>(truth.halo);
  const Vec3f veil = (truth.flare / static_cast<double>(picture.luminance_cd_m2.size()) * sum).cast<float>();
  for (std::size_t i = 0; i < picture.luminance_cd_m2.size(); ++i)
    picture.luminance_cd_m2[i] = kept * picture.luminance_cd_m2[i] + halo * around[i] + veil;
}

}  // namespace luxrig::sim
