#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <span>

#include "core/calibration/camera_instrument.h"
#include "core/calibration/lux_map.h"
#include "core/calibration/meter_run.h"
#include "core/calibration/rig_light.h"
#include "core/output/dimming.h"
#include "core/picture/rig_camera.h"
#include "core/rig/rig_file.h"
#include "core/tasks/scene_builder.h"
#include "sim/world/world.h"
#include "tools/bench/loop/loop_camera.h"
#include "tools/bench/loop/many_lamps.h"
#include "tools/bench/loop/stepped_rig.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTransportError = 0.003, kTruthError = 0.005;
/// Where the light is judged: lamps at this level as sent, or as bright as a limit lets each of them alone be.
constexpr double kLevel = 0.4;

/// A person holds a meter at places that are chosen one after the other, or at random.
struct Hand {
  enum class Where { chosen, random };
  int readings = 0;
  Where where = Where::chosen;
};

/// How a camera's pictures are taken: with its lens and each kind of lamp as unknowns, or all by one factor.
enum class Colour { by_kind, one_factor };

/// Of the rig's cameras.
enum class Cameras { none, first, all };

struct Case {
  const char* method;
  bool meters;
  Hand hand;
  Cameras cameras = Cameras::none;
  Colour colour = Colour::by_kind;
  bool known_paint = false;  ///< the truth's reflectances are those of the file
};

constexpr Case kCases[] = {
    {"as stated", false, {}},
    {"meters", true, {}},
    {"meters, 5 by hand", true, {5, Hand::Where::chosen}},
    {"meters, 5 at random", true, {5, Hand::Where::random}},
    {"8 by hand", false, {8, Hand::Where::chosen}},
    {"meters, camera", true, {}, Cameras::first},
    {"camera, 1 by hand", false, {1, Hand::Where::chosen}, Cameras::first},
    {"camera, 1 by hand, one factor", false, {1, Hand::Where::chosen}, Cameras::first, Colour::one_factor},
    {"meters, all cameras", true, {}, Cameras::all},
    {"all cameras, 3 by hand", false, {3, Hand::Where::chosen}, Cameras::all},
    {"meters, camera, known paint", true, {}, Cameras::first, Colour::by_kind, true},
    {"camera, 1 by hand, known paint", false, {1, Hand::Where::chosen}, Cameras::first, Colour::by_kind, true},
    {"meters, all cameras, known paint", true, {}, Cameras::all, Colour::by_kind, true},
};
/// Of a reflectance that was measured.
constexpr double kKnownPaint = 0.02;

/// A lamp that may not be lit has this level instead of none.
constexpr double kDimmest = 0.01;

/// Lamps are read at their level of use by hand and by camera.
LightPriors priors_of(const Rig& rig, const std::vector<double>& used) {
  LightPriors priors = usual_priors(rig);
  priors.read_at = Eigen::Map<const VectorXd>(used.data(), static_cast<Index>(used.size())).cwiseMax(kDimmest);
  return priors;
}

/// What is measured once of a simulated rig, for all cases.
struct MeasuredRig {
  MeterRun run;
  std::vector<double> used;  ///< levels of use, as sent
  VectorXd truth_lx;         ///< of all lamps at those; at the rig's points, then at the cameras' places
  MatrixXd alone_lx;         ///< points × fixtures: of each alone at its level of use
  double rig_seconds = 0;    ///< that the run took
  std::vector<Photographed> seen;  ///< per camera: each lamp at its level of use
};

std::vector<double> levels_of_use(std::vector<double> brightest) {
  for (double& level : brightest) level = std::min(kLevel, level);
  return brightest;
}

Result<MeasuredRig> measure_rig(sim::World& world, const Session& session, const sim::Deviations& deviations,
                                const std::vector<double>& brightest, const MatrixXd& stated_lux, const SeenRig& seen) {
  const Rig& rig = session.rig;
  const RayScene true_rays(sim::true_scene(session.scene, rig, deviations));
  SteppedRig bench(world, seen.session.rig);
  MeasuredRig measured{MeterRun(rig, brightest, stated_lux), levels_of_use(brightest), {}, {}, 0, {}};
  std::vector<Photographer> cameras;
  for (std::size_t k = 0; k < seen.each.size(); ++k)
    cameras.emplace_back(seen.each[k], k, session, world, true_rays, deviations);
  bench.measure(measured.run, levels_of_use(brightest));
  measured.rig_seconds = bench.seconds();
  std::vector<double> alone(rig.fixtures.size(), 0.0);
  const VectorXd dark_lx = bench.truth_lx(alone);
  measured.truth_lx = bench.truth_lx(measured.used) - dark_lx;
  for (Photographer& camera : cameras)
    if (auto looked = camera.look(); !looked) return tl::unexpected(looked.error());
  measured.alone_lx.resize(measured.truth_lx.size(), static_cast<Index>(rig.fixtures.size()));
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    alone[f] = measured.used[f];
    measured.alone_lx.col(static_cast<Index>(f)) = bench.truth_lx(alone) - dark_lx;
    for (Photographer& camera : cameras)
      if (auto taken = camera.take(f); !taken) return tl::unexpected(taken.error());
    alone[f] = 0;
  }
  for (const Photographer& camera : cameras) measured.seen.push_back(camera.taken());
  return measured;
}

/// Shares of full light at the levels of use, as far as a case knows them.
VectorXd shares_of(const Rig& rig, const MeasuredRig& measured, bool meters) {
  VectorXd share(static_cast<Index>(rig.fixtures.size()));
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
    share[static_cast<Index>(f)] =
        share_at_level(meters ? measured.run.curves()[f].of_level : MeasuredCurve{}, measured.used[f]);
  return share;
}

/// Per fixture: where the meters read its curve from, else its level of use.
VectorXd levels_read(const MeasuredRig& measured) {
  const std::vector<double>& brightest = measured.run.brightest();
  VectorXd level(static_cast<Index>(brightest.size()));
  for (std::size_t f = 0; f < brightest.size(); ++f)
    level[static_cast<Index>(f)] =
        std::max(kDimmest, measured.run.curves()[f].of_level.empty() ? measured.used[f] : brightest[f]);
  return level;
}

/// What a camera saw, for a RigLight of the rig with its places.
std::vector<LightReading> readings_of_camera(const SeenBy& by, const Photographed& seen, const CameraInstrument& camera,
                                             const VectorXd& share, Colour colour) {
  std::vector<LightReading> readings;
  for (std::size_t f = 0; f < seen.of_lamp.size(); ++f) {
    const auto j = static_cast<Index>(f);
    if (!(share[j] > 0)) continue;
    auto of_lamp = camera.readings(seen.places, seen.of_lamp[f], by.camera.width_px, by.camera.height_px,
                                   by.first_point, share[j] * VectorXd::Unit(share.size(), j));
    for (LightReading& reading : of_lamp) {
      if (colour == Colour::one_factor) {
        std::fill(reading.showing.of_lamp.begin(), reading.showing.of_lamp.end(), camera.response_to(0));
        reading.showing.factors.clear();
        reading.showing.stray.clear();
      }
      readings.push_back(std::move(reading));
    }
  }
  return readings;
}

Result<void> measure_by_hand(const Rig& rig, const MeasuredRig& measured, const Hand& hand, const VectorXd& share,
                             std::uint64_t seed, std::size_t places, RigLight& light) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double gain = std::exp(0.01 * normal(random));
  std::vector<std::size_t> held(places);
  std::iota(held.begin(), held.end(), rig.points.size());  // the cameras' places are no points to hold a meter at
  for (int k = 0; k < hand.readings; ++k) {
    std::size_t at = random() % rig.points.size();
    while (std::find(held.begin(), held.end(), at) != held.end()) at = random() % rig.points.size();
    if (hand.where == Hand::Where::chosen) {
      const auto best = light.places_to_measure(share, 1, held);
      if (best.empty()) break;
      at = best.front();
    }
    held.push_back(at);
    std::vector<LightReading> readings;
    for (const std::size_t lamp : light.lamps_to_read(at, share, measured.used)) {
      const auto j = static_cast<Index>(lamp);
      const double true_lx = measured.alone_lx(static_cast<Index>(at), j);
      LightReading reading;
      reading.receiver = at;
      reading.meter = meter_in_hand(rig);
      reading.standard_error_lx = error_in_hand_lx(true_lx);
      reading.lux = std::max(0.0, gain * true_lx + reading.standard_error_lx * normal(random));
      reading.level = share[j] * VectorXd::Unit(share.size(), j);
      readings.push_back(std::move(reading));
    }
    if (auto learnt = light.learn(readings); !learnt) return learnt;
  }
  return {};
}

/// Places with less light than this share of the brightest are left out of a map's errors: relative to their light they
/// are large, and nobody asks for them.
constexpr double kMapDim = 0.02;

struct Errors {
  std::vector<double> share;         ///< of each goal's light, over all rigs
  std::vector<double> in_errors;     ///< the same over the stated standard error
  std::vector<double> worst_of_rig;  ///< per rig
  std::vector<double> seen;          ///< as share, of goals that a camera of the case sees
  CameraBudget budget;               ///< sums of the goals' shares
  int budgets = 0;
  std::vector<double> map, map_in_errors;  ///< of the places of the lux map, by a camera: as share and in_errors

  /// cameras: of the case. seen_by_them: per point.
  void add(const Rig& rig, const VectorXd& truth_lx, const VectorXd& level, const RigLight& light,
           std::span<const CameraInstrument* const> cameras, const std::vector<bool>& seen_by_them) {
    double worst = 0;
    for (std::size_t p = 0; p < rig.points.size(); ++p) {
      if (!rig.points[p].goal_lx) continue;
      const double truth = truth_lx[static_cast<Index>(p)];
      const LightEstimate found = light.known().at(p, level);
      share.push_back(std::abs(found.lux / truth - 1));
      in_errors.push_back(std::abs(found.lux - truth) / found.standard_error_lx);
      worst = std::max(worst, share.back());
      if (seen_by_them[p]) seen.push_back(share.back());
      if (!cameras.empty()) add(budget_of(light.known().budget(p, level), cameras));
    }
    worst_of_rig.push_back(worst);
  }
  void add(const CameraBudget& shares) {
    for (const auto part :
         {&CameraBudget::lens, &CameraBudget::stray, &CameraBudget::response, &CameraBudget::reflectance,
          &CameraBudget::lamps, &CameraBudget::noise, &CameraBudget::other})
      budget.*part += shares.*part;
    ++budgets;
  }
  /// The lux map of what the camera sees.
  void add_map(const std::vector<LuxMap::Place>& places, const VectorXd& truth_lx) {
    const double dim_lx = kMapDim * truth_lx.maxCoeff();
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double truth = truth_lx[static_cast<Index>(k)];
      if (!(truth > dim_lx)) continue;
      map.push_back(std::abs(places[k].light.lux / truth - 1));
      map_in_errors.push_back(std::abs(places[k].light.lux - truth) / places[k].light.standard_error_lx);
    }
  }
  /// Of the goals' variance, on average; empty for a case without a camera.
  [[nodiscard]] std::string of_variance(double CameraBudget::*part) const {
    return budgets > 0 ? fmt::format("{:.2f}", budget.*part / budgets) : "";
  }
};

double share_within(const std::vector<double>& values, double most) {
  const auto count = std::count_if(values.begin(), values.end(), [&](double v) { return v <= most; });
  return values.empty() ? NAN : static_cast<double>(count) / static_cast<double>(values.size());
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  const auto at = std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

/// A rig as stated, for the cases without and with cameras, and for those who know its paint.
struct Stated {
  const Session& session;
  std::unique_ptr<const SeenRig> seen;  ///< stays where it is: lights of it point there
  std::vector<double> brightest, used;
  std::optional<RigLight> meters, cameras, cameras_known_paint;
  std::vector<CameraInstrument> instruments;  ///< of both the latter, per camera

  [[nodiscard]] std::size_t count(Cameras which) const {
    return which == Cameras::none ? 0 : which == Cameras::first ? 1 : instruments.size();
  }
  [[nodiscard]] std::vector<const CameraInstrument*> of(Cameras which) const {
    std::vector<const CameraInstrument*> of;
    for (std::size_t k = 0; k < count(which); ++k) of.push_back(&instruments[k]);
    return of;
  }
  /// Per point: one of these cameras sees it as a place.
  [[nodiscard]] std::vector<bool> points_seen(Cameras which) const {
    std::vector<bool> points;
    for (const Point& point : session.rig.points) {
      points.push_back(false);
      for (std::size_t k = 0; k < count(which); ++k)
        for (const SeenPlace& place : seen->each[k].places)
          if (place.position_world_m == point.position_world_m) points.back() = true;
    }
    return points;
  }

  [[nodiscard]] static Result<Stated> of(const Session& session, const ComputeOptions& compute) {
    const auto traced = compute_transport(session, compute);
    if (!traced) return tl::unexpected(traced.error());
    auto seen = see(session);
    if (!seen) return tl::unexpected(seen.error());
    Stated stated{session, std::make_unique<const SeenRig>(std::move(*seen)), {}, {}, {}, {}, {}, {}};
    const auto fixtures = static_cast<Index>(session.rig.fixtures.size());
    stated.brightest = brightest_levels(session.rig, traced->lux_per_level.leftCols(fixtures));
    stated.used = levels_of_use(stated.brightest);
    auto light = RigLight::of(session, priors_of(session.rig, stated.used), compute);
    if (!light) return tl::unexpected(light.error());
    stated.meters = std::move(*light);
    LightPriors priors = priors_of(session.rig, stated.used);
    for (std::size_t k = 0; k < stated.seen->each.size(); ++k)
      stated.instruments.emplace_back(session.rig, session.scene.materials.size(), priors);
    auto with_cameras = RigLight::of(stated.seen->session, priors, compute);
    if (!with_cameras) return tl::unexpected(with_cameras.error());
    priors.reflectance = kKnownPaint;
    auto known_paint = with_cameras->with_priors(priors);
    if (!known_paint) return tl::unexpected(known_paint.error());
    stated.cameras = std::move(*with_cameras);
    stated.cameras_known_paint = std::move(*known_paint);
    return stated;
  }
};

/// What a case knows of a rig after all its readings, and the levels that it takes its lamps to be at.
struct Learnt {
  RigLight light;
  VectorXd share;
};

Result<Learnt> learn_case(const Stated& stated, const Case& how, const MeasuredRig& measured, std::uint64_t seed) {
  const Rig& rig = stated.session.rig;
  const bool by_camera = how.cameras != Cameras::none;
  Learnt learnt{*(how.known_paint ? stated.cameras_known_paint
                  : by_camera     ? stated.cameras
                                  : stated.meters),
                shares_of(rig, measured, how.meters)};
  std::vector<LightReading> readings;
  if (how.meters) {
    readings = measured.run.readings();
    learnt.light.read_at(levels_read(measured));
  }
  if (by_camera)
    for (LightReading& reading : readings) reading.receiver += stated.seen->places;
  for (std::size_t k = 0; k < stated.count(how.cameras); ++k) {
    const auto of_camera =
        readings_of_camera(stated.seen->each[k], measured.seen[k], stated.instruments[k], learnt.share, how.colour);
    readings.insert(readings.end(), of_camera.begin(), of_camera.end());
  }
  if (!readings.empty())
    if (auto done = learnt.light.learn(readings); !done) return tl::unexpected(done.error());
  if (auto done = measure_by_hand(rig, measured, how.hand, learnt.share, seed, by_camera ? stated.seen->places : 0,
                                  learnt.light);
      !done)
    return tl::unexpected(done.error());
  return learnt;
}

}  // namespace

std::vector<BenchRow> bench_loop(const BenchOptions& options) {
  if (options.only == kManyLamps) return many_lamps(options);
  const auto rig_file = options.rigs.empty() ? std::filesystem::path("rigs/gallery/rig.toml") : options.rigs.front();
  auto rig = load_rig(rig_file);
  if (!rig) {
    for (const Problem& problem : rig.error()) std::fprintf(stderr, "%s\n", problem.text().c_str());
    return {};
  }
  const auto session = session_of(std::move(*rig));
  if (!session) {
    for (const Problem& problem : session.error()) std::fprintf(stderr, "%s\n", problem.text().c_str());
    return {};
  }
  const auto failed = [](const std::string& why) {
    std::fprintf(stderr, "%s\n", why.c_str());
    return std::vector<BenchRow>{};
  };
  ComputeOptions compute;
  compute.max_error = kTransportError;
  compute.threads = options.threads;
  const auto stated = Stated::of(*session, compute);
  if (!stated) return failed(stated.error().detail);
  std::fprintf(stderr, "%zu cameras see %zu places\n", stated->seen->each.size(), stated->seen->places);

  std::vector<Errors> errors(std::size(kCases));
  std::vector<double> seconds(std::size(kCases), 0.0), stated_off_px, off_px;
  double rig_seconds = 0;
  int cameras_refused = 0;
  const int seeds = options.seeds.value_or(options.quick ? 2 : 20);
  for (int s = 0; s < seeds; ++s) {
    for (const bool known_paint : {false, true}) {
      std::fprintf(stderr, "\rrig %d of %d ", s + 1, seeds);
      sim::Deviations real = sim::Deviations::real();
      real.seed = static_cast<std::uint64_t>(options.first_seed + s);
      if (known_paint) real.reflectance_spread = 0;
      auto world = sim::World::make(stated->seen->session.rig, real, kTruthError);
      if (!world) return failed(world.error().detail);
      const auto measured = measure_rig(**world, *session, real, stated->brightest, stated->meters->stated_lux(), *stated->seen);
      if (!measured) return failed(measured.error().detail);
      rig_seconds = measured->rig_seconds;
      for (const Photographed& seen : measured->seen) {
        stated_off_px.push_back(seen.stated_off_px.value_or(NAN));
        if (seen.off_px) off_px.push_back(*seen.off_px);
        cameras_refused += seen.refused.empty() ? 0 : 1;
      }
      for (std::size_t c = 0; c < std::size(kCases); ++c) {
        if (kCases[c].known_paint != known_paint) continue;
        const auto started = std::chrono::steady_clock::now();
        const auto learnt = learn_case(*stated, kCases[c], *measured, real.seed);
        if (!learnt) return failed(learnt.error().detail);
        seconds[c] += std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() / seeds;
        errors[c].add(session->rig, measured->truth_lx, learnt->share, learnt->light, stated->of(kCases[c].cameras),
                      stated->points_seen(kCases[c].cameras));
        // The levels are those that the lamps were read at, so no dimmer adds to the error.
        const LampShares shares{learnt->share, VectorXd::Zero(learnt->share.size())};
        for (std::size_t k = 0; k < stated->count(kCases[c].cameras); ++k) {
          const SeenBy& by = stated->seen->each[k];
          errors[c].add_map(
              map_places(session->rig, learnt->light, view_of(by.camera), by.places, by.first_point, shares),
              measured->truth_lx.segment(static_cast<Index>(by.first_point), static_cast<Index>(by.places.size())));
        }
      }
    }
  }
  std::fprintf(stderr, "\n");
  std::vector<BenchRow> rows;
  for (std::size_t c = 0; c < std::size(kCases); ++c) {
    const bool by_camera = kCases[c].cameras != Cameras::none;
    BenchRow row;
    row.case_name = session->rig.name + ", real";
    row.method = kCases[c].method;
    row.error = percentile(errors[c].share, 0.95);
    row.seconds = seconds[c];
    if (kCases[c].meters || kCases[c].hand.readings > 0) row.target_error = 0.05;
    row.further = {
        {"median", fmt::format("{:.3f}", percentile(errors[c].share, 0.5))},
        {"within_5", fmt::format("{:.3f}", share_within(errors[c].share, 0.05))},
        {"worst", fmt::format("{:.3f}", percentile(errors[c].worst_of_rig, 1))},
        {"rigs_within_8", fmt::format("{:.2f}", share_within(errors[c].worst_of_rig, 0.08))},
        {"rig_seconds", kCases[c].meters ? fmt::format("{:.0f}", rig_seconds) : ""},
        {"in_2_errors", fmt::format("{:.3f}", share_within(errors[c].in_errors, 2))},
        {"seen_95", by_camera ? fmt::format("{:.3f}", percentile(errors[c].seen, 0.95)) : ""},
        {"seen_within_5", by_camera ? fmt::format("{:.3f}", share_within(errors[c].seen, 0.05)) : ""},
        {"camera_px", by_camera ? fmt::format("{:.2f}", percentile(off_px, 0.5)) : ""},
        {"stated_px", by_camera ? fmt::format("{:.2f}", percentile(stated_off_px, 0.5)) : ""},
        {"not_found", by_camera ? fmt::format("{}", cameras_refused) : ""},
        {"map_in_2_errors", by_camera ? fmt::format("{:.3f}", share_within(errors[c].map_in_errors, 2)) : ""},
        {"map_95", by_camera ? fmt::format("{:.3f}", percentile(errors[c].map, 0.95)) : ""},
        {"of_lens", errors[c].of_variance(&CameraBudget::lens)},
        {"of_stray", errors[c].of_variance(&CameraBudget::stray)},
        {"of_response", errors[c].of_variance(&CameraBudget::response)},
        {"of_reflectance", errors[c].of_variance(&CameraBudget::reflectance)},
        {"of_lamps", errors[c].of_variance(&CameraBudget::lamps)},
        {"of_noise", errors[c].of_variance(&CameraBudget::noise)}};
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace luxrig
