/// Properties that must hold at any accuracy: light adds up, and walls stop it.

#include <fmt/format.h>

#include "tools/bench/rooms/solid_model.h"
#include "tools/bench/transport/case.h"

namespace luxrig {
namespace {

/// The lamps one by one add up to all lamps together. Every evaluator's matrix has a column per lamp. Direct light is
/// also evaluated lamp by lamp, since it has no sampling that could differ.
void add_superposition(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const TransportCase one(make_eight_room_flat());
  for (const Method& method : methods()) {
    EvaluateOptions evaluate;
    evaluate.wanted_relative_error = 0.1;
    evaluate.threads = options.threads;
    evaluate.max_rays = 20'000'000;
    const Measured all = measure(method, one.rays, one.room.receivers, one.room.emitters, evaluate);
    double error = 0;
    if (all.refused.empty()) {
      const auto count = static_cast<Eigen::Index>(one.room.emitters.size());
      const Eigen::VectorXd together = all.matrix.lux(Eigen::VectorXd::Ones(count));
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(together.size());
      for (Eigen::Index e = 0; e < count; ++e) {
        if (method.reflects) {
          sum += all.matrix.lux(Eigen::VectorXd::Unit(count, e));
        } else {
          const std::vector<Emitter> alone = {one.room.emitters[static_cast<std::size_t>(e)]};
          sum += measure(method, one.rays, one.room.receivers, alone, evaluate).matrix.lux(Eigen::VectorXd::Ones(1));
        }
      }
      error = (sum - together).cwiseAbs().maxCoeff() / together.maxCoeff();
    }
    rows.push_back(transport_row("superposition", method.name, error, all, std::nullopt, 1e-12));
  }
}

/// Two closed rooms that share a wall of 15 cm, also far from the origin: a lamp in one, receivers in the other. The
/// brightest receiver there, relative to the mean in the lamp's room.
void add_wall_leak(const BenchOptions& options, std::vector<BenchRow>& rows) {
  for (const double far_m : {0.0, 100'000.0}) {
    SolidModel model;
    const auto white = model.material("white", {0.8, 0.8, 0.8});
    model.begin_object("rooms");
    model.shell(Vec3::Zero(), {6.15, 4, 2.6}, 0.3, white, white, {white, white, white, white});
    model.box({3.0, -0.1, -0.1}, {3.15, 4.1, 2.7}, white);
    Scene scene = model.scene();
    const Vec3 origin_m(far_m, -far_m, 0);
    scene.origin_world_m = origin_m;
    const RayScene rays(scene);
    // Near the wall, in its corners, and on it.
    std::vector<Receiver> receivers;
    std::size_t lit = 0;
    for (const bool dark : {false, true})
      for (int i = 0; i < 120; ++i) {
        const double u = (i % 12 + 0.5) / 12, v = (i / 12 + 0.5) / 10;
        const double x = dark ? (i % 3 == 0 ? 3.15 : 3.15 + 0.02 * (1 + i % 5)) : 3.0 - 0.02 * (1 + i % 5);
        const Vec3 normal = i % 2 ? Vec3::UnitX() : Vec3(i % 4 ? Vec3::UnitZ() : Vec3(-Vec3::UnitY()));
        receivers.push_back({origin_m + Vec3(x, 0.001 + 3.998 * u, 0.001 + 2.598 * v), normal});
        lit += !dark;
      }
    // The receivers on the lit side face the lamp's half of the room.
    for (std::size_t r = 0; r < lit; ++r)
      if (receivers[r].normal_world.x() > 0) receivers[r].normal_world = -receivers[r].normal_world;
    const std::vector<Emitter> lamps = {
        {make_isotropic(5000), {Mat3::Identity(), origin_m + Vec3(2.9, 2.0, 1.3)}},
        {make_spot(5000, rad_from_deg(20), rad_from_deg(40)),
         {Eigen::AngleAxisd(-kPi / 2, Vec3::UnitY()).toRotationMatrix(), origin_m + Vec3(0.5, 0.01, 0.01)}}};
    for (const Method& method : methods()) {
      EvaluateOptions evaluate;
      evaluate.wanted_relative_error = 0.02;
      evaluate.threads = options.threads;
      evaluate.max_rays = options.quick ? 5'000'000 : 100'000'000;
      const Measured run = measure(method, rays, receivers, lamps, evaluate);
      double error = 0;
      if (run.refused.empty()) {
        const Eigen::VectorXd lux = run.matrix.lux(Eigen::VectorXd::Ones(2));
        const auto n = static_cast<Eigen::Index>(lit);
        error = lux.tail(lux.size() - n).maxCoeff() / lux.head(n).mean();
      }
      rows.push_back(transport_row(fmt::format("wall-leak{}", far_m > 0 ? "-at-100-km" : ""), method.name, error, run,
                                   std::nullopt, 0.0));
    }
  }
}

}  // namespace

void add_identity_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  if (wanted_case(options, "superposition")) add_superposition(options, rows);
  if (wanted_case(options, "wall-leak")) add_wall_leak(options, rows);
}

}  // namespace luxrig
