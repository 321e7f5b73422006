#include "core/calibration/reading_noise.h"

#include <utility>

#include "core/check.h"

namespace luxrig {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ReadingNoise::ReadingNoise(const std::vector<std::size_t>& place, const std::function<double(Index, Index)>& rest,
                           VectorXd variance)
    : variance_(std::move(variance)) {
  LUXRIG_CHECK(static_cast<Index>(place.size()) == variance_.size(), "{} places of {} readings", place.size(),
               variance_.size());
  for (std::size_t k = 0; k < place.size(); ++k) blocks_[place[k]].readings.push_back(static_cast<Index>(k));
  for (auto& [_, block] : blocks_) {
    const auto count = static_cast<Index>(block.readings.size());
    block.rest.resize(count, count);
    for (Index a = 0; a < count; ++a)
      for (Index b = 0; b <= a; ++b)
        block.rest(a, b) = block.rest(b, a) =
            rest(block.readings[static_cast<std::size_t>(a)], block.readings[static_cast<std::size_t>(b)]);
    block.whole.compute(block.rest + MatrixXd(VectorXd(variance_(block.readings)).asDiagonal()));
  }
}

MatrixXd ReadingNoise::solve(const MatrixXd& columns) const {
  MatrixXd solved(columns.rows(), columns.cols());
  for (const auto& [_, block] : blocks_) {
    const MatrixXd of_block = block.whole.solve(MatrixXd(columns(block.readings, Eigen::all)));
    solved(block.readings, Eigen::all) = of_block;
  }
  return solved;
}

double ReadingNoise::rest_variance(const VectorXd& weight) const {
  double variance = 0;
  for (const auto& [_, block] : blocks_) {
    const VectorXd of_block = weight(block.readings);
    variance += of_block.dot(block.rest * of_block);
  }
  return variance;
}

const std::vector<Index>& ReadingNoise::at(std::size_t place) const {
  static const std::vector<Index> none;
  const auto block = blocks_.find(place);
  return block == blocks_.end() ? none : block->second.readings;
}

}  // namespace luxrig
