#include "sim/world/head_light.h"

#include <algorithm>
#include <cmath>

namespace luxrig::sim {
namespace {

class SampledHeadLight final : public HeadLight {
 public:
  SampledHeadLight(std::vector<Receiver> receivers, std::vector<HeadSamples> heads)
      : receivers_(std::move(receivers)), heads_(std::move(heads)) {}

  void column(std::size_t fixture, const PanTilt& joints, Eigen::Ref<Eigen::VectorXd> lux) const override {
    const auto head = std::find_if(heads_.begin(), heads_.end(),
                                   [fixture](const HeadSamples& each) { return each.fixture == fixture; });
    if (head == heads_.end()) return;
    add_indirect(*head, beam_mount(joints), lux);
    const Pose world_from_lamp = luxrig::world_from_lamp(head->world_from_mount, joints, head->roll_rad);
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      if (!head->sees[r]) continue;
      const Vec3 to_receiver = receivers_[r].position_world_m - world_from_lamp.translation_m;
      const double distance_m = to_receiver.norm();
      const double cosine = -receivers_[r].normal_world.dot(to_receiver) / distance_m;
      if (!(cosine > 0)) continue;
      const Vec3 direction_lamp = world_from_lamp.inverse_direction(to_receiver / distance_m);
      lux[static_cast<Eigen::Index>(r)] +=
          head->intensity->intensity_cd(direction_lamp) * cosine / (distance_m * distance_m);
    }
  }

 private:
  static void add_indirect(const HeadSamples& head, const Vec3& beam, Eigen::Ref<Eigen::VectorXd> lux) {
    lux.setZero();
    double sum = 0;
    for (std::size_t a = 0; a < head.aims_mount.size(); ++a) {
      const double angle_rad = std::atan2(beam.cross(head.aims_mount[a]).norm(), beam.dot(head.aims_mount[a]));
      const auto column = head.indirect_lux_per_level.col(static_cast<Eigen::Index>(a));
      if (angle_rad < 1e-6) {
        lux = column;
        return;
      }
      const double weight = std::pow(angle_rad, -4);
      lux += weight * column;
      sum += weight;
    }
    if (sum > 0) lux /= sum;
  }

  std::vector<Receiver> receivers_;
  std::vector<HeadSamples> heads_;
};

}  // namespace

std::unique_ptr<const HeadLight> make_head_light(std::vector<Receiver> receivers, std::vector<HeadSamples> heads) {
  return std::make_unique<SampledHeadLight>(std::move(receivers), std::move(heads));
}

Vec3 beam_mount(const PanTilt& joints) {
  return {-std::sin(joints.pan_rad) * std::sin(joints.tilt_rad), std::cos(joints.pan_rad) * std::sin(joints.tilt_rad),
          -std::cos(joints.tilt_rad)};
}

std::vector<PanTilt> spread_aims(const PanTiltRange& range, int count) {
  // A Fibonacci lattice over the cap that the tilt can reach, straight down first. Aims whose pan is out of range are
  // left out: such a head cannot look there.
  const double reach_rad = std::min(kPi, std::max(std::abs(range.tilt_min_rad), std::abs(range.tilt_max_rad)));
  const double golden_turn_rad = kPi * (3 - std::sqrt(5.0));
  std::vector<PanTilt> aims;
  for (int i = 0; i < count; ++i) {
    const double share = (i + 0.5) / count;
    PanTilt joints;
    joints.tilt_rad = std::acos(1 - share * (1 - std::cos(reach_rad)));
    joints.pan_rad = std::remainder(i * golden_turn_rad, 2 * kPi);
    if (joints.tilt_rad > range.tilt_max_rad) {  // the other way over the top
      joints.tilt_rad = -joints.tilt_rad;
      joints.pan_rad = std::remainder(joints.pan_rad + kPi, 2 * kPi);
    }
    if (joints.tilt_rad >= range.tilt_min_rad && joints.pan_rad >= range.pan_min_rad &&
        joints.pan_rad <= range.pan_max_rad) {
      aims.push_back(joints);
    }
  }
  return aims;
}

}  // namespace luxrig::sim
