#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>

#include "core/calibration/rig_light.h"
#include "core/rig/rig_file.h"
#include "sim/world/world.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTransportError = 0.003, kTruthError = 0.005;
constexpr int kSamples = 10;
constexpr double kSamplePeriod_s = 0.2;
/// Longer than the slowest meter's delay and the lamps' ramps.
constexpr double kSettle_s = 3.5;
/// Where the light is judged. Curves of dimmers are another case: here light is taken to follow the level.
constexpr double kLevel = 0.4;

/// What each lamp alone gives at full level, in truth and as the meters show it.
struct LampByLamp {
  MatrixXd truth_lx;  ///< points × fixtures
  std::vector<LightReading> readings;
};

LampByLamp measure_lamps(sim::World& world, const Rig& rig) {
  const auto fixtures = static_cast<Index>(rig.fixtures.size()), points = static_cast<Index>(rig.points.size()),
             meters = static_cast<Index>(rig.luxmeters.size());
  Time now = world.now();
  const auto mean_of_meters = [&] {
    now += from_seconds(kSettle_s);
    world.advance(now);
    VectorXd sum = VectorXd::Zero(meters);
    for (int k = 0; k < kSamples; ++k) {
      now += from_seconds(kSamplePeriod_s);
      world.advance(now);
      for (Index m = 0; m < meters; ++m) sum[m] += world.meter_reading_lx(static_cast<std::size_t>(m));
    }
    return VectorXd(sum / kSamples);
  };
  LampByLamp measured;
  measured.truth_lx.resize(points, fixtures);
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) world.set_drive(f, 0);
  const VectorXd dark_lx = mean_of_meters();
  for (Index j = 0; j < fixtures; ++j) {
    world.set_drive(static_cast<std::size_t>(j), 1);
    const VectorXd shown_lx = mean_of_meters();
    for (Index p = 0; p < points; ++p) measured.truth_lx(p, j) = world.points()[static_cast<std::size_t>(p)].lux;
    world.set_drive(static_cast<std::size_t>(j), 0);
    for (Index m = 0; m < meters; ++m)
      measured.readings.push_back({.receiver = rig.points.size() + static_cast<std::size_t>(m),
                                   .meter = static_cast<std::size_t>(m),
                                   .lux = shown_lx[m],
                                   .standard_error_lx = std::hypot(0.02 * shown_lx[m] / std::sqrt(kSamples), 0.02),
                                   .level = VectorXd::Unit(fixtures, j),
                                   .fixed_lx = dark_lx[m]});
  }
  return measured;
}

/// A person holds a meter at places that are chosen one after the other, or at random.
struct Hand {
  enum class Where { chosen, random };
  int readings = 0;
  Where where = Where::chosen;
};

Result<void> measure_by_hand(const Session& session, const LampByLamp& measured, const Hand& hand,
                             const VectorXd& level, std::uint64_t seed, RigLight& light) {
  const Rig& rig = session.rig;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const double gain = std::exp(0.01 * normal(random));
  std::vector<std::size_t> held;
  for (int k = 0; k < hand.readings; ++k) {
    std::size_t at = random() % rig.points.size();
    while (std::find(held.begin(), held.end(), at) != held.end()) at = random() % rig.points.size();
    if (hand.where == Hand::Where::chosen) {
      const auto best = light.places_to_measure(level, 1, held);
      if (best.empty()) break;
      at = best.front();
    }
    held.push_back(at);
    std::vector<LightReading> readings;
    for (Index j = 0; j < level.size(); ++j) {
      const double true_lx = measured.truth_lx(static_cast<Index>(at), j);
      const double error_lx = error_in_hand_lx(true_lx);
      readings.push_back({.receiver = at,
                          .meter = meter_in_hand(rig),
                          .lux = std::max(0.0, gain * true_lx + error_lx * normal(random)),
                          .standard_error_lx = error_lx,
                          .level = VectorXd::Unit(level.size(), j)});
    }
    if (auto learnt = light.learn(readings); !learnt) return learnt;
  }
  return {};
}

struct Errors {
  std::vector<double> share;         ///< of each goal's light, over all rigs
  std::vector<double> in_errors;     ///< the same over the stated standard error
  std::vector<double> worst_of_rig;  ///< per rig

  void add(const Rig& rig, const MatrixXd& truth_lx, const VectorXd& level, const RigLight& light) {
    double worst = 0;
    for (std::size_t p = 0; p < rig.points.size(); ++p) {
      if (!rig.points[p].goal_lx) continue;
      const double truth = truth_lx.row(static_cast<Index>(p)).dot(level);
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

struct Case {
  const char* method;
  bool meters;
  Hand hand;
};

constexpr Case kCases[] = {
    {"as stated", false, {}},
    {"meters", true, {}},
    {"meters, 5 by hand", true, {5, Hand::Where::chosen}},
    {"meters, 5 at random", true, {5, Hand::Where::random}},
    {"8 by hand", false, {8, Hand::Where::chosen}},
};

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
  const auto stated = RigLight::of(*session, usual_priors(session->rig), compute);
  if (!stated) return failed(stated.error().detail);

  const VectorXd level = VectorXd::Constant(static_cast<Index>(session->rig.fixtures.size()), kLevel);
  std::vector<Errors> errors(std::size(kCases));
  std::vector<double> seconds(std::size(kCases), 0.0);
  const int seeds = options.seeds.value_or(options.quick ? 2 : 20);
  for (int s = 0; s < seeds; ++s) {
    std::fprintf(stderr, "\rrig %d of %d ", s + 1, seeds);
    sim::Deviations real = sim::Deviations::real();
    real.seed = static_cast<std::uint64_t>(options.first_seed + s);
    auto world = sim::World::make(session->rig, real, kTruthError);
    if (!world) return failed(world.error().detail);
    const LampByLamp measured = measure_lamps(**world, session->rig);
    for (std::size_t c = 0; c < std::size(kCases); ++c) {
      const auto started = std::chrono::steady_clock::now();
      RigLight light = *stated;
      if (kCases[c].meters)
        if (auto learnt = light.learn(measured.readings); !learnt) return failed(learnt.error().detail);
      if (auto learnt = measure_by_hand(*session, measured, kCases[c].hand, level, real.seed, light); !learnt)
        return failed(learnt.error().detail);
      seconds[c] += std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() / seeds;
      errors[c].add(session->rig, measured.truth_lx, level, light);
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
                   {"in_2_errors", fmt::format("{:.3f}", share_within(errors[c].in_errors, 2))}};
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace luxrig
