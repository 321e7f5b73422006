#pragma once
/// Lux at receivers per unit emittance of very many candidate luminaires: the matrix for placement searches.
///
/// E = T c as in core/transport/evaluator.h, but T has up to 10⁶ columns. T is sparse, comes in blocks within a memory
/// bound, and each entry has its own standard error. Few rays are traced between candidates and receivers:
///   direct      one shadow ray per pair that could see each other; groups of candidates that are completely in the
///               shadow of one wall are decided together (blockers.h)
///   indirect    by reciprocity: one adjoint solution per receiver (surface_importance.h) gives the lux per lumen on
///               each piece of surface; a candidate is evaluated only where its lumens fall
///
/// Reflection is luminous (no colour) and diffuse: gloss counts as extra diffuse reflectance. The evaluators in
/// core/transport/evaluator.h handle colour and gloss; use them for the few lights of the final placement.

#include <functional>
#include <span>
#include <vector>

#include "core/run.h"
#include "core/transport/evaluator.h"

namespace luxrig {

/// Every luminaire at every position: column p · luminaires.size() + l is luminaire l at position p.
struct CandidateSet {
  std::vector<Vec3> positions_world_m;
  /// At least one, each with its own rotation; its translation is added to the position. Point luminaires only: shapes
  /// and skies are refused (Cause::invalid).
  std::vector<Emitter> luminaires;

  [[nodiscard]] std::size_t columns() const { return positions_world_m.size() * luminaires.size(); }
};

/// Work that can be skipped. Each skip can be switched off, to show what it saves; none except `reach` changes a result
/// by more than its stated error.
struct CandidateSkips {
  /// Candidates in solids, outside, and in closed rooms without a receiver: a closed surface separates them from every
  /// receiver (air_regions.h). Exact.
  bool other_air = true;
  bool behind = true;    ///< pairs with the candidate behind the receiver's plane, in groups. Exact.
  bool blockers = true;  ///< groups of candidates in the shadow of one wall. Exact.
  bool reach = true;     ///< entries below CandidateOptions::min_lux
  /// No indirect light for candidates whose first few rays all miss the surfaces that send light to a receiver. Within
  /// the standard error.
  bool unlit = true;
  /// Positions whose reflected light follows from that of neighbours (interpolation_nodes.h) are not evaluated. Within
  /// the standard error.
  bool foretold = true;
};

struct CandidateOptions : Run {
  bool indirect = true;  ///< false = direct light only, exact
  /// Wanted median of standard error / lux over the entries kept. It sets the number of rays per candidate, up to
  /// max_rays_per_candidate.
  double wanted_relative_error = 0.02;
  std::uint32_t max_rays_per_candidate = 4096;
  /// Approximate number of cells of the surfaces, for each of eight estimates; light is evaluated at four places in
  /// each. Where light and importance both vary within a cell (a shadow edge that falls on both), reflected light is
  /// slightly too low: measured -0.5 % of all light of the entries that see the lamp, in a furnished flat with cells of
  /// 30 cm. Fewer cells are used if memory_bound_bytes requires it.
  std::size_t surface_cells = 12'000;
  /// Entries below this [lx per unit emittance] are left out. Direct light that must be below it is not traced, so no
  /// entry changes by more. 0 = keep everything.
  double min_lux = 0;
  /// For all allocations here, including the returned matrix.
  std::size_t memory_bound_bytes = std::size_t{4} << 30;
  CandidateSkips skips;
};

/// Columns of T in sequence: the entries of column c (counted from first_column) are those from begin[c] to begin[c +
/// 1], receivers rising. Missing entries are 0 or below CandidateOptions::min_lux.
struct CandidateColumns {
  std::size_t first_column = 0;
  std::vector<std::uint64_t> begin = {0};
  std::vector<std::uint32_t> receiver;
  std::vector<float> direct_lux;          ///< per unit emittance
  std::vector<float> total_lux;           ///< direct and indirect
  std::vector<float> standard_error_lux;  ///< of total_lux; 0 when exact

  [[nodiscard]] std::size_t columns() const { return begin.size() - 1; }
  [[nodiscard]] std::size_t entries() const { return receiver.size(); }
  /// T c [lx], summed in double. levels: one per column.
  [[nodiscard]] Eigen::VectorXd lux(std::size_t receivers, std::span<const double> levels) const;
  [[nodiscard]] std::size_t bytes() const;
};

/// Work done, and work skipped with the reason. A pair is a receiver and a candidate (column), counted once, under the
/// first field that applies.
struct CandidateStatistics {
  std::uint64_t columns = 0;
  std::uint64_t columns_other_air = 0;  ///< candidates behind a closed surface
  std::uint64_t columns_unlit = 0;      ///< candidates without light at any receiver
  std::uint64_t pairs_behind = 0;       ///< candidate behind the receiving plane
  std::uint64_t pairs_dark = 0;         ///< the luminaire emits nothing in that direction
  std::uint64_t pairs_out_of_reach = 0;
  std::uint64_t pairs_blocked_in_groups = 0;  ///< in the shadow of a wall, decided in groups
  std::uint64_t pairs_traced = 0;             ///< decided by a shadow ray
  std::uint64_t pairs_lit = 0;                ///< of the traced pairs: visible
  std::uint64_t rays = 0;                     ///< of every kind
  std::uint64_t surface_cells = 0;            ///< of all replicates together
  std::uint32_t rays_per_candidate = 0;       ///< for a candidate with its own rays; over all replicates
  std::uint32_t rays_per_node = 0;            ///< fewer, since several nodes contribute to each result
  /// Columns whose reflected light was traced with their own rays. The other columns interpolate it between `nodes`
  /// positions, if there are nodes.
  std::uint64_t columns_looked_at = 0;
  std::uint64_t nodes = 0;
  double median_relative_error = 0;  ///< over the entries kept; 0 when exact. To 3 %.

  void add(const CandidateStatistics& other);
};

struct CandidateTransport {
  CandidateColumns matrix;
  CandidateStatistics statistics;
};

/// Called with each block of columns, in rising order, from the calling thread. False stops (Cause::cancelled).
using TakeColumns = std::function<bool(const CandidateColumns&)>;

/// Streams T in blocks.
///
/// scene, rays   the same geometry twice: as triangles and ready for rays
/// returns       Cause::invalid for whatever check_evaluation() refuses, a shape or sky, or a memory bound too small
///               for one small block; Cause::cancelled when stopped. A candidate in a receiver (infinite lux) has no
///               entry there.
[[nodiscard]] Result<CandidateStatistics> stream_candidates(const Scene& scene, const RayScene& rays,
                                                            std::span<const Receiver> receivers,
                                                            const CandidateSet& candidates,
                                                            const CandidateOptions& options, const TakeColumns& take);

/// The whole matrix: 16 bytes per entry. Cause::invalid, with the figures, if it exceeds the memory bound.
[[nodiscard]] Result<CandidateTransport> candidate_transport(const Scene& scene, const RayScene& rays,
                                                             std::span<const Receiver> receivers,
                                                             const CandidateSet& candidates,
                                                             const CandidateOptions& options);

}  // namespace luxrig
