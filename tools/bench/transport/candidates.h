#pragma once
/// Candidate matrices to measure: shared by the rows of accuracy, growth and skips.

#include "core/transport/candidates/candidate_transport.h"
#include "tools/bench/transport/case.h"

namespace luxrig {

struct StreamedCandidates {
  CandidateStatistics statistics;
  CallSeconds took;
  double lux_sum = 0, peak_gib = 0;
  CandidateColumns first_columns;  ///< of the first block, to compare with an evaluator
  std::string refused;
};

/// Streams the columns of a set and discards them. peak_gib: largest resident set of the process during that time.
[[nodiscard]] StreamedCandidates stream_measured(const TransportCase& one, std::span<const Receiver> receivers,
                                                 const CandidateSet& set, const CandidateOptions& options);
/// The run with the median processor time.
[[nodiscard]] StreamedCandidates median_of_streams(int runs, const TransportCase& one,
                                                   std::span<const Receiver> receivers, const CandidateSet& set,
                                                   const CandidateOptions& options);

/// Places below the ceilings of the flat, uniformly random; one isotropic lamp of 1 000 lm.
[[nodiscard]] CandidateSet places_in_the_flat(std::size_t count);

[[nodiscard]] CandidateOptions candidate_options(const BenchOptions& options, bool indirect);

[[nodiscard]] BenchRow candidate_row(const std::string& name, double error, const StreamedCandidates& run,
                                     std::optional<double> wanted, std::optional<double> target_error,
                                     std::optional<double> target_seconds, const std::string& note);

/// Entries of 24 candidates against an evaluator that gets each as a lamp. Direct light: the largest error, relative to
/// the brightest entry. All light: the median relative error of the entries where the evaluator itself is good to 1 %.
[[nodiscard]] double entry_error(const TransportCase& one, std::span<const Receiver> receivers, const CandidateSet& set,
                                 const CandidateOptions& options, const CandidateColumns& got);

/// The wanted number of receivers: every n-th of a room's; or all, and more that hang where these can see them.
[[nodiscard]] std::vector<Receiver> this_many_receivers(const TransportCase& one, std::size_t count);

/// Differences of entries between two answers, with 0 for absent ones. A difference within may_move_lx does not count.
struct EntryMoves {
  double largest = 0;            ///< relative to the brightest entry
  double beyond_two_errors = 0;  ///< share of entries that move by more than twice both errors
  double sum = 0;                ///< of all entries, relative
};
[[nodiscard]] EntryMoves moves_between(const CandidateColumns& before, const CandidateColumns& after,
                                       std::size_t receivers, double may_move_lx);

}  // namespace luxrig
