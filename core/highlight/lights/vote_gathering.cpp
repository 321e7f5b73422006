#include "core/highlight/lights/vote_gathering.h"

#include <algorithm>

#include "core/parallel.h"

namespace luxrig {
namespace {

std::vector<DomainCell> cells_voted_for(const std::vector<GatheredPart>& parts, int threads) {
  std::vector<std::vector<DomainCell>> of_part(parts.size());
  const auto keep_each_once = [](std::vector<DomainCell>& cells) {
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  };
  parallel_for(parts.size(), threads, [&](std::size_t p) {
    for (const GatheredVote& vote : parts[p].votes) of_part[p].push_back(vote.cell);
    keep_each_once(of_part[p]);
    of_part[p].shrink_to_fit();
  });
  std::vector<DomainCell> all, joined;
  for (std::vector<DomainCell>& cells : of_part) {
    joined.clear();
    std::set_union(all.begin(), all.end(), cells.begin(), cells.end(), std::back_inserter(joined));
    all.swap(joined);
    cells = {};
  }
  return all;
}

}  // namespace

void sort_into_cells(const LightDomain& domain, std::vector<GatheredPart>& parts,
                     std::span<const std::uint32_t> feature_of_point, DomainVotes& votes, int threads) {
  const std::vector<DomainCell> cells = cells_voted_for(parts, threads);
  for (const DomainCell& cell : cells) votes.cells.push_back({cell, domain.layer_of(cell.group), Vec3::Zero()});
  // Replaces a vote's cell by its index: one look-up each, in parallel.
  parallel_for(parts.size(), threads, [&](std::size_t p) {
    for (GatheredVote& vote : parts[p].votes)
      vote.cell.bin =
          static_cast<std::uint32_t>(std::lower_bound(cells.begin(), cells.end(), vote.cell) - cells.begin());
  });
  votes.begin.assign(cells.size() + 1, 0);
  for (const GatheredPart& part : parts) {
    votes.counts.add(part.counts);
    for (const GatheredVote& vote : part.votes) ++votes.begin[vote.cell.bin + 1];
  }
  for (std::size_t i = 0; i < cells.size(); ++i) votes.begin[i + 1] += votes.begin[i];
  std::vector<std::uint64_t> next(votes.begin.begin(), votes.begin.end() - 1);
  votes.votes.resize(votes.begin.back());
  for (GatheredPart& part : parts) {
    for (const GatheredVote& vote : part.votes)
      votes.votes[next[vote.cell.bin]++] = {vote.point, feature_of_point[vote.point], vote.direction,
                                            vote.squared_distance_m2};
    part.votes = {};
  }
  for (const std::uint32_t feature : feature_of_point) votes.features = std::max(votes.features, feature + 1);
  votes.points_of_feature.assign(votes.features, 0);
  for (const std::uint32_t feature : feature_of_point) ++votes.points_of_feature[feature];
}

double nearest_luminaire_m(double wanted_m, const Eigen::AlignedBox3d& points_m) {
  if (wanted_m > 0) return wanted_m;
  return std::max(1e-3, points_m.isEmpty() ? 0 : 0.01 * points_m.diagonal().norm());
}

}  // namespace luxrig
