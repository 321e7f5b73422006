#include "core/solve/bounds/light_blocks.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/check.h"

namespace luxrig {
namespace {

/// Similarities are shares; this many evenly chosen lights are enough for them.
constexpr std::size_t kMaxSampledLights = 4096;

/// Joins rows, most similar first.
class RowLinkage {
 public:
  explicit RowLinkage(Eigen::MatrixXf similarity)
      : similarity_(std::move(similarity)), size_(static_cast<std::size_t>(similarity_.rows()), 1) {}

  /// Block of each row, named by one of its rows. Average linkage by chains of nearest neighbours, which gives the same
  /// blocks as joining the nearest pair each time (Bruynooghe 1978).
  std::vector<std::uint32_t> joined(float least) {
    const auto count = static_cast<Eigen::Index>(size_.size());
    std::vector<std::uint32_t> block(size_.size());
    for (std::size_t i = 0; i < block.size(); ++i) block[i] = static_cast<std::uint32_t>(i);
    std::vector<Eigen::Index> chain;
    for (Eigen::Index start = 0; start < count;) {
      if (chain.empty()) {
        if (size_[static_cast<std::size_t>(start)] == 0 || done_at(start)) {
          ++start;
          continue;
        }
        chain.push_back(start);
      }
      const Eigen::Index last = chain.back(), before = chain.size() > 1 ? chain[chain.size() - 2] : -1;
      Eigen::Index nearest = before;
      float best = before >= 0 ? similarity_(before, last) : least;
      for (Eigen::Index other = 0; other < count; ++other)
        if (other != last && size_[static_cast<std::size_t>(other)] > 0 && similarity_(other, last) > best) {
          best = similarity_(other, last);
          nearest = other;
        }
      if (nearest < 0) {  // none is near enough, and averages only fall
        done_.push_back(last);
        chain.pop_back();
      } else if (nearest == before) {
        chain.resize(chain.size() - 2);
        join(before, last);
        std::replace(block.begin(), block.end(), static_cast<std::uint32_t>(last), static_cast<std::uint32_t>(before));
      } else {
        chain.push_back(nearest);
      }
    }
    join_small(block);
    return block;
  }

 private:
  /// A block of a few rows is too small: it joins the most similar one, however small the similarity.
  void join_small(std::vector<std::uint32_t>& block) {
    const float small = static_cast<float>(size_.size()) / 50;
    for (Eigen::Index row = 0; row < similarity_.rows(); ++row) {
      const float size = size_[static_cast<std::size_t>(row)];
      if (size == 0 || size >= small) continue;
      Eigen::Index nearest = -1;
      for (Eigen::Index other = 0; other < similarity_.rows(); ++other)
        if (other != row && size_[static_cast<std::size_t>(other)] > 0 && similarity_(other, row) > 0 &&
            (nearest < 0 || similarity_(other, row) > similarity_(nearest, row)))
          nearest = other;
      if (nearest < 0) continue;
      join(nearest, row);
      std::replace(block.begin(), block.end(), static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(nearest));
    }
  }

  [[nodiscard]] bool done_at(Eigen::Index row) const {
    return std::find(done_.begin(), done_.end(), row) != done_.end();
  }
  void join(Eigen::Index into, Eigen::Index from) {
    float& a = size_[static_cast<std::size_t>(into)];
    float& b = size_[static_cast<std::size_t>(from)];
    const float share = a / (a + b);
    similarity_.col(into) = share * similarity_.col(into) + (1 - share) * similarity_.col(from);
    similarity_.row(into) = similarity_.col(into).transpose();
    a += b;
    b = 0;
  }

  Eigen::MatrixXf similarity_;
  std::vector<float> size_;  ///< 0 = joined to another
  std::vector<Eigen::Index> done_;
};

}  // namespace

LightBlocks light_blocks(const ColumnsView& columns, const Eigen::VectorXd& row_weight,
                         std::span<const std::uint32_t> light_of_column, std::size_t lights, double min_similarity) {
  LUXRIG_CHECK(row_weight.size() == columns.rows(), "{} weights for {} rows", row_weight.size(), columns.rows());
  LUXRIG_CHECK(light_of_column.size() == static_cast<std::size_t>(columns.columns()), "{} lights for {} columns",
               light_of_column.size(), columns.columns());
  const auto rows = static_cast<std::size_t>(columns.rows());
  const std::size_t step = 1 + (lights - std::min<std::size_t>(lights, 1)) / kMaxSampledLights;
  const std::size_t words = (lights / step + 64) / 64;
  std::vector<std::uint64_t> reached(rows * words, 0);  // by which sampled lights
  std::vector<char> lit(rows, 0);
  std::vector<std::uint32_t> entry_rows;
  std::vector<double> values;
  for (Eigen::Index j = 0; j < columns.columns(); ++j) {
    const std::size_t light = light_of_column[static_cast<std::size_t>(j)];
    columns.entries(j, entry_rows, values);
    for (const std::uint32_t i : entry_rows) {
      if (!(row_weight[i] > 0)) continue;
      lit[i] = 1;
      if (light % step == 0) reached[i * words + light / step / 64] |= std::uint64_t{1} << (light / step % 64);
    }
  }
  Eigen::MatrixXf similarity = Eigen::MatrixXf::Zero(columns.rows(), columns.rows());
  for (std::size_t a = 0; a < rows; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      std::uint64_t both = 0, either = 0;
      const std::uint64_t *of_a = &reached[a * words], *of_b = &reached[b * words];
      for (std::size_t w = 0; w < words; ++w) {
        both += static_cast<std::uint64_t>(std::popcount(of_a[w] & of_b[w]));
        either += static_cast<std::uint64_t>(std::popcount(of_a[w] | of_b[w]));
      }
      const auto ia = static_cast<Eigen::Index>(a), ib = static_cast<Eigen::Index>(b);
      if (either > 0) similarity(ia, ib) = similarity(ib, ia) = static_cast<float>(both) / static_cast<float>(either);
    }

  LightBlocks blocks;
  blocks.of_row = RowLinkage(std::move(similarity)).joined(static_cast<float>(min_similarity));
  std::vector<std::uint32_t> number(rows, kNoBlock);
  for (std::size_t i = 0; i < rows; ++i) {
    if (!lit[i]) {
      blocks.of_row[i] = kNoBlock;
      continue;
    }
    std::uint32_t& known = number[blocks.of_row[i]];
    if (known == kNoBlock) known = static_cast<std::uint32_t>(blocks.count++);
    blocks.of_row[i] = known;
  }

  std::vector<double> squares(lights * blocks.count, 0.0);
  for (Eigen::Index j = 0; j < columns.columns(); ++j) {
    columns.entries(j, entry_rows, values);
    // Each emitter in its own unit, so that the strongest does not decide alone.
    double largest = 0, sum = 0;
    for (std::size_t k = 0; k < values.size(); ++k)
      largest = std::max(largest, row_weight[entry_rows[k]] * std::abs(values[k]));
    if (!(largest > 0)) continue;
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k] = row_weight[entry_rows[k]] * values[k] / largest;
      sum += values[k] * values[k];
    }
    double* const of = &squares[light_of_column[static_cast<std::size_t>(j)] * blocks.count];
    for (std::size_t k = 0; k < values.size(); ++k)
      if (blocks.of_row[entry_rows[k]] != kNoBlock) of[blocks.of_row[entry_rows[k]]] += values[k] * values[k] / sum;
  }
  blocks.of_light.assign(lights, kNoBlock);
  for (std::size_t light = 0; light < lights && blocks.count > 0; ++light) {
    const double* const of = &squares[light * blocks.count];
    const auto best = static_cast<std::size_t>(std::max_element(of, of + blocks.count) - of);
    if (of[best] > 0) blocks.of_light[light] = static_cast<std::uint32_t>(best);
  }
  return blocks;
}

}  // namespace luxrig
