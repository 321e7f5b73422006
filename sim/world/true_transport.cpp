// World::make from a rig alone: its scene, true poses, and their light.
#include <fmt/format.h>

#include "core/scene/ray_scene.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/scene_builder.h"
#include "core/transport/evaluator.h"
#include "sim/world/head_light.h"
#include "sim/world/world.h"

namespace luxrig::sim {
namespace {

constexpr int kSpreadAims = 32;  // per moving head; see head_light.h
// Indirect light at these aims is a small part of the whole, and is interpolated anyway.
constexpr double kSpreadErrorFactor = 3;

// Progress of one part of the work, within the whole.
Watch part_of(const Watch& watch, double from, double to) {
  Watch part;
  part.stop = watch.stop;
  if (watch.progress) {
    part.progress = [report = watch.progress, from, to](double done) { report(from + (to - from) * done); };
  }
  return part;
}

// The head at the rig's aim first, then at the spread aims.
std::vector<Joints> aims_of(const Fixture& fixture) {
  std::vector<Joints> aims = {fixture.joints};
  for (const Joints& joints : spread_aims(fixture.range, kSpreadAims)) aims.push_back(joints);
  return aims;
}

Result<std::unique_ptr<const HeadLight>> light_of_heads(const Rig& rig, const std::vector<FixtureTruth>& truths,
                                                        const RayScene& scene, const std::vector<Receiver>& receivers,
                                                        const TransportMatrix& nominal,
                                                        const EvaluateOptions& options) {
  std::vector<HeadSamples> heads;
  std::vector<Emitter> emitters;  // each head at its spread aims, head by head
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Fixture& fixture = rig.fixtures[f];
    if (!fixture.moves) continue;
    HeadSamples head;
    head.fixture = f;
    head.world_from_mount = truths[f].world_from_mount;
    head.roll_rad = fixture.roll_rad;
    head.luminaire = rig.luminaires[fixture.luminaire];
    const auto emitter_at = [&](const Joints& joints) {
      return emitter_of(head.luminaire, world_from_lamp(head.world_from_mount, joints, head.roll_rad),
                        fixture.joints.beam_rad);
    };
    head.sees = seen_shares(scene, receivers, emitter_at(fixture.joints));
    const std::vector<Joints> aims = aims_of(fixture);
    for (std::size_t a = 0; a < aims.size(); ++a) {
      head.aims_mount.push_back(beam_mount(aims[a]));
      if (a > 0) emitters.push_back(emitter_at(aims[a]));
    }
    heads.push_back(std::move(head));
  }
  if (heads.empty()) return std::unique_ptr<const HeadLight>();

  const auto spread = make_path_evaluator(scene)->evaluate(receivers, emitters, options);
  if (!spread) return tl::unexpected(spread.error());
  const Eigen::MatrixXd spread_indirect = spread->lux_per_level - spread->direct_lux_per_level;
  const Eigen::MatrixXd nominal_indirect = nominal.lux_per_level - nominal.direct_lux_per_level;
  Eigen::Index next = 0;
  for (HeadSamples& head : heads) {
    const auto count = static_cast<Eigen::Index>(head.aims_mount.size());
    head.indirect_lux_per_level.resize(static_cast<Eigen::Index>(receivers.size()), count);
    head.indirect_lux_per_level.col(0) = nominal_indirect.col(static_cast<Eigen::Index>(head.fixture));
    head.indirect_lux_per_level.rightCols(count - 1) = spread_indirect.middleCols(next, count - 1);
    // Rounding of total - direct must not make light negative.
    head.indirect_lux_per_level = head.indirect_lux_per_level.cwiseMax(0.0);
    next += count - 1;
  }
  return make_head_light(receivers, std::move(heads));
}

}  // namespace

Result<std::unique_ptr<World>> World::make(const Rig& rig, const Deviations& deviations, double max_error,
                                           const Watch& watch) {
  const auto built = build_scene(rig);
  if (!built) {
    return tl::unexpected(
        Fault{Cause::invalid, "", built.error().empty() ? "scene" : built.error().front().text(), {}});
  }
  const RayScene scene(*built);
  const std::vector<FixtureTruth> truths = draw_fixtures(rig, deviations);
  Rig true_rig = rig;  // true poses, with the file's joints
  for (std::size_t f = 0; f < truths.size(); ++f) {
    true_rig.fixtures[f].world_from_mount = truths[f].world_from_mount;
  }
  const std::vector<Receiver> receivers = receivers_of(true_rig);

  bool any_moves = false;
  for (const Fixture& fixture : rig.fixtures) any_moves = any_moves || fixture.moves;
  EvaluateOptions options;
  options.wanted_relative_error = max_error;
  set_error_floor(rig, options);
  options.seed = deviations.seed;
  options.watch = part_of(watch, 0, any_moves ? 0.5 : 1);
  const auto transport = make_path_evaluator(scene)->evaluate(receivers, all_emitters_of(true_rig), options);
  if (!transport) return tl::unexpected(transport.error());

  options.wanted_relative_error = max_error * kSpreadErrorFactor;
  options.watch = part_of(watch, 0.5, 1);
  auto heads = light_of_heads(rig, truths, scene, receivers, *transport, options);
  if (!heads) return tl::unexpected(heads.error());
  const auto fixtures = static_cast<Eigen::Index>(rig.fixtures.size());
  return make(rig, deviations, transport->lux_per_level.leftCols(fixtures), std::move(*heads),
              daylight_lux(true_rig, *transport));
}

}  // namespace luxrig::sim
