#include <algorithm>

#include "core/check.h"
#include "core/transport/candidates/candidate_transport.h"

namespace luxrig {

Eigen::VectorXd CandidateColumns::lux(std::size_t receivers, std::span<const double> levels) const {
  LUXRIG_CHECK(levels.size() == columns(), "{} levels for {} columns", levels.size(), columns());
  Eigen::VectorXd sum_lux = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(receivers));
  for (std::size_t c = 0; c < columns(); ++c)
    if (levels[c] != 0)
      for (std::uint64_t i = begin[c]; i < begin[c + 1]; ++i)
        sum_lux[receiver[i]] += levels[c] * static_cast<double>(total_lux[i]);
  return sum_lux;
}

std::size_t CandidateColumns::bytes() const {
  return begin.size() * sizeof(std::uint64_t) + entries() * (sizeof(std::uint32_t) + 3 * sizeof(float));
}

void CandidateStatistics::add(const CandidateStatistics& other) {
  columns += other.columns;
  columns_other_air += other.columns_other_air;
  columns_unlit += other.columns_unlit;
  pairs_behind += other.pairs_behind;
  pairs_dark += other.pairs_dark;
  pairs_out_of_reach += other.pairs_out_of_reach;
  pairs_blocked_in_groups += other.pairs_blocked_in_groups;
  pairs_traced += other.pairs_traced;
  pairs_lit += other.pairs_lit;
  rays += other.rays;
}

}  // namespace luxrig
