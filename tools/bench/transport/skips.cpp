/// Savings from each skip of the candidate matrix in each room, and how far it moves the answer.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/bench/rooms/room_plan.h"
#include "tools/bench/transport/candidates.h"

namespace luxrig {
namespace {

struct CandidateSkip {
  const char* name;
  bool CandidateSkips::*field;
  std::uint64_t CandidateStatistics::*count;  ///< its skips, of columns or pairs
  const char* what;
};
constexpr CandidateSkip kSkips[] = {
    {"other-air", &CandidateSkips::other_air, &CandidateStatistics::columns_other_air, "columns"},
    {"behind", &CandidateSkips::behind, &CandidateStatistics::pairs_behind, "pairs"},
    {"blockers", &CandidateSkips::blockers, &CandidateStatistics::pairs_blocked_in_groups, "pairs"},
    {"reach", &CandidateSkips::reach, &CandidateStatistics::pairs_out_of_reach, "pairs"},
    {"unlit", &CandidateSkips::unlit, &CandidateStatistics::columns_unlit, "columns"},
    {"foretold", &CandidateSkips::foretold, nullptr, ""}};
/// Entries that `reach` leaves out: far below any useful illuminance.
constexpr double kMinLux = 0.01;

/// Anywhere in the box around a room except its lowest fifth, walls and furniture included, as in a lattice. An
/// isotropic lamp and a spot that faces down, 1 000 lm each.
CandidateSet places_in(const TransportCase& one, std::size_t count) {
  const Eigen::AlignedBox3d box = one.rays.bounds_world_m();
  CandidateSet set;
  RoomDice dice(23);
  while (set.positions_world_m.size() < count) {
    Vec3 share;
    for (int k = 0; k < 3; ++k) share[k] = dice.between(k == 2 ? 0.2 : 0, 1);
    set.positions_world_m.push_back(box.min() + share.cwiseProduct(box.sizes()));
  }
  set.luminaires.push_back({make_isotropic(1000), {}});
  set.luminaires.push_back({make_spot(1000, rad_from_deg(30), rad_from_deg(60)), {}});
  return set;
}

struct MatrixRun {
  CandidateTransport transport;
  CallSeconds took;
  std::string refused;
};

MatrixRun run_of(const TransportCase& one, const CandidateSet& set, const CandidateOptions& options, int runs) {
  MatrixRun run;
  std::vector<CallSeconds> took;
  for (int i = 0; i < runs && run.refused.empty(); ++i) {
    Result<CandidateTransport> done = CandidateTransport{};
    took.push_back(
        timed([&] { done = candidate_transport(one.room.scene, one.rays, one.room.receivers, set, options); }));
    if (!done) run.refused = done.error().detail;
    if (done) run.transport = std::move(*done);
  }
  run.took = median_of(took);
  return run;
}

void add_skips(const TransportCase& one, bool indirect, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const CandidateSet set = places_in(one, options.quick ? 300 : indirect ? 500 : 10'000);
  CandidateOptions of = candidate_options(options, indirect);
  of.min_lux = kMinLux;
  if (options.quick) of.surface_cells = 2'000;
  const int runs = options.quick || indirect ? 1 : 3;
  const MatrixRun with = run_of(one, set, of, runs);
  const auto add = [&](const std::string& name, const CandidateSkips& skips, double may_move_lx,
                       const std::string& skipped) {
    CandidateOptions without_it = of;
    without_it.skips = skips;
    const MatrixRun without = run_of(one, set, without_it, runs);
    const EntryMoves moves =
        moves_between(without.transport.matrix, with.transport.matrix, one.room.receivers.size(), may_move_lx);
    const CandidateStatistics &a = without.transport.statistics, &b = with.transport.statistics;
    StreamedCandidates as;
    as.statistics = b;
    as.took = with.took;
    as.refused = with.refused.empty() ? without.refused : with.refused;
    // Rays in other directions move reflected light within its error: 95 % of entries should be within twice both
    // errors.
    rows.push_back(candidate_row(
        fmt::format("skip-{}-{}-{}", one.room.name, indirect ? "indirect" : "direct", name),
        indirect ? moves.beyond_two_errors : moves.largest, as, std::nullopt, indirect ? 0.07 : 0.0, std::nullopt,
        fmt::format("{}without it {:.3g} s ({:.3g} s of cpu; {:.2f} times); {} rays ({:.2f} times); sum of entries "
                    "moves by {:.2g}",
                    skipped, without.took.wall, without.took.cpu, without.took.cpu / with.took.cpu, a.rays,
                    static_cast<double>(a.rays) / static_cast<double>(std::max<std::uint64_t>(1, b.rays)), moves.sum)));
  };
  for (const CandidateSkip& skip : kSkips) {
    if (!indirect && (skip.field == &CandidateSkips::unlit || skip.field == &CandidateSkips::foretold))
      continue;  // for reflected light only
    CandidateSkips skips;
    skips.*skip.field = false;
    const CandidateStatistics& statistics = with.transport.statistics;
    const std::uint64_t of_all =
        set.columns() * (std::string_view(skip.what) == "pairs" ? one.room.receivers.size() : 1);
    add(skip.name, skips, skip.field == &CandidateSkips::reach ? kMinLux : 0,
        skip.count ? fmt::format("skips {} of {} {}; ", statistics.*skip.count, of_all, skip.what)
                   : fmt::format("{} nodes and {} others of {} columns looked at; ", statistics.nodes,
                                 statistics.columns_looked_at, of_all));
  }
  add("all", {false, false, false, false, false, false}, kMinLux, "");
}

}  // namespace

EntryMoves moves_between(const CandidateColumns& before, const CandidateColumns& after, std::size_t receivers,
                         double may_move_lx) {
  EntryMoves moves;
  double brightest = 0, sum_before = 0, sum_after = 0;
  std::size_t entries = 0, beyond = 0;
  std::vector<double> lux(2 * receivers), error_lux(2 * receivers);
  for (std::size_t c = 0; c < std::min(before.columns(), after.columns()); ++c) {
    std::fill(lux.begin(), lux.end(), 0.0);
    std::fill(error_lux.begin(), error_lux.end(), 0.0);
    std::size_t first = 0;
    for (const CandidateColumns* columns : {&before, &after}) {
      for (std::uint64_t k = columns->begin[c]; k < columns->begin[c + 1]; ++k) {
        lux[first + columns->receiver[k]] = static_cast<double>(columns->total_lux[k]);
        error_lux[first + columns->receiver[k]] = static_cast<double>(columns->standard_error_lux[k]);
      }
      first += receivers;
    }
    for (std::size_t r = 0; r < receivers; ++r) {
      const double a = lux[r], b = lux[receivers + r];
      if (a == 0 && b == 0) continue;
      sum_before += a, sum_after += b;
      brightest = std::max({brightest, a, b});
      const double moved = std::max(0.0, std::abs(a - b) - may_move_lx);
      moves.largest = std::max(moves.largest, moved);
      ++entries;
      beyond += moved > 2 * std::hypot(error_lux[r], error_lux[receivers + r]) + 1e-6 * a;
    }
  }
  if (brightest > 0) moves.largest /= brightest;
  if (entries > 0) moves.beyond_two_errors = static_cast<double>(beyond) / static_cast<double>(entries);
  if (sum_before > 0) moves.sum = std::abs(sum_after / sum_before - 1);
  return moves;
}

void add_candidate_skip_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  for (const auto make : {+[] { return make_box_room(); }, +[] { return make_eight_room_flat(); },
                          +[] { return make_gallery_hall(); }, +[] { return make_atrium(); }}) {
    const TransportCase one(make());
    const std::string name = "skip-" + one.room.name;
    if (options.quick && one.room.name != "box") continue;
    for (const bool indirect : {false, true})
      if (wanted_case(options, name + (indirect ? "-indirect" : "-direct"))) add_skips(one, indirect, options, rows);
  }
}

}  // namespace luxrig
