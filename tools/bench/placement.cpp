/// Lights that are known, to be found again from their lux alone: the eight-room flat with its ten lamps, furnished and
/// lamps hung anew for each seed.

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/solve/placement/choose_lights.h"
#include "core/solve/placement/lattice.h"
#include "core/solve/placement/place_lights.h"
#include "core/solve/placement/scene_light.h"
#include "core/transport/rooms/lit_room.h"
#include "tools/bench/measured.h"
#include "tools/bench/row_progress.h"
#include "tools/bench/suites.h"

namespace luxrig {
namespace {

constexpr double kPlacementError = 0.002, kPlacementSeconds = 2, kNumberUnknownSeconds = 4;
constexpr double kFoundWithin_m = 0.03, kFoundFlux = 0.02;
constexpr double kLattice_m = 0.3;

struct KnownLights {
  std::vector<Vec3> places_m;
  std::vector<double> lumens;
};

struct Recovery {
  double error = 0;
  CallSeconds seconds;
  double farthest_m = 0;  ///< of a known light from the nearest that was found
  double worst_flux = 0;  ///< of that one, relative
  std::size_t lights = 0, wanted_lights = 0, candidates = 0, columns = 0;
  [[nodiscard]] bool found() const {
    return lights == wanted_lights && error <= kPlacementError && farthest_m <= kFoundWithin_m &&
           worst_flux <= kFoundFlux;
  }
};

void compare(const KnownLights& known, const PlacedLights& found, Recovery& recovery) {
  for (std::size_t k = 0; k < known.places_m.size(); ++k) {
    double nearest_m = std::numeric_limits<double>::infinity(), flux = 1;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double off_m = (found.poses()[i].position_world_m - known.places_m[k]).norm();
      if (off_m >= nearest_m) continue;
      nearest_m = off_m;
      flux = std::abs(found.levels()[static_cast<Eigen::Index>(i)] / known.lumens[k] - 1);
    }
    recovery.farthest_m = std::max(recovery.farthest_m, nearest_m);
    recovery.worst_flux = std::max(recovery.worst_flux, flux);
  }
}

/// All that a solve takes is in its seconds, but for the scene's tree: transport of the candidates, search, refinement.
Recovery recover(const LitRoom& room, bool number_known, std::uint64_t seed, int threads) {
  const RayScene rays(room.scene);
  const Emitter lumen{make_isotropic(1), {}};
  IncrementalOptions direct_only;
  direct_only.indirect = false;
  direct_only.threads = threads;

  // The goal is made by another evaluator than the search uses.
  KnownLights known;
  std::vector<Emitter> lamps;
  for (const Emitter& lamp : room.emitters) {
    known.places_m.push_back(lamp.world_from_lamp.translation_m);
    known.lumens.push_back(lamp.intensity->flux_lm());
    lamps.push_back({make_isotropic(known.lumens.back()), lamp.world_from_lamp});
  }
  const auto lit = make_direct_evaluator(rays)->evaluate(room.receivers, lamps, {});
  LightingGoal goal;
  goal.lux = lit->direct_lux(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(lamps.size())));

  Recovery recovery;
  recovery.seconds = timed([&] {
    const auto transport = IncrementalTransport::make(room.scene, rays, room.receivers, direct_only);
    const SceneLight light(**transport, room.receivers, lumen);
    CandidateSet set{lattice_in(rays.bounds_world_m(), kLattice_m), {lumen}};
    CandidateOptions options;
    options.indirect = false;
    options.threads = threads;
    const auto matrix = candidate_transport(room.scene, rays, room.receivers, set, options);
    const CandidateColumns& columns = matrix->matrix;
    const ColumnsView view(light.points(), columns.begin, columns.receiver, columns.total_lux);
    std::vector<LightPose> poses;
    for (const Vec3& position_m : set.positions_world_m) poses.push_back({position_m});
    const ComplementSearch candidates(view, poses, goal);
    const auto judge = [&](const PlacedLights& lights, std::size_t worked_out) {
      recovery.error = lights.error();
      recovery.lights = lights.size();
      recovery.columns = worked_out;
      compare(known, lights, recovery);
    };
    recovery.wanted_lights = room.emitters.size();
    recovery.candidates = set.positions_world_m.size();
    if (number_known) {
      PlaceOptions place;
      place.lights = room.emitters.size();
      place.seed = seed;
      place.exchange.threads = threads;
      const Placement got = place_lights(light, goal, candidates, place);
      judge(got.lights, got.columns);
    } else {
      ChooseOptions choose;
      choose.seed = seed;
      choose.exchange.threads = threads;
      const LightCurve got = choose_lights(light, goal, candidates, choose);
      judge(got.cuts[got.chosen], got.columns);
    }
  });
  return recovery;
}

BenchRow row_of(const std::string& name, const Recovery& r, double found_share) {
  BenchRow row{name, "place", r.error, r.seconds.wall, {}, {}, {}};
  row.further = {{"cpu_seconds", fmt::format("{:.3g}", r.seconds.cpu)},
                 {"found", fmt::format("{:.3g}", found_share)},
                 {"farthest_m", fmt::format("{:.3g}", r.farthest_m)},
                 {"worst_flux", fmt::format("{:.3g}", r.worst_flux)},
                 {"candidates", std::to_string(r.candidates)},
                 {"columns", std::to_string(r.columns)},
                 {"lights", std::to_string(r.lights)}};
  return row;
}

/// The value that this share of them does not exceed.
double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double at = std::ceil(share * static_cast<double>(values.size())) - 1;
  return values[static_cast<std::size_t>(std::max(0.0, at))];
}

/// A row for each seed, then the median, the 90th percentile, which is judged, and the worst of each column by itself.
std::vector<BenchRow> recovery_rows(const std::string& name, bool number_known, const BenchOptions& options) {
  const int cases = options.quick ? 6 : 100;
  std::vector<BenchRow> rows;
  std::vector<Recovery> all;
  double found = 0;
  for (int seed = 1; seed <= cases; ++seed) {
    const auto key = static_cast<std::uint64_t>(seed);
    all.push_back(recover(make_eight_room_flat(key), number_known, key, options.threads));
    found += all.back().found() ? 1 : 0;
    rows.push_back(row_of(fmt::format("{}-{}", name, seed), all.back(), all.back().found() ? 1 : 0));
    say_row_made(rows.back().case_name, rows.back().method);
  }
  for (const double share : {0.5, 0.9, 1.0}) {
    const auto of = [&](auto&& value) {
      std::vector<double> values;
      for (const Recovery& r : all) values.push_back(static_cast<double>(value(r)));
      return quantile(std::move(values), share);
    };
    Recovery at;
    at.error = of([](const Recovery& r) { return r.error; });
    at.seconds = {of([](const Recovery& r) { return r.seconds.wall; }),
                  of([](const Recovery& r) { return r.seconds.cpu; })};
    at.farthest_m = of([](const Recovery& r) { return r.farthest_m; });
    at.worst_flux = of([](const Recovery& r) { return r.worst_flux; });
    at.candidates = all.front().candidates;
    at.columns = static_cast<std::size_t>(of([](const Recovery& r) { return r.columns; }));
    at.lights = static_cast<std::size_t>(of([](const Recovery& r) { return r.lights; }));
    rows.push_back(row_of(fmt::format("{}-{:.0f}%", name, 100 * share), at, found / cases));
    if (share == 0.9) {
      rows.back().target_error = kPlacementError;
      rows.back().target_seconds = number_known ? kPlacementSeconds : kNumberUnknownSeconds;
    }
  }
  return rows;
}

}  // namespace

std::vector<BenchRow> bench_placement(const BenchOptions& options) {
  if (options.only == "index") return bench_placement_index(options);
  std::vector<BenchRow> rows;
  for (const bool number_known : {true, false}) {
    const std::string name = number_known ? "apartment-known-lights" : "apartment-number-unknown";
    if (name.rfind(options.only, 0) != 0) continue;
    const auto more = recovery_rows(name, number_known, options);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  return rows;
}

}  // namespace luxrig
