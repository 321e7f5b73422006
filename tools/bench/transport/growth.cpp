/// Growth of the candidate matrix's cost with candidates and points, and a million candidates within their memory
/// bound.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tools/bench/transport/candidates.h"

namespace luxrig {
namespace {

constexpr double kMayGrow = 0.15;  ///< beyond linear, for timing noise
constexpr double kBoundGib = 4;

/// The growth rows of one kind of light: median processor seconds by points and candidates.
class Growth {
 public:
  Growth(const TransportCase& one, bool indirect, const BenchOptions& options, std::vector<BenchRow>& rows)
      : one_(one), indirect_(indirect), options_(options), rows_(rows) {}

  void measure(std::size_t points, std::size_t candidates) {
    if (cpu_seconds_.count({points, candidates})) return;
    const CandidateSet set = places_in_the_flat(candidates);
    const std::vector<Receiver> receivers = this_many_receivers(one_, points);
    const CandidateOptions of = candidate_options(options_, indirect_);
    // A run of more than half a minute is not repeated.
    StreamedCandidates run = stream_measured(one_, receivers, set, of);
    if (!options_.quick && options_.only != "matrix" && run.took.cpu < 30)
      run = median_of_streams(3, one_, receivers, set, of);
    const double entries = static_cast<double>(points) * static_cast<double>(candidates);
    const double error =
        indirect_ ? run.statistics.median_relative_error : entry_error(one_, receivers, set, of, run.first_columns);
    rows_.push_back(
        candidate_row(fmt::format("{}-{}x{}", name(), points, candidates), error, run,
                      indirect_ ? std::optional(of.wanted_relative_error) : std::nullopt, std::nullopt, std::nullopt,
                      fmt::format("{:.3g} µs of cpu per candidate; {:.3g} ns per entry; peak resident {:.2f} GiB{}",
                                  1e6 * run.took.cpu / static_cast<double>(candidates), 1e9 * run.took.cpu / entries,
                                  run.peak_gib, indirect_ ? "; error as reported" : "")));
    cpu_seconds_[{points, candidates}] = run.took.cpu;
    last_ = std::move(run);
  }

  /// A row for the step from `few` to `many`: by how much the cost grows beyond linear.
  void compare(const char* what, std::pair<std::size_t, std::size_t> few, std::pair<std::size_t, std::size_t> many) {
    const double work = static_cast<double>(many.first * many.second) / static_cast<double>(few.first * few.second);
    const double growth = cpu_seconds_.at(many) / cpu_seconds_.at(few);
    StreamedCandidates run = last_;
    run.took.cpu = cpu_seconds_.at(many);
    run.took.wall = 0;
    rows_.push_back(candidate_row(fmt::format("{}-with-{}", name(), what), std::max(0.0, growth / work - 1), run,
                                  std::nullopt, kMayGrow, std::nullopt,
                                  fmt::format("{}x{}: {:.3g} times the work of {}x{} takes {:.3g} times the cpu",
                                              many.first, many.second, work, few.first, few.second, growth)));
  }

 private:
  [[nodiscard]] std::string name() const { return fmt::format("matrix-growth-{}", indirect_ ? "indirect" : "direct"); }
  const TransportCase& one_;
  bool indirect_;
  const BenchOptions& options_;
  std::vector<BenchRow>& rows_;
  std::map<std::pair<std::size_t, std::size_t>, double> cpu_seconds_;
  StreamedCandidates last_;
};

void add_growth(const TransportCase& one, bool indirect, const BenchOptions& options, std::vector<BenchRow>& rows) {
  Growth growth(one, indirect, options, rows);
  const bool brief = options.quick || options.only == "matrix";
  if (brief) {
    growth.measure(300, 1'000);
    growth.measure(150, 10'000);
    growth.measure(300, 10'000);
    growth.compare("candidates", {300, 1'000}, {300, 10'000});
    growth.compare("points", {150, 10'000}, {300, 10'000});
    return;
  }
  // Reflected light of a hundred thousand is measured for the usual number of points only.
  for (const std::size_t points : {75, 150, 300, 600})
    for (const std::size_t candidates : {1'000, 10'000, 100'000})
      if (!indirect || candidates < 100'000 || points == 300) growth.measure(points, candidates);
  growth.compare("candidates", {300, 10'000}, {300, 100'000});
  growth.compare("points", {75, 10'000}, {600, 10'000});
}

/// A million candidates (100 000 with quick): takes minutes, and runs by name only.
void add_million(const TransportCase& one, bool indirect, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::size_t count = options.quick ? 100'000 : 1'000'000;
  const CandidateSet very_many = places_in_the_flat(count);
  CandidateOptions of = candidate_options(options, indirect);
  of.memory_bound_bytes = static_cast<std::size_t>(kBoundGib * (1 << 30));
  const StreamedCandidates run = stream_measured(one, one.room.receivers, very_many, of);
  rows.push_back(
      candidate_row(fmt::format("matrix-million-{}", indirect ? "indirect" : "direct"),
                    std::max(0.0, run.peak_gib / kBoundGib - 1), run, std::nullopt, 0.0, std::nullopt,
                    fmt::format("{} candidates; peak resident {:.2f} GiB of {:g}; {:.3g} µs of cpu per "
                                "candidate; reported median entry error {:.3g}",
                                count, run.peak_gib, kBoundGib, 1e6 * run.took.cpu / static_cast<double>(count),
                                run.statistics.median_relative_error)));
}

}  // namespace

void add_growth_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const auto asked_by_name = [&](const std::string& name) {
    return options.only.size() > std::string("matrix").size() && wanted_case(options, name);
  };
  const bool direct = wanted_case(options, "matrix-growth-direct"),
             // Takes minutes; matrix-indirect gives a first impression.
      indirect = asked_by_name("matrix-growth-indirect") ||
                 (options.only.empty() && !options.quick && wanted_case(options, "matrix-growth-indirect")),
             million = asked_by_name("matrix-million-direct"),
             // Takes longer still, so only by its full name.
      million_indirect = options.only == "matrix-million-indirect";
  if (!direct && !indirect && !million && !million_indirect) return;
  const TransportCase flat(make_eight_room_flat());
  if (direct) add_growth(flat, false, options, rows);
  if (indirect) add_growth(flat, true, options, rows);
  if (million) add_million(flat, false, options, rows);
  if (million_indirect) add_million(flat, true, options, rows);
}

}  // namespace luxrig
