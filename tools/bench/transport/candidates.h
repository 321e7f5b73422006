#pragma once
/// Candidate matrices under measurement: what the rows of accuracy, growth and skips share.

#include "core/transport/candidates/candidate_transport.h"
#include "tools/bench/transport/case.h"

namespace luxrig {

struct StreamedCandidates {
  CandidateStatistics statistics;
  CallSeconds took;
  double lux_sum = 0, peak_gib = 0;
  CandidateColumns first_columns;  ///< of the first block: to be held against an evaluator
  std::string refused;
};

/// Streams the columns of a set and lets them go. peak_gib: largest resident set meanwhile, of the process.
[[nodiscard]] StreamedCandidates stream_measured(const TransportCase& one, std::span<const Receiver> receivers,
                                                 const CandidateSet& set, const CandidateOptions& options);
/// The run of median processor time.
[[nodiscard]] StreamedCandidates median_of_streams(int runs, const TransportCase& one,
                                                   std::span<const Receiver> receivers, const CandidateSet& set,
                                                   const CandidateOptions& options);

/// Places below the ceilings of the flat, evenly at random; one isotropic lamp of 1 000 lm.
[[nodiscard]] CandidateSet places_in_the_flat(std::size_t count);

[[nodiscard]] CandidateOptions candidate_options(const BenchOptions& options, bool indirect);

[[nodiscard]] BenchRow candidate_row(const std::string& name, double error, const StreamedCandidates& run,
                                     std::optional<double> wanted, std::optional<double> target_error,
                                     std::optional<double> target_seconds, const std::string& note);

/// Entries of 24 candidates against an evaluator that gets each as a lamp: largest for direct light, relative to the
/// brightest; for all light the median of the relative errors where the evaluator itself is good to 1 %.
[[nodiscard]] double entry_error(const TransportCase& one, std::span<const Receiver> receivers, const CandidateSet& set,
                                 const CandidateOptions& options, const CandidateColumns& got);

/// As many receivers as wanted: every n-th of a room's, or all and more that hang where these see them.
[[nodiscard]] std::vector<Receiver> this_many_receivers(const TransportCase& one, std::size_t count);

/// How far entries are from each other, absent ones being 0. What is within may_move_lx counts as not moved.
struct EntryMoves {
  double largest = 0;            ///< relative to the brightest entry
  double beyond_two_errors = 0;  ///< share of entries that move by more than twice the errors of both
  double sum = 0;                ///< of all entries, relative
};
[[nodiscard]] EntryMoves moves_between(const CandidateColumns& before, const CandidateColumns& after,
                                       std::size_t receivers, double may_move_lx);

}  // namespace luxrig
