#include "sim/world/head_light.h"

#include <algorithm>
#include <cmath>

#include "core/photometry/shapes/shape_sampling.h"
#include "core/tasks/rig_transport.h"
#include "core/transport/direct/shape_light.h"

namespace luxrig::sim {
namespace {

constexpr double kShapeError = 1e-3;
constexpr int kSeenRays = 64;

class SampledHeadLight final : public HeadLight {
 public:
  SampledHeadLight(std::vector<Receiver> receivers, std::vector<HeadSamples> heads)
      : receivers_(std::move(receivers)), heads_(std::move(heads)) {}

  void column(std::size_t fixture, const Joints& joints, Eigen::Ref<Eigen::VectorXd> lux) const override {
    const auto head = std::find_if(heads_.begin(), heads_.end(),
                                   [fixture](const HeadSamples& each) { return each.fixture == fixture; });
    if (head == heads_.end()) return;
    add_indirect(*head, beam_mount(joints), lux);
    Pose world_from_lamp = luxrig::world_from_lamp(head->world_from_mount, joints, head->roll_rad);
    world_from_lamp.rotation = world_from_lamp.rotation * head->photometry_from_lamp;
    const Emitter emitter = emitter_of(head->luminaire, world_from_lamp, joints.beam_rad);
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      if (!(head->sees[r] > 0)) continue;
      lux[static_cast<Eigen::Index>(r)] +=
          head->sees[r] *
          illuminance_lx(receivers_[r].position_world_m, receivers_[r].normal_world, emitter, kShapeError);
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

std::vector<double> seen_shares(const RayScene& scene, const std::vector<Receiver>& receivers, const Emitter& head) {
  const Pose& pose = head.world_from_lamp;
  const auto sees = [&](const Receiver& receiver, const Vec3& at_m) {
    const bool hidden = scene.occluded(receiver.position_world_m, receiver.normal_world, at_m);
    return hidden ? 0.0 : scene.transmittance(receiver.position_world_m, at_m);
  };
  std::vector<double> shares;
  for (const Receiver& receiver : receivers) {
    double seen = 0;
    int asked = 0;
    for (int k = 0; k < kSeenRays && head.shape.kind != LuminousShape::Kind::point; ++k) {
      // Points of the R2 sequence (Roberts 2018): even over the square without a generator.
      const double u = std::fmod(0.5 + 0.7548776662466927 * k, 1.0), v = std::fmod(0.5 + 0.5698402909980532 * k, 1.0);
      const Vec3 from_lamp_m = pose.inverse_direction(receiver.position_world_m - pose.translation_m);
      const ShapeSample sample = sample_seen_from(head.shape, from_lamp_m, u, v);
      if (!(sample.density_per_sr > 0)) continue;
      const Vec3 to_world = pose.direction(sample.direction);
      if (!(receiver.normal_world.dot(to_world) > 0)) continue;
      ++asked;
      seen += sees(receiver, receiver.position_world_m + sample.distance_m * to_world);
    }
    shares.push_back(asked > 0 ? seen / asked : sees(receiver, pose.translation_m));
  }
  return shares;
}

Vec3 beam_mount(const Joints& joints) {
  return {-std::sin(joints.pan_rad) * std::sin(joints.tilt_rad), std::cos(joints.pan_rad) * std::sin(joints.tilt_rad),
          -std::cos(joints.tilt_rad)};
}

std::vector<Joints> spread_aims(const JointRange& range, int count) {
  // A Fibonacci lattice over the cap that the tilt can reach, straight down first. Leaves out aims with a pan out of
  // range, as such a head cannot look there.
  const double reach_rad = std::min(kPi, std::max(std::abs(range.tilt_min_rad), std::abs(range.tilt_max_rad)));
  const double golden_turn_rad = kPi * (3 - std::sqrt(5.0));
  std::vector<Joints> aims;
  for (int i = 0; i < count; ++i) {
    const double share = (i + 0.5) / count;
    Joints joints;
    joints.tilt_rad = std::acos(1 - share * (1 - std::cos(reach_rad)));
    joints.pan_rad = std::remainder(i * golden_turn_rad, 2 * kPi);
    if (joints.tilt_rad > range.tilt_max_rad) {  // tilt to the other side
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
