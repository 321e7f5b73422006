#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <optional>
#include <random>
#include <span>

#include "core/calibration/meter_run.h"
#include "core/calibration/meter_timing.h"
#include "core/calibration/rig_light.h"
#include "core/calibration/seen_places.h"
#include "core/output/dimming.h"
#include "core/rig/rig_file.h"
#include "core/tasks/scene_builder.h"
#include "sim/devices/camera.h"
#include "sim/world/world.h"
#include "tools/bench/suites.h"
#include "tools/luxrig/room_view.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTransportError = 0.003, kTruthError = 0.005;
constexpr double kSamplePeriod_s = 0.2;
/// Lamps have arrived after this; what the daemon's own fade would take.
constexpr double kRamp_s = 0.2, kDark_s = 1;
/// Longer than the slowest meter's delay and the lamps' ramps.
constexpr double kSettle_s = 4;
/// Where the light is judged: lamps at this level as sent, or as bright as a limit lets each of them alone be.
constexpr double kLevel = 0.4;

/// A simulated rig that is told levels and asked for readings.
class Bench {
 public:
  Bench(sim::World& world, const Rig& rig) : world_(world), rig_(rig), now_(world.now()) {}

  /// Readings of all luxmeters under one light after the other; per step.
  std::vector<std::vector<std::optional<SteadyReading>>> read(std::span<const LampStep> plan,
                                                              std::span<const double> together) {
    const std::vector<std::optional<MeterTiming>> timing = learn_timing(together);
    const double dwell = dwell_s(timing);
    for (auto& samples : samples_) samples.clear();
    ReadingLog log(timing);
    for (const LampStep& step : plan) {
      send(levels_of(step, rig_));
      watch(kRamp_s);
      const double arrived_s = seconds();
      watch(dwell);
      log.light(arrived_s, seconds());
    }
    watch(log.whole_at_s() - seconds());
    for (std::size_t m = 0; m < samples_.size(); ++m)
      for (const TimedLux& sample : samples_[m]) log.sample(m, sample);
    return log.readings();
  }
  /// True light at the points.
  VectorXd truth_lx(std::span<const double> level) {
    set(level);
    const auto points = world_.points();
    VectorXd lux(static_cast<Index>(rig_.points.size()));
    for (Index p = 0; p < lux.size(); ++p) lux[p] = points[static_cast<std::size_t>(p)].lux;
    return lux;
  }
  [[nodiscard]] double seconds() const { return to_seconds(now_.time_since_epoch()); }

 private:
  void pass(double seconds) {
    now_ += from_seconds(seconds);
    world_.advance(now_);
  }
  void send(std::span<const double> level) {
    for (std::size_t f = 0; f < level.size(); ++f) world_.set_drive(f, drive_for(rig_.fixtures[f], level[f]));
  }
  void set(std::span<const double> level) {
    send(level);
    pass(kSettle_s);
  }
  /// Samples all meters meanwhile.
  void watch(double duration_s) {
    for (const double end_s = seconds() + duration_s; seconds() < end_s;) {
      pass(kSamplePeriod_s);
      for (std::size_t m = 0; m < samples_.size(); ++m) samples_[m].push_back({seconds(), world_.meter_reading_lx(m)});
    }
  }
  std::vector<std::optional<MeterTiming>> learn_timing(std::span<const double> together) {
    set(std::vector<double>(together.size(), 0.0));
    watch(kDark_s);
    const double begun_s = seconds();
    send(together);
    watch(kRamp_s);
    const double arrived_s = seconds();
    watch(kSettle_s);
    std::vector<std::optional<MeterTiming>> timing;
    for (const auto& samples : samples_) timing.push_back(timing_of(samples, begun_s, arrived_s));
    return timing;
  }

  sim::World& world_;
  const Rig& rig_;
  Time now_;
  std::vector<std::vector<TimedLux>> samples_{rig_.luxmeters.size()};  ///< per luxmeter
};

/// A person holds a meter at places that are chosen one after the other, or at random.
struct Hand {
  enum class Where { chosen, random };
  int readings = 0;
  Where where = Where::chosen;
};

struct Case {
  const char* method;
  bool meters;
  Hand hand;
  bool camera = false;
};

constexpr Case kCases[] = {
    {"as stated", false, {}},
    {"meters", true, {}},
    {"meters, 5 by hand", true, {5, Hand::Where::chosen}},
    {"meters, 5 at random", true, {5, Hand::Where::random}},
    {"8 by hand", false, {8, Hand::Where::chosen}},
    {"meters, camera", true, {}, true},
    {"camera, 1 by hand", false, {1, Hand::Where::chosen}, true},
};

/// What one camera sees of the rig.
struct SeenRig {
  PictureCamera camera;
  std::vector<SeenPlace> places;
  Session session;  ///< of the rig with a point at each place
};

constexpr int kPlaces = 120, kWidth_px = 640, kHeight_px = 400;
constexpr int kPasses = 12;  // 25 pixels of a place: 300 samples
constexpr double kBracket = 16, kFull = 0.95;
constexpr double kFieldOfView_rad = 1.2;
/// Of the factor between a picture and light, per material: paint, and the camera's scale.
constexpr double kLogCamera = 0.2;
/// Of a place's light by the camera, beside its noise: lens, and paint that is not the same all over.
constexpr double kCameraError = 0.015, kDarkest_lx = 0.05;
/// A place says nothing of a lamp that gives it less than this of its brightest.
constexpr double kSeen = 0.02;

Result<SeenRig> see(const Session& session) {
  SeenRig seen;
  std::vector<Joints> joints;
  for (const Fixture& fixture : session.rig.fixtures) joints.push_back(fixture.joints);
  const Camera view = automatic_camera(*session.rays, session.rig, joints, kWidth_px, kHeight_px, kFieldOfView_rad);
  seen.camera.name = "bench";
  seen.camera.position_world_m = view.eye_world_m;
  seen.camera.aim_world_m = view.target_world_m;
  seen.camera.vertical_fov_rad = view.vertical_fov_rad;
  seen.camera.width_px = view.width_px;
  seen.camera.height_px = view.height_px;
  seen.places = seen_places(*session.rays, view, kPlaces);
  auto with = session_of(with_places(session.rig, seen.places));
  if (!with) return tl::unexpected(Fault{Cause::invalid, "", with.error().front().text(), {}});
  seen.session = std::move(*with);
  return seen;
}

/// A lamp that may not be lit has this level instead of none.
constexpr double kDimmest = 0.01;

/// Lamps are read at their level of use by hand and by camera.
LightPriors priors_of(const Rig& rig, const std::vector<double>& used) {
  LightPriors priors = usual_priors(rig);
  priors.read_at = Eigen::Map<const VectorXd>(used.data(), static_cast<Index>(used.size())).cwiseMax(kDimmest);
  return priors;
}

LightPriors priors_with_camera(const Session& session, const std::vector<double>& used) {
  LightPriors priors = priors_of(session.rig, used);
  const Index instruments = priors.log_meter.size(), materials = static_cast<Index>(session.scene.materials.size());
  priors.log_meter.conservativeResize(instruments + materials);
  priors.log_meter.tail(materials).setConstant(kLogCamera);
  return priors;
}

/// What is measured once of a simulated rig, for all cases.
struct MeasuredRig {
  MeterRun run;
  std::vector<double> used;                  ///< levels of use, as sent
  VectorXd truth_lx;                         ///< of all lamps at those
  MatrixXd alone_lx;                         ///< points × fixtures: of each alone at its level of use
  double rig_seconds = 0;                    ///< that the run took
  std::vector<std::vector<SeenLight>> seen;  ///< per fixture at its level of use: of each place
};

std::vector<double> levels_of_use(std::vector<double> brightest) {
  for (double& level : brightest) level = std::min(kLevel, level);
  return brightest;
}

Result<MeasuredRig> measure_rig(sim::World& world, const Session& session, const sim::Deviations& deviations,
                                const std::vector<double>& brightest, const MatrixXd& stated_lux, const SeenRig& seen) {
  const Rig& rig = session.rig;
  const RayScene true_rays(sim::true_scene(session.scene, rig, deviations));
  Bench bench(world, rig);
  MeasuredRig measured{MeterRun(rig, brightest, stated_lux), levels_of_use(brightest), {}, {}, 0, {}};
  const auto read = bench.read(measured.run.plan(), levels_of_use(brightest));
  for (std::size_t k = 0; k < read.size(); ++k) measured.run.take(measured.run.plan()[k].level, read[k]);
  measured.rig_seconds = bench.seconds();
  std::vector<double> alone(rig.fixtures.size(), 0.0);
  const VectorXd dark_lx = bench.truth_lx(alone);
  measured.truth_lx = bench.truth_lx(measured.used) - dark_lx;
  measured.alone_lx.resize(measured.truth_lx.size(), static_cast<Index>(rig.fixtures.size()));
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    alone[f] = measured.used[f];
    measured.alone_lx.col(static_cast<Index>(f)) = bench.truth_lx(alone) - dark_lx;
    sim::Shot shot;
    shot.seed = deviations.seed;
    shot.number = f;
    shot.passes = kPasses;
    const auto light = sim::light_on_sensor(true_rays, rig, world.fixtures(), {world.levels(), world.joints()},
                                            sim::draw_camera(rig, seen.camera, 0, sim::Deviations::none()), shot);
    if (!light) return tl::unexpected(light.error());
    const Picture picture = sim::exposed(*light, sim::Sensor{}, shot);
    // Bracketed: where this exposure is full, the shorter one.
    shot.underexposed = kBracket;
    const Picture shorter = sim::exposed(*light, sim::Sensor{}, shot);
    float full = 0;
    for (const Vec3f& pixel : picture.luminance_cd_m2) full = std::max(full, pixel.maxCoeff());
    Picture merged = picture;
    for (std::size_t i = 0; i < merged.luminance_cd_m2.size(); ++i)
      if (merged.luminance_cd_m2[i].maxCoeff() > kFull * full) merged.luminance_cd_m2[i] = shorter.luminance_cd_m2[i];
    Picture dark = picture;
    for (Vec3f& pixel : dark.luminance_cd_m2) pixel.setZero();
    measured.seen.emplace_back();
    for (const SeenPlace& place : seen.places) measured.seen.back().push_back(seen_light(merged, dark, place));
    alone[f] = 0;
  }
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
VectorXd levels_read(const MeasuredRig& measured, const std::vector<double>& brightest) {
  VectorXd level(static_cast<Index>(brightest.size()));
  for (std::size_t f = 0; f < brightest.size(); ++f)
    level[static_cast<Index>(f)] =
        std::max(kDimmest, measured.run.curves()[f].of_level.empty() ? measured.used[f] : brightest[f]);
  return level;
}

/// What the camera saw, for a RigLight of the rig with its places.
std::vector<LightReading> readings_of_camera(const Rig& rig, const MeasuredRig& measured, const SeenRig& seen,
                                             const VectorXd& share) {
  std::vector<LightReading> readings;
  for (std::size_t f = 0; f < measured.seen.size(); ++f) {
    const double level = share[static_cast<Index>(f)];
    if (!(level > 0)) continue;
    double brightest = 0;
    for (const SeenLight& light : measured.seen[f]) brightest = std::max(brightest, light.lux);
    for (std::size_t k = 0; k < seen.places.size(); ++k) {
      const SeenLight& light = measured.seen[f][k];
      if (light.lux < kSeen * brightest) continue;
      LightReading reading;
      reading.receiver = rig.points.size() + k;
      reading.meter = meter_in_hand(rig) + 1 + seen.places[k].material;
      reading.lux = light.lux;
      reading.standard_error_lx = std::hypot(light.standard_error_lx, kCameraError * light.lux, kDarkest_lx);
      reading.level = level * VectorXd::Unit(share.size(), static_cast<Index>(f));
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
  std::iota(held.begin(), held.end(), rig.points.size());  // the camera's places are no points to hold a meter at
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

struct Errors {
  std::vector<double> share;         ///< of each goal's light, over all rigs
  std::vector<double> in_errors;     ///< the same over the stated standard error
  std::vector<double> worst_of_rig;  ///< per rig

  void add(const Rig& rig, const VectorXd& truth_lx, const VectorXd& level, const RigLight& light) {
    double worst = 0;
    for (std::size_t p = 0; p < rig.points.size(); ++p) {
      if (!rig.points[p].goal_lx) continue;
      const double truth = truth_lx[static_cast<Index>(p)];
      const LightEstimate found = light.known().at(p, level);
      share.push_back(std::abs(found.lux / truth - 1));
      in_errors.push_back(std::abs(found.lux - truth) / found.standard_error_lx);
      worst = std::max(worst, share.back());
    }
    worst_of_rig.push_back(worst);
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

}  // namespace

std::vector<BenchRow> bench_loop(const BenchOptions& options) {
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
  const auto traced = compute_transport(*session, compute);
  if (!traced) return failed(traced.error().detail);
  const std::vector<double> brightest =
      brightest_levels(session->rig, traced->lux_per_level.leftCols(static_cast<Index>(session->rig.fixtures.size())));
  const std::vector<double> used = levels_of_use(brightest);
  const auto stated = RigLight::of(*session, priors_of(session->rig, used), compute);
  if (!stated) return failed(stated.error().detail);
  const auto seen = see(*session);
  if (!seen) return failed(seen.error().detail);
  const auto stated_seen = RigLight::of(seen->session, priors_with_camera(seen->session, used), compute);
  if (!stated_seen) return failed(stated_seen.error().detail);
  std::fprintf(stderr, "the camera sees %zu places\n", seen->places.size());

  std::vector<Errors> errors(std::size(kCases));
  std::vector<double> seconds(std::size(kCases), 0.0);
  double rig_seconds = 0;
  const int seeds = options.seeds.value_or(options.quick ? 2 : 20);
  for (int s = 0; s < seeds; ++s) {
    std::fprintf(stderr, "\rrig %d of %d ", s + 1, seeds);
    sim::Deviations real = sim::Deviations::real();
    real.seed = static_cast<std::uint64_t>(options.first_seed + s);
    auto world = sim::World::make(session->rig, real, kTruthError);
    if (!world) return failed(world.error().detail);
    const auto taken = measure_rig(**world, *session, real, brightest, stated->stated_lux(), *seen);
    if (!taken) return failed(taken.error().detail);
    const MeasuredRig& measured = *taken;
    rig_seconds = measured.rig_seconds;
    for (std::size_t c = 0; c < std::size(kCases); ++c) {
      const auto started = std::chrono::steady_clock::now();
      RigLight light = kCases[c].camera ? *stated_seen : *stated;
      const VectorXd share = shares_of(session->rig, measured, kCases[c].meters);
      std::vector<LightReading> readings;
      if (kCases[c].meters) {
        readings = measured.run.readings();
        light.read_at(levels_read(measured, brightest));
      }
      if (kCases[c].camera) {
        for (LightReading& reading : readings) reading.receiver += seen->places.size();
        const auto of_camera = readings_of_camera(session->rig, measured, *seen, share);
        readings.insert(readings.end(), of_camera.begin(), of_camera.end());
      }
      if (!readings.empty())
        if (auto learnt = light.learn(readings); !learnt) return failed(learnt.error().detail);
      if (auto learnt = measure_by_hand(session->rig, measured, kCases[c].hand, share, real.seed,
                                        kCases[c].camera ? seen->places.size() : 0, light);
          !learnt)
        return failed(learnt.error().detail);
      seconds[c] += std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() / seeds;
      errors[c].add(session->rig, measured.truth_lx, share, light);
    }
  }
  std::fprintf(stderr, "\n");
  std::vector<BenchRow> rows;
  for (std::size_t c = 0; c < std::size(kCases); ++c) {
    BenchRow row;
    row.case_name = session->rig.name + ", real";
    row.method = kCases[c].method;
    row.error = percentile(errors[c].share, 0.95);
    row.seconds = seconds[c];
    if (kCases[c].meters || kCases[c].hand.readings > 0) row.target_error = 0.05;
    row.further = {{"median", fmt::format("{:.3f}", percentile(errors[c].share, 0.5))},
                   {"within_5", fmt::format("{:.3f}", share_within(errors[c].share, 0.05))},
                   {"worst", fmt::format("{:.3f}", percentile(errors[c].worst_of_rig, 1))},
                   {"rigs_within_8", fmt::format("{:.2f}", share_within(errors[c].worst_of_rig, 0.08))},
                   {"rig_seconds", kCases[c].meters ? fmt::format("{:.0f}", rig_seconds) : ""},
                   {"in_2_errors", fmt::format("{:.3f}", share_within(errors[c].in_errors, 2))}};
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace luxrig
