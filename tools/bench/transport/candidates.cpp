#include "tools/bench/transport/candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/bench/peak_memory.h"
#include "tools/bench/rooms/room_plan.h"

namespace luxrig {
namespace {

/// Time and accuracy of the matrix that placement searches in.
void add_matrix(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  // `--only matrix` must be quick: fewer runs, and no path tracing, which takes longer than the matrix.
  const bool brief = options.quick || options.only == "matrix";
  const CandidateSet many = places_in_the_flat(20'000);
  const std::span<const Receiver> receivers = one.room.receivers;
  if (wanted_case(options, "matrix-direct-300x20000")) {
    const CandidateOptions direct = candidate_options(options, false);
    const StreamedCandidates run = median_of_streams(options.quick ? 1 : 3, one, receivers, many, direct);
    rows.push_back(candidate_row(
        "matrix-direct-300x20000", entry_error(one, receivers, many, direct, run.first_columns), run, std::nullopt,
        1e-6, 0.5,
        fmt::format("{} pairs traced of {}", run.statistics.pairs_traced, receivers.size() * many.columns())));
  }
  if (wanted_case(options, "matrix-indirect-300x20000")) {
    const CandidateOptions indirect = candidate_options(options, true);
    const StreamedCandidates run = median_of_streams(brief ? 1 : 3, one, receivers, many, indirect);
    const double reported = run.statistics.median_relative_error;
    const double error = brief ? reported : entry_error(one, receivers, many, indirect, run.first_columns);
    rows.push_back(candidate_row("matrix-indirect-300x20000", error, run, indirect.wanted_relative_error, 0.02, 10,
                                 fmt::format("reported median entry error {:.3g}{}", reported,
                                             brief ? "" : "; error measured on 24 candidates by path tracing")));
  }
}

}  // namespace

StreamedCandidates stream_measured(const TransportCase& one, std::span<const Receiver> receivers,
                                   const CandidateSet& set, const CandidateOptions& options) {
  StreamedCandidates run;
  forget_peak();
  run.took = timed([&] {
    const auto done =
        stream_candidates(one.room.scene, one.rays, receivers, set, options, [&](const CandidateColumns& block) {
          for (const float lux : block.total_lux) run.lux_sum += static_cast<double>(lux);
          if (block.first_column == 0) run.first_columns = block;
          return true;
        });
    if (done) run.statistics = *done;
    if (!done) run.refused = done.error().detail;
  });
  run.peak_gib = peak_gib();
  return run;
}

StreamedCandidates median_of_streams(int runs, const TransportCase& one, std::span<const Receiver> receivers,
                                     const CandidateSet& set, const CandidateOptions& options) {
  std::vector<StreamedCandidates> all;
  for (int i = 0; i < runs; ++i) all.push_back(stream_measured(one, receivers, set, options));
  const auto middle = all.begin() + runs / 2;
  std::nth_element(all.begin(), middle, all.end(),
                   [](const StreamedCandidates& a, const StreamedCandidates& b) { return a.took.wall < b.took.wall; });
  return std::move(*middle);
}

CandidateSet places_in_the_flat(std::size_t count) {
  CandidateSet set;
  RoomDice dice(17);
  while (set.positions_world_m.size() < count) {
    const double x = dice.between(0, 14.6), y = dice.between(0, 9.4);
    set.positions_world_m.emplace_back(x, y, dice.between(1.8, 2.55));
  }
  set.luminaires.push_back({make_isotropic(1000), {}});
  return set;
}

CandidateOptions candidate_options(const BenchOptions& options, bool indirect) {
  CandidateOptions of;
  of.indirect = indirect;
  // Entries below a ten-thousandth of the brightest do not matter for the light that a lamp is hung for.
  if (indirect) of.min_lux = 0.01;
  of.threads = options.threads;
  return of;
}

BenchRow candidate_row(const std::string& name, double error, const StreamedCandidates& run,
                       std::optional<double> wanted, std::optional<double> target_error,
                       std::optional<double> target_seconds, const std::string& note) {
  Measured as;
  as.seconds = run.took.wall;
  as.cpu_seconds = run.took.cpu;
  as.refused = run.refused;
  as.matrix.rays = run.statistics.rays;
  as.matrix.relative_error = run.statistics.median_relative_error;
  BenchRow row = transport_row(name, "candidates", error, as, wanted, target_error);
  if (run.refused.empty()) {
    row.target_seconds = target_seconds;
    set_note(row, note);
  }
  return row;
}

double entry_error(const TransportCase& one, std::span<const Receiver> receivers, const CandidateSet& set,
                   const CandidateOptions& options, const CandidateColumns& got) {
  std::vector<Emitter> lamps;
  for (std::size_t p = 0; p < std::min<std::size_t>(24, got.columns()); ++p) {
    lamps.push_back(set.luminaires.front());
    lamps.back().world_from_lamp.translation_m += set.positions_world_m[p];
  }
  EvaluateOptions evaluate;
  evaluate.wanted_relative_error = 0.02;
  evaluate.threads = options.threads;
  evaluate.seed = 99;
  const auto evaluator = options.indirect ? make_path_evaluator(one.rays) : make_direct_evaluator(one.rays);
  const auto truth = evaluator->evaluate(receivers, lamps, evaluate);
  if (lamps.empty() || !truth) return std::nan("");
  std::vector<double> errors;
  double largest = 0;
  for (std::size_t c = 0; c < lamps.size(); ++c) {
    const Eigen::VectorXd unit =
        Eigen::VectorXd::Unit(static_cast<Eigen::Index>(lamps.size()), static_cast<Eigen::Index>(c));
    const Eigen::VectorXd exact_lx = truth->lux(unit), bar_lx = truth->standard_error_lux(unit);
    Eigen::VectorXd lux = Eigen::VectorXd::Zero(exact_lx.size());
    for (std::uint64_t k = got.begin[c]; k < got.begin[c + 1]; ++k)
      lux[got.receiver[k]] = static_cast<double>(got.total_lux[k]);
    for (Eigen::Index r = 0; r < lux.size(); ++r) {
      largest = std::max(largest, std::abs(lux[r] - exact_lx[r]) / truth->lux_per_level.maxCoeff());
      if (exact_lx[r] > 0 && bar_lx[r] < 0.01 * exact_lx[r]) errors.push_back(std::abs(lux[r] / exact_lx[r] - 1));
    }
  }
  return options.indirect ? median_of(std::move(errors)) : largest;
}

std::vector<Receiver> this_many_receivers(const TransportCase& one, std::size_t count) {
  const std::vector<Receiver>& all = one.room.receivers;
  std::vector<Receiver> some;
  if (count <= all.size()) {
    for (std::size_t i = 0; i < count; ++i) some.push_back(all[i * all.size() / count]);
    return some;
  }
  some = all;
  RoomDice dice(5);
  for (std::size_t i = 0; some.size() < count; ++i) {
    Receiver beside = all[i % all.size()];
    const Vec3 aside_m(dice.between(-0.5, 0.5), dice.between(-0.5, 0.5), dice.between(0.01, 0.2));
    const Vec3 to_m = beside.position_world_m + aside_m;
    if (one.rays.occluded(beside.position_world_m, beside.normal_world, to_m)) continue;
    beside.position_world_m = to_m;
    some.push_back(beside);
  }
  return some;
}

void add_candidate_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  if (wanted_case(options, "matrix-direct-300x20000") || wanted_case(options, "matrix-indirect-300x20000"))
    add_matrix(TransportCase(make_eight_room_flat()), options, rows);
}

}  // namespace luxrig
