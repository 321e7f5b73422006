#pragma once
/// Reflected light of all candidates, block by block: traced where necessary, interpolated where possible.

#include <memory>

#include "core/transport/candidates/point_tree.h"
#include "core/transport/candidates/reflected/indirect_columns.h"
#include "core/transport/candidates/reflected/interpolation_nodes.h"

namespace luxrig {

class ReflectedColumns {
 public:
  /// usable   per position; the others stay dark
  /// All references must outlive it. Casts statistics.rays_per_node and rays_per_candidate; adds to statistics.rays and
  /// sets statistics.nodes.
  ReflectedColumns(const RayScene& scene, IndirectColumns indirect, const CandidateSet& candidates,
                   std::span<const CandidateLuminaire> luminaires, std::span<const std::uint8_t> usable,
                   InterpolationNodes nodes, const CandidateOptions& options, CandidateStatistics& statistics);

  /// For `count` positions from `first`: rows of `receivers` floats, one per column. Rows of unusable positions are
  /// unchanged. False when stopped.
  [[nodiscard]] bool block(std::size_t first, std::size_t count, std::size_t receivers, std::span<float> lux,
                           std::span<float> standard_error_lux);

  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Asked {
    std::uint32_t position, luminaire;
  };
  /// Neighbouring positions that share the result of pilot rays.
  struct Group {
    std::uint32_t begin, end;                             ///< into group_order_
    std::vector<std::unique_ptr<DirectionGuide>> guides;  ///< per luminaire; null until made
  };

  void make_groups(std::size_t places);
  void make_guides(std::span<const Asked> asked);
  /// Writes the replicates of each to its place; writes nothing when stopped.
  void evaluate(std::span<const Asked> asked, std::uint32_t rays_each,
                const std::function<std::span<float>(std::size_t)>& replicates_of);
  void look_at_nodes();
  void find_errors();
  [[nodiscard]] bool interpolate(const Asked& one, std::span<const WeightedRow> shares, std::span<float> replicates,
                                 std::span<float> squared_error_lux2) const;
  [[nodiscard]] bool stopped() const { return options_.watch.stop.stop_requested(); }

  const RayScene& scene_;
  IndirectColumns indirect_;
  std::span<const Vec3> positions_world_m_;
  std::span<const CandidateLuminaire> luminaires_;
  std::span<const std::uint8_t> usable_;
  const CandidateOptions& options_;
  CandidateStatistics& statistics_;
  std::size_t row_;  ///< floats of all replicates of a column
  std::vector<Group> groups_;
  std::vector<std::uint32_t> group_of_;        ///< per position
  std::vector<std::uint32_t> group_order_;     ///< positions, neighbours in sequence
  std::vector<std::uint32_t> place_in_order_;  ///< per position
  std::size_t guides_made_ = 0;
  InterpolationNodes nodes_;
  std::vector<std::vector<float>> values_;          ///< per luminaire: nodes × row_
  std::vector<std::vector<float>> squared_errors_;  ///< per luminaire: nodes × stride [lx²], see find_errors()
  std::vector<std::uint8_t> foretold_;              ///< luminaires × nodes: whether that error is known
};

}  // namespace luxrig
