#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <string_view>

#include "core/calibration/head_meter_run.h"
#include "core/calibration/head_run.h"
#include "core/output/head_travel.h"
#include "sim/devices/head.h"
#include "sim/world/deviations.h"
#include "tools/bench/heads/head_pictures.h"
#include "tools/bench/heads/head_rig.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

constexpr double kStep_s = 0.01;
/// Until a lamp is at its light, or dark; a picture's exposure.
constexpr double kLampSettles_s = 0.25, kExposure_s = 0.1;
constexpr int kJudgedAims = 200;
constexpr double kSilentlyWrong_rad = rad_from_deg(0.3);
constexpr double kTarget_deg = 0.1, kTargetByMeters_deg = 0.5;
/// A light stays so long that a sample of each luxmeter is of it; how late they are is waited for once (ReadingLog).
constexpr double kMeterDwell_s = 0.4;
/// Within it a direction, which has two axes, lies as often as one axis within two standard errors.
constexpr double kTwoErrors = 2.486;

struct HeadCase {
  const char* name;
  bool bad;           ///< with heads that hang or turn the wrong way, and lines that are swapped
  double camera_rad;  ///< how far the camera is turned off its stated pose
  bool by_meters = false;
};
constexpr HeadCase kHeadCases[] = {{"real", false, 0},
                                   {"bad", true, 0},
                                   {"real, camera 1° off", false, rad_from_deg(1)},
                                   {"meters", false, 0, true},
                                   {"meters, bad", true, 0, true}};
constexpr double kCameraKnown_rad = rad_from_deg(0.01);

/// One simulated rig.
struct SimulatedRig {
  HeadRig stated;
  RayScene rays, true_rays;
  std::vector<sim::FixtureTruth> truths;
  SeenSurface surface;
  std::unique_ptr<HeadPictures> pictures;
};

std::unique_ptr<SimulatedRig> simulate(std::uint64_t seed, const HeadCase& of, int threads) {
  HeadRig stated = head_rig(seed);
  sim::Deviations deviations = of.bad ? sim::Deviations::bad() : sim::Deviations::real();
  deviations.seed = seed;
  RayScene rays(stated.scene), true_rays(sim::true_scene(stated.scene, stated.rig, deviations));
  std::vector<sim::FixtureTruth> truths = sim::draw_fixtures(stated.rig, deviations, &rays);
  std::mt19937_64 random(seed ^ 0xca3e5a);
  std::normal_distribution<double> normal;
  const Vec3 about = Vec3(normal(random), normal(random), normal(random)).normalized();
  const Mat3 turn = Eigen::AngleAxisd(of.camera_rad, about).toRotationMatrix();
  SeenSurface surface = seen_surface(rays, stated.camera, threads);
  const Camera camera = stated.camera;
  auto rig = std::make_unique<SimulatedRig>(SimulatedRig{std::move(stated), std::move(rays), std::move(true_rays),
                                                         std::move(truths), std::move(surface), nullptr});
  rig->pictures = std::make_unique<HeadPictures>(rig->true_rays, camera, turn, seed);
  return rig;
}

struct JudgedHead {
  HeadResult result;
  double rig_seconds = 0, seconds = 0;
  std::vector<double> off_rad;    ///< over the judged aims
  std::vector<double> in_errors;  ///< the same over the stated standard error of an axis
  double rms_rad = 0;
};

/// The head that a fixture's line reaches.
std::size_t head_on_line(const SimulatedRig& rig, std::size_t line) {
  for (std::size_t f = 0; f < rig.truths.size(); ++f)
    if (rig.truths[f].line == line) return f;
  return line;
}

/// Returns the time that is waited. at: where it was sent last.
double turn(sim::Head& head, const Fixture& fixture, std::optional<Joints>& at, const Joints& to) {
  head.set_target(to);
  const double wait_s = stands_still_s(fixture, at, to);
  for (double way_s = 0; way_s < wait_s; way_s += kStep_s) head.step(kStep_s);
  at = to;
  return wait_s;
}

JudgedHead run_head(SimulatedRig& rig, std::size_t h, const HeadPriors& priors) {
  const Fixture& fixture = rig.stated.rig.fixtures[h];
  const std::size_t moves = head_on_line(rig, h);
  const sim::FixtureTruth& truth = rig.truths[moves];
  const Luminaire& luminaire = rig.stated.rig.luminaires[rig.stated.rig.fixtures[moves].luminaire];
  JudgedHead judged;
  const HeadSetup setup = head_setup(rig.stated.rig, h, priors);
  const auto started = std::chrono::steady_clock::now();
  double picture_seconds = 0;
  HeadRun run(rig.surface, rig.rays, setup);
  sim::Head head(rig.stated.rig.fixtures[moves], truth.head);
  std::optional<Joints> at;
  while (const auto step = run.next()) {
    const double way_s = turn(head, fixture, at, step->joints);
    judged.rig_seconds +=
        step->lit ? way_s + kLampSettles_s + kExposure_s : std::max(way_s, kLampSettles_s + kExposure_s);
    std::optional<HeadPictures::Beam> beam;
    if (step->lit)
      beam = HeadPictures::Beam{sim::true_lamp(truth, head.joints(), fixture.roll_rad), luminaire.intensity.get()};
    const auto taking = std::chrono::steady_clock::now();
    const Picture picture = rig.pictures->take(beam);
    picture_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - taking).count();
    run.take(picture);
  }
  judged.result = run.result();
  judged.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() - picture_seconds;
  return judged;
}

/// Luxmeters as the deviations have them, each with its own delay.
class HeadMeters {
 public:
  HeadMeters(const SimulatedRig& rig, std::uint64_t seed) : rig_(rig), random_(seed ^ 0x6e7e5) {
    std::uniform_real_distribution<double> unit;
    for (const Luxmeter& meter : rig.stated.rig.luxmeters) {
      stated_.push_back({meter.position_world_m, meter.normal_world, kMeterNoise});
      gain_.push_back(1 + meter.tolerance * (2 * unit(random_) - 1));
      delay_s_ = std::max(delay_s_, kFastestMeter_s + (kSlowestMeter_s - kFastestMeter_s) * unit(random_));
    }
  }
  [[nodiscard]] const std::vector<HeadMeter>& stated() const { return stated_; }
  [[nodiscard]] double delay_s() const { return delay_s_; }

  /// Direct light, what the room throws back once where the beam falls, and the room's own.
  std::vector<double> read(const std::optional<HeadPictures::Beam>& beam) {
    std::normal_distribution<double> normal;
    std::vector<std::pair<Hit, double>> lit;  // with the flux that leaves there
    for (int k = 0; beam && k < kBeamRays; ++k) {
      const DirectionSample ray = beam->intensity->sample(unit_(random_), unit_(random_));
      if (!(ray.density_per_sr > 0)) continue;
      const auto hit = rig_.true_rays.nearest(beam->world_from_lamp.translation_m,
                                              beam->world_from_lamp.direction(ray.direction), Vec3::Zero());
      if (!hit) continue;
      lit.emplace_back(*hit, beam->intensity->intensity_cd(ray.direction) / ray.density_per_sr / kBeamRays *
                                 rig_.true_rays.material_of(hit->triangle).luminous_reflectance());
    }
    std::vector<double> lux;
    for (std::size_t m = 0; m < stated_.size(); ++m) {
      double light = kRoomLight_lx;
      if (beam) light += direct_lx(stated_[m], *beam);
      for (const auto& [place, flux_lm] : lit) {
        const Vec3 to_m = stated_[m].position_world_m - place.position_world_m;
        const double leaves = to_m.normalized().dot(place.normal_world),
                     arrives = -to_m.normalized().dot(stated_[m].normal_world);
        if (leaves > 0 && arrives > 0 &&
            !rig_.true_rays.occluded(stated_[m].position_world_m, stated_[m].normal_world, place.position_world_m))
          light += flux_lm / kPi * leaves * arrives / std::max(to_m.squaredNorm(), kNearestPlace_m2);
      }
      lux.push_back(gain_[m] * light * (1 + kMeterNoise * normal(random_)));
    }
    return lux;
  }

 private:
  static constexpr double kRoomLight_lx = 20, kMeterNoise = 0.02, kFastestMeter_s = 0.1, kSlowestMeter_s = 2;
  static constexpr int kBeamRays = 200;
  static constexpr double kNearestPlace_m2 = 0.01;
  [[nodiscard]] double direct_lx(const HeadMeter& meter, const HeadPictures::Beam& beam) const {
    const Vec3 to_m = meter.position_world_m - beam.world_from_lamp.translation_m;
    const double cosine = -to_m.normalized().dot(meter.normal_world);
    if (!(cosine > 0) ||
        rig_.true_rays.occluded(meter.position_world_m, meter.normal_world, beam.world_from_lamp.translation_m))
      return 0;
    const Vec3 in_lamp = beam.world_from_lamp.inverse_direction(to_m.normalized());
    return beam.intensity->intensity_cd(in_lamp) * cosine / to_m.squaredNorm();
  }

  const SimulatedRig& rig_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> unit_;
  std::vector<HeadMeter> stated_;
  std::vector<double> gain_;
  double delay_s_ = 0;
};

JudgedHead run_head_by_meters(const SimulatedRig& rig, std::size_t h, const HeadPriors& priors, HeadMeters& meters) {
  const Fixture& fixture = rig.stated.rig.fixtures[h];
  const std::size_t moves = head_on_line(rig, h);
  const sim::FixtureTruth& truth = rig.truths[moves];
  JudgedHead judged;
  const HeadSetup setup = head_setup(rig.stated.rig, h, priors);
  const auto started = std::chrono::steady_clock::now();
  HeadMeterRun run(meters.stated(), *rig.stated.rig.luminaires[fixture.luminaire].intensity, rig.rays, setup);
  sim::Head head(rig.stated.rig.fixtures[moves], truth.head);
  std::optional<Joints> at;
  while (!run.next().empty()) {
    std::vector<std::vector<double>> read;
    for (const HeadMeterRun::Step& step : run.next()) {
      judged.rig_seconds += turn(head, fixture, at, step.joints);
      if (!step.read) continue;
      judged.rig_seconds += kMeterDwell_s;
      std::optional<HeadPictures::Beam> beam;
      if (step.lit)
        beam = HeadPictures::Beam{sim::true_lamp(truth, head.joints(), fixture.roll_rad),
                                  rig.stated.rig.luminaires[rig.stated.rig.fixtures[moves].luminaire].intensity.get()};
      read.push_back(meters.read(beam));
    }
    judged.rig_seconds += kLampSettles_s + meters.delay_s();
    run.take(read);
  }
  judged.result = run.result();
  judged.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return judged;
}

/// Sent to places in the room by what was found, how far off them does it truly shine?
void judge(const SimulatedRig& rig, std::size_t h, std::uint64_t seed, JudgedHead& judged) {
  const Fixture& fixture = rig.stated.rig.fixtures[h];
  const sim::FixtureTruth& truth = rig.truths[head_on_line(rig, h)];
  const HeadFit& fit = judged.result.fit;
  std::mt19937_64 random(seed * 8 + h);
  for (int k = 0; k < 20 * kJudgedAims && judged.off_rad.size() < kJudgedAims; ++k) {
    const SurfacePixel& pixel = rig.surface.pixels[random() % rig.surface.pixels.size()];
    if (!pixel.seen()) continue;
    const Vec3 place_m = rig.surface.position_world_m(pixel);
    const Vec3 to_m = place_m - fit.pose.pivot_world_m();
    if (to_m.norm() < 0.5) continue;
    const Approach from{random() % 2 ? 1 : -1, random() % 2 ? 1 : -1};
    const auto sent = fit.pose.joints_towards(to_m, from, with_run_up(fixture.range), {});
    if (!sent) continue;
    sim::Head head(fixture, truth.head);
    for (const double run_up_rad : {kRunUp_rad, 0.0}) {
      head.set_target({sent->pan_rad - from.pan * run_up_rad, sent->tilt_rad - from.tilt * run_up_rad, 0});
      for (int step = 0; step < 4; ++step) head.step(1);
    }
    const Pose lamp = sim::true_lamp(truth, head.joints(), fixture.roll_rad);
    const Vec3 beam = lamp.direction(-Vec3::UnitZ()), wanted = (place_m - lamp.translation_m).normalized();
    judged.off_rad.push_back(std::atan2(beam.cross(wanted).norm(), beam.dot(wanted)));
    const HeadSighting as_sighting{*sent, from, rig.surface.camera.eye_world_m, place_m, pixel.normal.cast<double>(),
                                   1};
    judged.in_errors.push_back(judged.off_rad.back() / aim_error_in_room_rad(fit, as_sighting));
  }
  double squares = 0;
  for (const double off : judged.off_rad) squares += off * off;
  if (!judged.off_rad.empty()) judged.rms_rad = std::sqrt(squares / static_cast<double>(judged.off_rad.size()));
}

double share_below(std::vector<double> values, double share) {
  if (values.empty()) return NAN;
  const auto at = std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

BenchRow row_of(const HeadCase& of, const std::vector<JudgedHead>& heads) {
  std::vector<double> off_deg, in_errors, rig_seconds;
  int refused = 0, silently_wrong = 0;
  double seconds = 0;
  for (const JudgedHead& head : heads) {
    seconds += head.seconds / static_cast<double>(heads.size());
    rig_seconds.push_back(head.rig_seconds);
    if (head.result.refused) {
      ++refused;
      continue;
    }
    silently_wrong += head.rms_rad > (of.by_meters ? rad_from_deg(kTargetByMeters_deg) : kSilentlyWrong_rad);
    for (const double off : head.off_rad) off_deg.push_back(deg_from_rad(off));
    in_errors.insert(in_errors.end(), head.in_errors.begin(), head.in_errors.end());
  }
  const auto within = std::count_if(in_errors.begin(), in_errors.end(), [](double e) { return e < kTwoErrors; });
  BenchRow row;
  row.case_name = of.name;
  row.method = of.by_meters ? "luxmeters" : "camera";
  row.error = share_below(off_deg, 0.95);
  row.seconds = seconds;
  row.target_error = of.by_meters ? kTargetByMeters_deg : kTarget_deg;
  row.further = {
      {"worst", fmt::format("{:.3f}", share_below(off_deg, 1))},
      {"heads", fmt::format("{}", heads.size())},
      {"refused", fmt::format("{}", refused)},
      {"silently_wrong", fmt::format("{}", silently_wrong)},
      {"rig_seconds", fmt::format("{:.1f}", share_below(rig_seconds, 0.5))},
      {"in_2_errors", fmt::format("{:.3f}", static_cast<double>(within) /
                                                std::max<double>(1, static_cast<double>(in_errors.size())))}};
  return row;
}

}  // namespace

std::vector<BenchRow> bench_heads(const BenchOptions& options) {
  const int rigs = options.seeds.value_or(options.quick ? 2 : 100);
  std::vector<BenchRow> rows;
  for (const HeadCase& of : kHeadCases) {
    if (!options.only.empty() && std::string_view(of.name).substr(0, options.only.size()) != options.only) continue;
    std::vector<JudgedHead> heads;
    for (int r = 0; r < rigs; ++r) {
      const auto seed = static_cast<std::uint64_t>(options.first_seed + r);
      const auto rig = simulate(seed, of, options.threads);
      HeadPriors priors;
      priors.camera.covariance_rad2 =
          Mat3::Identity() * std::pow(of.camera_rad > 0 ? of.camera_rad : kCameraKnown_rad, 2);
      std::vector<HeadResult> results;
      const std::size_t first = heads.size();
      HeadMeters meters(*rig, seed);
      for (std::size_t h = 0; h < rig->truths.size(); ++h) {
        heads.push_back(of.by_meters ? run_head_by_meters(*rig, h, priors, meters) : run_head(*rig, h, priors));
        results.push_back(heads.back().result);
      }
      if (!of.by_meters) conclude_together(priors, results);
      for (std::size_t h = 0; h < results.size(); ++h) {
        JudgedHead& head = heads[first + h];
        head.result = std::move(results[h]);
        judge(*rig, h, seed, head);
      }
      std::fprintf(stderr, "\rrig %d of %d ", r + 1, rigs);
    }
    rows.push_back(row_of(of, heads));
  }
  std::fprintf(stderr, "\n");
  return rows;
}

}  // namespace luxrig
