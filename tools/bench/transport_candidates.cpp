/// The matrix for placement: time and memory for very many candidates, growth, accuracy, and what each skip saves.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <random>

#include "core/transport/candidates/candidate_transport.h"
#include "tools/bench/transport_case.h"

namespace luxrig {
namespace {

struct Streamed {
  CandidateStatistics statistics;
  double seconds = 0, lux_sum = 0;
  CandidateColumns first_columns;  ///< of the first block: to be held against an evaluator
  std::string refused;
};

/// Places below the ceilings of the flat, evenly at random; one isotropic lamp of 1 000 lm.
CandidateSet places_in_the_flat(std::size_t count) {
  CandidateSet set;
  std::mt19937_64 random(17);
  const auto between = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53);
  };
  while (set.positions_world_m.size() < count)
    set.positions_world_m.emplace_back(between(0, 14.6), between(0, 9.4), between(1.8, 2.55));
  set.luminaires.push_back({make_isotropic(1000), {}});
  return set;
}

Streamed streamed(const TransportCase& one, const CandidateSet& set, const CandidateOptions& options) {
  Streamed run;
  const auto start = std::chrono::steady_clock::now();
  const auto done =
      stream_candidates(one.room.scene, one.rays, one.room.receivers, set, options, [&](const CandidateColumns& block) {
        for (const float lux : block.total_lux) run.lux_sum += static_cast<double>(lux);
        if (block.first_column == 0) run.first_columns = block;
        return true;
      });
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (done) run.statistics = *done;
  if (!done) run.refused = done.error().detail;
  return run;
}

BenchRow candidate_row(const std::string& name, double error, const Streamed& run, std::optional<double> wanted,
                       std::optional<double> target_error, std::optional<double> target_seconds,
                       const std::string& note) {
  Measured as;
  as.seconds = run.seconds;
  as.refused = run.refused;
  as.matrix.rays = run.statistics.rays;
  as.matrix.relative_error = run.statistics.median_relative_error;
  BenchRow row = transport_row(name, "candidates", error, as, wanted, target_error);
  if (run.refused.empty()) {
    row.target_seconds = target_seconds;
    row.further.back().second = note;
  }
  return row;
}

/// Largest resident set of this process so far, in GiB; from the kernel.
double peak_gib() {
  std::ifstream in("/proc/self/status");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / (1024.0 * 1024.0);
  return 0;
}
/// Starts the count anew; where the kernel does not allow it, peak_gib() is that of the whole process.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

CandidateOptions options_of(const BenchOptions& options, bool indirect) {
  CandidateOptions of;
  of.indirect = indirect;
  of.threads = options.threads;
  return of;
}

/// Entries of 24 candidates against an evaluator that gets each as a lamp: largest for direct light, relative to the
/// brightest; for all light the median of the relative errors where the evaluator itself is good to 1 %.
double entry_error(const TransportCase& one, const CandidateSet& set, const CandidateOptions& options,
                   const CandidateColumns& got) {
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
  const auto truth = evaluator->evaluate(one.room.receivers, lamps, evaluate);
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
  if (!options.indirect) return largest;
  if (errors.empty()) return std::nan("");
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

void add_matrix(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const CandidateSet many = places_in_the_flat(20'000);
  // Median of three, as the machine may be busy.
  const auto median = [&](const CandidateSet& set, const CandidateOptions& of) {
    std::vector<Streamed> runs;
    for (int i = 0; i < (options.quick ? 1 : 3); ++i) runs.push_back(streamed(one, set, of));
    std::sort(runs.begin(), runs.end(), [](const Streamed& a, const Streamed& b) { return a.seconds < b.seconds; });
    return runs[runs.size() / 2];
  };
  const CandidateOptions shadows = options_of(options, false);
  const Streamed direct = median(many, shadows);
  rows.push_back(candidate_row("matrix-direct-300x20000", entry_error(one, many, shadows, direct.first_columns), direct,
                               std::nullopt, 1e-6, 0.5,
                               fmt::format("{} pairs traced of 6000000", direct.statistics.pairs_traced)));
  const CandidateOptions indirect = options_of(options, true);
  const Streamed all = median(many, indirect);
  // Path tracing of 24 columns takes longer than the matrix: with quick the reported error stands for the measured one.
  const double error =
      options.quick ? all.statistics.median_relative_error : entry_error(one, many, indirect, all.first_columns);
  rows.push_back(candidate_row("matrix-indirect-300x20000", error, all, indirect.wanted_relative_error, 0.02, 10,
                               fmt::format("reported median entry error {:.3g}{}", all.statistics.median_relative_error,
                                           options.quick ? "" : "; error measured on 24 candidates by path tracing")));
  // Growth: twice the work may take twice the time, and 15 % for the clock.
  const CandidateSet fewer = places_in_the_flat(10'000);
  for (const bool reflected : {false, true}) {
    if (reflected && options.quick) continue;
    const Streamed half = median(fewer, options_of(options, reflected));
    const Streamed& whole = reflected ? all : direct;
    const double growth = whole.seconds / half.seconds;
    rows.push_back(candidate_row(reflected ? "matrix-growth-indirect" : "matrix-growth-direct",
                                 std::max(0.0, growth / 2 - 1), whole, std::nullopt, 0.15, std::nullopt,
                                 fmt::format("twice the candidates take {:.2f} times as long", growth)));
  }
}

void add_million(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::size_t count = options.quick ? 100'000 : 1'000'000;
  const CandidateSet very_many = places_in_the_flat(count);
  for (const bool indirect : {false, true}) {
    if (options.quick && indirect) continue;
    forget_peak();
    const Streamed run = streamed(one, very_many, options_of(options, indirect));
    const double peak = peak_gib();
    BenchRow row = candidate_row(fmt::format("matrix-{}-{}-peak", indirect ? "indirect" : "direct", count),
                                 std::max(0.0, peak / 4 - 1), run, std::nullopt, 0.0, std::nullopt,
                                 fmt::format("peak resident {:.2f} GiB of 4", peak));
    rows.push_back(row);
  }
}

/// Each skip off by itself: what it saves, and how far the sum of all entries moves. Skips that are exact for direct
/// light still change where the rays for reflected light go, and so move it within its error. With quick, direct light
/// only.
void add_skips(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const CandidateSet set = places_in_the_flat(options.quick ? 20'000 : 10'000);
  struct Skip {
    const char* name;
    bool CandidateSkips::*field;
    double may_move;  ///< the sum of all entries, relative
  };
  constexpr Skip kSkips[] = {{"other-air", &CandidateSkips::other_air, 1e-3},
                             {"behind", &CandidateSkips::behind, 1e-3},
                             {"blockers", &CandidateSkips::blockers, 1e-3},
                             {"reach", &CandidateSkips::reach, 1e-2},
                             {"unlit", &CandidateSkips::unlit, 1e-3}};
  const auto with = [&](bool CandidateSkips::*off) {
    CandidateOptions of = options_of(options, !options.quick);
    of.least_lux = 0.01;
    if (off) of.skips.*off = false;
    return streamed(one, set, of);
  };
  const Streamed all = with(nullptr);
  for (const Skip& skip : kSkips) {
    const Streamed without = with(skip.field);
    rows.push_back(candidate_row(fmt::format("skip-{}-{}", one.room.name, skip.name),
                                 std::abs(all.lux_sum / without.lux_sum - 1), all, std::nullopt, skip.may_move,
                                 std::nullopt,
                                 fmt::format("{:.3f} s without it; {} rays instead of {}", without.seconds,
                                             without.statistics.rays, all.statistics.rays)));
  }
}

}  // namespace

void add_candidate_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  if (!wanted_case(options, "matrix") && !wanted_case(options, "skip")) return;
  const TransportCase flat(make_eight_room_flat());
  if (wanted_case(options, "matrix")) {
    add_matrix(flat, options, rows);
    add_million(flat, options, rows);
  }
  if (wanted_case(options, "skip")) add_skips(flat, options, rows);
}

}  // namespace luxrig
