/// Cost of a solve as candidates and points grow, with memory. By name only (`--only growth`).

#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>

#include "tools/bench/placement/rows.h"
#include "tools/bench/row_progress.h"
#include "tools/bench/suites.h"
#include "tools/bench/transport/candidates.h"

namespace luxrig {
namespace {

/// A lattice may come out a little larger than requested, and a million places is the maximum.
constexpr double kRoom = 0.98;

double peak_mib() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_maxrss) / 1024;
}

void add_growth_row(const std::string& name, std::size_t points, double candidates, const BenchOptions& options,
                    std::vector<BenchRow>& rows) {
  PlacementCase one = *make_placement_case("apartment-known", 1);
  const TransportCase flat(make_eight_room_flat());
  if (points > 0) one.receivers = this_many_receivers(flat, points);
  std::vector<Emitter> lamps;
  for (std::size_t k = 0; k < one.known_lumens.size(); ++k)
    lamps.push_back({make_isotropic(one.known_lumens[k]), {Mat3::Identity(), one.known_places_world_m[k]}});
  const RayScene rays(one.scene);
  const auto lit = make_direct_evaluator(rays)->evaluate(one.receivers, lamps, {});
  one.goal_lux = lit->direct_lux(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(lamps.size())));
  const Vec3 size_m = one.lights_in_world_m.sizes();
  const auto ready = ReadyCase::make(std::move(one), options.threads, std::cbrt(size_m.prod() / (kRoom * candidates)));
  if (!ready) {
    rows.push_back(empty_placement_row(name, "luxrig"));
    set_further(rows.back(), "note", ready.error().detail);
    return;
  }
  const Solved solved =
      solve_case(**ready, *find_compared_method("luxrig"), {.lights = 10, .threads = options.threads});
  rows.push_back(placement_row(name, "luxrig", **ready, solved));
  set_further(rows.back(), "note",
              fmt::format("ready after {:.2f} s, peak of all so far {:.0f} MiB", (*ready)->seconds().wall, peak_mib()));
  say_row_made(rows.back());
}

}  // namespace

std::vector<BenchRow> bench_placement_growth(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  if (options.only.rfind("growth", 0) != 0) return rows;
  const auto add = [&](const std::string& name, std::size_t points, double candidates) {
    if (name.rfind(options.only, 0) == 0) add_growth_row(name, points, candidates, options, rows);
  };
  for (const double candidates : {1e4, 3e4, 1e5, 3e5, 1e6})
    if (!options.quick || candidates <= 3e4) add(fmt::format("growth-candidates-{:.0f}", candidates), 0, candidates);
  for (const std::size_t points : {100UL, 300UL, 1000UL, 3000UL, 10000UL})
    if (!options.quick || points <= 300) add(fmt::format("growth-points-{}", points), points, 18'000);
  return rows;
}

}  // namespace luxrig
