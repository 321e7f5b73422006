#pragma once
/// Lux at receivers per unit emittance of very many candidate luminaires: what placement searches in.
///
/// E = T c as in core/transport/evaluator.h, but T has up to 10⁶ columns. It is sparse, it comes in blocks that keep to
/// a memory bound, and each entry has its own standard error. Nothing is traced from the candidates to the receivers
/// that need not be:
///   direct      one shadow ray per pair that could see each other; groups of candidates that stand wholly in the
///               shadow of one wall are decided together (blockers.h)
///   indirect    by reciprocity: one adjoint solution per receiver (surface_importance.h) says how many lux each lumen
///               on each piece of surface brings; a candidate need only be asked where its lumens fall
///
/// Reflection is luminous (no colour) and diffuse: gloss counts as further diffuse reflectance. Evaluators that know
/// colour and gloss are behind core/transport/evaluator.h; use them on the few lights that placement ends with.

#include <functional>
#include <span>
#include <vector>

#include "core/run.h"
#include "core/transport/evaluator.h"

namespace luxrig {

/// Every luminaire at every position: column p · luminaires.size() + l is luminaire l at position p.
struct CandidateSet {
  std::vector<Vec3> positions_world_m;
  /// At least one, hung with its own rotation; its translation is added to the position. Point luminaires: a shape is
  /// refused (Cause::invalid), and so is a sky.
  std::vector<Emitter> luminaires;

  [[nodiscard]] std::size_t columns() const { return positions_world_m.size() * luminaires.size(); }
};

/// What need not be computed. Each can be switched off, to show what it saves; none but `reach` moves an answer by more
/// than its stated error.
struct CandidateSkips {
  /// Candidates in solids, outside, and in closed rooms without a receiver: separated from every receiver by a closed
  /// surface (air_regions.h). Exact.
  bool other_air = true;
  bool behind = true;    ///< pairs with the candidate behind the receiving plane, in groups. Exact.
  bool blockers = true;  ///< groups of candidates in the shadow of one wall. Exact.
  bool reach = true;     ///< entries below CandidateOptions::least_lux
  /// Candidates none of whose first few rays falls on a surface from which light gets to a receiver have no indirect
  /// light. Within the standard error.
  bool unlit = true;
  /// Reflected light of a position that follows from that at others about it (interpolation_nodes.h) is not looked at.
  /// Within the standard error.
  bool foretold = true;
};

struct CandidateOptions : Run {
  bool indirect = true;  ///< false: direct light only, exact
  /// Wanted median, over the entries kept, of standard error / lux: decides how many rays a candidate casts, up to
  /// most_rays_per_candidate.
  double wanted_relative_error = 0.02;
  std::uint32_t most_rays_per_candidate = 4096;
  /// About how many cells the surfaces are cut into, for each of eight estimates; light is looked up at four places in
  /// each. Light and importance that both vary about a place (the edge of a shadow that falls on both) make reflected
  /// light a little too low: measured -0.5 % of all light of the entries that see the lamp, in a furnished flat with
  /// cells of 30 cm. Fewer are used where memory_bound_bytes wants it.
  std::size_t surface_cells = 12'000;
  /// Entries below this [lx per unit emittance] are left out; direct light that must stay below it is not traced, so
  /// that it moves no entry by more. 0: everything is kept.
  double least_lux = 0;
  /// For everything that is allocated here, the returned matrix included.
  std::size_t memory_bound_bytes = std::size_t{4} << 30;
  CandidateSkips skips;
};

/// Columns of T, one behind the other: the entries of column c (counted from first_column) are those from begin[c] to
/// begin[c + 1], receivers rising. Entries left out are 0 or below CandidateOptions::least_lux.
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

/// What was done, and what was skipped and why. Pairs are of a receiver and a candidate (a column), counted once, in
/// the order of the fields.
struct CandidateStatistics {
  std::uint64_t columns = 0;
  std::uint64_t columns_other_air = 0;  ///< candidates behind a closed surface
  std::uint64_t columns_unlit = 0;      ///< candidates without any light at a receiver
  std::uint64_t pairs_behind = 0;       ///< candidate behind the receiving plane
  std::uint64_t pairs_dark = 0;         ///< the luminaire sends nothing that way
  std::uint64_t pairs_out_of_reach = 0;
  std::uint64_t pairs_blocked_in_groups = 0;  ///< in the shadow of a wall, decided together
  std::uint64_t pairs_traced = 0;             ///< decided by a shadow ray
  std::uint64_t pairs_lit = 0;                ///< of those: seen
  std::uint64_t rays = 0;                     ///< of every kind
  std::uint64_t surface_cells = 0;            ///< of all replicates together
  std::uint32_t rays_per_candidate = 0;       ///< that is looked at by itself; of all replicates together
  std::uint32_t rays_per_node = 0;            ///< fewer, as several nodes take part in each answer
  /// Columns whose reflected light was looked at with rays of their own; the others' is interpolated between `nodes`
  /// positions where it was.
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
/// returns       Cause::invalid for what check_evaluation() refuses, a shape or sky, or a memory bound that not even
///               one small block keeps to; Cause::cancelled when stopped. A candidate in a receiver (infinite lux) has no
///               entry there.
[[nodiscard]] Result<CandidateStatistics> stream_candidates(const Scene& scene, const RayScene& rays,
                                                            std::span<const Receiver> receivers,
                                                            const CandidateSet& candidates,
                                                            const CandidateOptions& options, const TakeColumns& take);

/// The whole matrix: 16 bytes per entry. Cause::invalid when that does not fit the memory bound, with the figures.
[[nodiscard]] Result<CandidateTransport> candidate_transport(const Scene& scene, const RayScene& rays,
                                                             std::span<const Receiver> receivers,
                                                             const CandidateSet& candidates,
                                                             const CandidateOptions& options);

}  // namespace luxrig
