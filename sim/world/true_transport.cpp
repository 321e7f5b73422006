// World::make from a rig alone: its scene, true poses, and their light.
#include <algorithm>
#include <utility>

#include "core/scene/ray_scene.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/scene_builder.h"
#include "core/transport/evaluator.h"
#include "sim/world/head_light.h"
#include "sim/world/random.h"
#include "sim/world/world.h"

namespace luxrig::sim {
namespace {

constexpr int kSpreadAims = 32;  // per moving head; see head_light.h
// Indirect light at these aims is a small part of the whole, and is interpolated anyway.
constexpr double kSpreadErrorFactor = 3;
constexpr double kDirectError = 1e-3;  // of a WorldMaker's direct light
constexpr double kGrazing = 0.02;      // light from the horizon itself is no light

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

/// Indirect light of the heads at their spread aims: receivers × aims, head by head.
struct SpreadLight {
  std::vector<std::size_t> heads;                       ///< fixtures
  std::vector<std::vector<Vec3>> aims_mount;            ///< per head
  std::vector<Eigen::MatrixXd> indirect_lux_per_level;  ///< per head
};

Emitter emitter_at(const Rig& rig, const Fixture& fixture, const FixtureTruth& truth, const Joints& joints) {
  return emitter_of(rig.luminaires[fixture.luminaire], true_lamp(truth, joints, fixture.roll_rad),
                    fixture.joints.beam_rad);
}

/// At the aims of the rig file, as they hang in truth.
std::vector<Emitter> true_emitters(const Rig& rig, const std::vector<FixtureTruth>& truths) {
  std::vector<Emitter> emitters;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
    emitters.push_back(emitter_at(rig, rig.fixtures[f], truths[f], true_joints(truths[f], rig.fixtures[f].joints)));
  return emitters;
}

Result<SpreadLight> spread_light(const Rig& rig, const std::vector<FixtureTruth>& truths, const RayScene& scene,
                                 const std::vector<Receiver>& receivers, const TransportMatrix& nominal,
                                 const EvaluateOptions& options) {
  SpreadLight light;
  std::vector<Emitter> emitters;  // each head at its spread aims, head by head
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    const Fixture& fixture = rig.fixtures[f];
    if (!fixture.moves) continue;
    light.heads.push_back(f);
    light.aims_mount.emplace_back();
    std::vector<Joints> aims = aims_of(fixture);
    aims.front() = true_joints(truths[f], aims.front());
    for (std::size_t a = 0; a < aims.size(); ++a) {
      light.aims_mount.back().push_back(beam_mount(aims[a]));
      if (a > 0) emitters.push_back(emitter_at(rig, fixture, truths[f], aims[a]));
    }
  }
  if (light.heads.empty()) return light;
  const auto spread = make_path_evaluator(scene)->evaluate(receivers, emitters, options);
  if (!spread) return tl::unexpected(spread.error());
  const Eigen::MatrixXd spread_indirect = spread->lux_per_level - spread->direct_lux_per_level;
  const Eigen::MatrixXd nominal_indirect = nominal.lux_per_level - nominal.direct_lux_per_level;
  Eigen::Index next = 0;
  for (std::size_t h = 0; h < light.heads.size(); ++h) {
    const auto count = static_cast<Eigen::Index>(light.aims_mount[h].size());
    Eigen::MatrixXd indirect(static_cast<Eigen::Index>(receivers.size()), count);
    indirect.col(0) = nominal_indirect.col(static_cast<Eigen::Index>(light.heads[h]));
    indirect.rightCols(count - 1) = spread_indirect.middleCols(next, count - 1);
    // Rounding of total - direct must not make light negative.
    light.indirect_lux_per_level.emplace_back(indirect.cwiseMax(0.0));
    next += count - 1;
  }
  return light;
}

std::unique_ptr<const HeadLight> light_of_heads(const Rig& rig, const std::vector<FixtureTruth>& truths,
                                                const RayScene& scene, const std::vector<Receiver>& receivers,
                                                const SpreadLight& spread) {
  std::vector<HeadSamples> heads;
  for (std::size_t h = 0; h < spread.heads.size(); ++h) {
    const std::size_t f = spread.heads[h];
    const Fixture& fixture = rig.fixtures[f];
    HeadSamples head;
    head.fixture = f;
    head.world_from_mount = truths[f].world_from_mount;
    head.photometry_from_lamp = truths[f].photometry_from_lamp;
    head.roll_rad = fixture.roll_rad;
    head.luminaire = rig.luminaires[fixture.luminaire];
    head.sees = seen_shares(scene, receivers, emitter_at(rig, fixture, truths[f], fixture.joints));
    head.aims_mount = spread.aims_mount[h];
    head.indirect_lux_per_level = spread.indirect_lux_per_level[h];
    heads.push_back(std::move(head));
  }
  return heads.empty() ? nullptr : make_head_light(receivers, std::move(heads));
}

std::vector<FixtureTruth> as_in_the_file(const Rig& rig) { return draw_fixtures(rig, Deviations::none()); }

/// cos^k instead of cos: per luxmeter its k, and what it makes of each fixture's light and of daylight.
MeterResponse response_of(const Rig& rig, const Deviations& deviations, const std::vector<Emitter>& lamps,
                          const Eigen::MatrixXd& lux, const Eigen::MatrixXd& direct_lux) {
  MeterResponse response;
  if (!(deviations.meter_cosine_exponent > 0)) return response;
  const auto meters = static_cast<Eigen::Index>(rig.luxmeters.size()),
             fixtures = static_cast<Eigen::Index>(lamps.size());
  const auto points = static_cast<Eigen::Index>(rig.points.size());
  response.of_fixtures.setOnes(meters, fixtures);
  response.of_daylight.setOnes(meters);
  for (Eigen::Index m = 0; m < meters; ++m) {
    const Luxmeter& meter = rig.luxmeters[static_cast<std::size_t>(m)];
    const double k = deviations.meter_cosine_exponent *
                     random_signed(deviations.seed, Draw::meter_cosine, static_cast<std::uint64_t>(m), 0);
    const double diffuse = 2 / (2 + k);  // the mean of cos^(1+k) over a hemisphere, over that of cos
    response.of_daylight[m] = diffuse;
    for (Eigen::Index f = 0; f < fixtures; ++f) {
      const double all = lux(points + m, f), direct = std::min(direct_lux(points + m, f), all);
      if (!(all > 0)) continue;
      const Vec3 to_lamp =
          (lamps[static_cast<std::size_t>(f)].world_from_lamp.translation_m - meter.position_world_m).normalized();
      const double slanted = std::pow(std::max(kGrazing, meter.normal_world.dot(to_lamp)), k);
      response.of_fixtures(m, f) = (direct * slanted + (all - direct) * diffuse) / all;
    }
  }
  return response;
}

Result<Scene> scene_of(const Rig& rig) {
  auto built = build_scene(rig);
  if (built) return std::move(*built);
  return tl::unexpected(Fault{Cause::invalid, "", built.error().empty() ? "scene" : built.error().front().text(), {}});
}

/// All light of the rig's emitters, and the heads' at their spread aims.
struct PathLight {
  TransportMatrix transport;
  SpreadLight spread;
};

Result<PathLight> path_light(const Rig& rig, const std::vector<FixtureTruth>& truths, const RayScene& scene,
                             const std::vector<Receiver>& receivers, double max_error, std::uint64_t seed, int threads,
                             const Watch& watch) {
  const bool any_moves =
      std::any_of(rig.fixtures.begin(), rig.fixtures.end(), [](const Fixture& fixture) { return fixture.moves; });
  EvaluateOptions options;
  options.wanted_relative_error = max_error;
  set_error_floor(rig, options);
  options.seed = seed;
  options.threads = threads;
  options.watch = part_of(watch, 0, any_moves ? 0.5 : 1);
  std::vector<Emitter> emitters = true_emitters(rig, truths);
  for (Emitter& day : daylight_emitters_of(rig)) emitters.push_back(std::move(day));
  auto transport = make_path_evaluator(scene)->evaluate(receivers, emitters, options);
  if (!transport) return tl::unexpected(transport.error());
  options.wanted_relative_error = max_error * kSpreadErrorFactor;
  options.watch = part_of(watch, 0.5, 1);
  auto spread = spread_light(rig, truths, scene, receivers, *transport, options);
  if (!spread) return tl::unexpected(spread.error());
  return PathLight{std::move(*transport), std::move(*spread)};
}

}  // namespace

namespace {

/// The world of a seed whose room is traced for it alone.
Result<std::unique_ptr<World>> traced_world(const Rig& rig, const Scene& built, const Deviations& deviations,
                                            double max_error, int threads, const Watch& watch) {
  const RayScene scene(true_scene(built, rig, deviations));
  const std::vector<FixtureTruth> truths = draw_fixtures(rig, deviations, &scene);
  const std::vector<Receiver> receivers = receivers_of(rig);
  const auto light = path_light(rig, truths, scene, receivers, max_error, deviations.seed, threads, watch);
  if (!light) return tl::unexpected(light.error());
  const auto fixtures = static_cast<Eigen::Index>(rig.fixtures.size());
  const Eigen::MatrixXd lux = light->transport.lux_per_level.leftCols(fixtures);
  return World::make(rig, deviations, lux, light_of_heads(rig, truths, scene, receivers, light->spread),
                     daylight_lux(rig, light->transport),
                     response_of(rig, deviations, true_emitters(rig, truths), lux,
                                 light->transport.direct_lux_per_level.leftCols(fixtures)),
                     truths);
}

}  // namespace

Result<std::unique_ptr<World>> World::make(const Rig& rig, const Deviations& deviations, double max_error,
                                           const Watch& watch) {
  const auto built = scene_of(rig);
  if (!built) return tl::unexpected(built.error());
  return traced_world(rig, *built, deviations, max_error, 0, watch);
}

struct WorldMaker::State {
  Rig rig;
  Scene built;
  RayScene scene;
  std::vector<Receiver> receivers;
  double max_error;
  PathLight light;  ///< of the rig file's poses
};

WorldMaker::WorldMaker(std::unique_ptr<State> state) : state_(std::move(state)) {}
WorldMaker::WorldMaker(WorldMaker&&) noexcept = default;
WorldMaker::~WorldMaker() = default;

Result<WorldMaker> WorldMaker::make(const Rig& rig, double max_error, const Watch& watch) {
  auto built = scene_of(rig);
  if (!built) return tl::unexpected(built.error());
  RayScene scene(*built);
  std::vector<Receiver> receivers = receivers_of(rig);
  auto light = path_light(rig, as_in_the_file(rig), scene, receivers, max_error, 1, 0, watch);
  if (!light) return tl::unexpected(light.error());
  return WorldMaker(std::make_unique<State>(
      State{rig, std::move(*built), std::move(scene), std::move(receivers), max_error, std::move(*light)}));
}

Result<std::unique_ptr<World>> WorldMaker::world(const Deviations& deviations) const {
  const State& s = *state_;
  if (deviations.of_the_room()) return traced_world(s.rig, s.built, deviations, s.max_error, 1, {});
  const std::vector<FixtureTruth> truths = draw_fixtures(s.rig, deviations, &s.scene);
  const std::vector<Emitter> lamps = true_emitters(s.rig, truths);
  const auto fixtures = static_cast<Eigen::Index>(s.rig.fixtures.size());
  EvaluateOptions options;
  options.wanted_relative_error = kDirectError;
  set_error_floor(s.rig, options);
  options.threads = 1;
  auto direct = make_direct_evaluator(s.scene)->evaluate(s.receivers, lamps, options);
  if (!direct) return tl::unexpected(direct.error());
  const TransportMatrix& nominal = s.light.transport;
  const Eigen::MatrixXd indirect =
      (nominal.lux_per_level - nominal.direct_lux_per_level).leftCols(fixtures).cwiseMax(0.0);
  const Eigen::MatrixXd lux = direct->direct_lux_per_level + indirect;
  return World::make(s.rig, deviations, lux, light_of_heads(s.rig, truths, s.scene, s.receivers, s.light.spread),
                     daylight_lux(s.rig, nominal),
                     response_of(s.rig, deviations, lamps, lux, direct->direct_lux_per_level), truths);
}

}  // namespace luxrig::sim
