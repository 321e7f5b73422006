#include "core/highlight/distant/tabled_contrast.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr std::size_t kPointsPerTabledTask = 64;

/// Illuminance at one place from a beam of 1 lx out of each bin, plus base_lx. Fully vectorised: the bit masks, it does
/// not branch.
void beam_row(const OrientedPoint& place, std::span<const std::uint64_t> lit, float base_lx, const float* x,
              const float* y, const float* z, float* row_lx, std::size_t bins) {
  const Vec3f normal = place.normal.cast<float>();
  for (std::size_t b = 0; b < bins; b += 32) {
    const auto half = static_cast<std::uint32_t>(lit[b / 64] >> (b % 64));
    for (std::size_t k = 0; k < 32; ++k) {
      const float cosine = std::max(0.0f, normal.x() * x[b + k] + normal.y() * y[b + k] + normal.z() * z[b + k]);
      row_lx[b + k] = base_lx + ((half & (1u << k)) != 0 ? cosine : 0.0f);
    }
  }
}

}  // namespace

TabledContrast::TabledContrast(const ContrastSamples& samples, const LitTable& table, int threads)
    : samples_(samples), table_(table), threads_(threads) {
  LUXRIG_CHECK(table.rows.size() == samples.points.size() * table.words, "{} words for {} points", table.rows.size(),
               samples.points.size());
  const std::size_t padded = 64 * table.words;
  for (std::vector<float>* axis : {&x_, &y_, &z_}) axis->assign(padded, 0);
  for (std::uint32_t b = 0; b < table.bins.count(); ++b) {
    const Vec3f direction = table.bins.direction_of(b).cast<float>();
    x_[b] = direction.x();
    y_[b] = direction.y();
    z_[b] = direction.z();
  }
}

std::vector<float> TabledContrast::illuminance_lx(std::span<const std::uint32_t> bins) const {
  std::vector<float> sum_lx(samples_.points.size(), 0);
  for (std::size_t p = 0; p < sum_lx.size(); ++p) {
    const Vec3f normal = samples_.points[p].normal.cast<float>();
    for (const std::uint32_t b : bins)
      if (table_.lit(p, b)) sum_lx[p] += std::max(0.0f, normal.x() * x_[b] + normal.y() * y_[b] + normal.z() * z_[b]);
  }
  return sum_lx;
}

SampleContrast TabledContrast::of(std::span<const std::uint32_t> bins) const {
  return contrast_of(samples_, illuminance_lx(bins));
}

std::vector<double> TabledContrast::with_each_bin(std::span<const float> base_lx) const {
  LUXRIG_CHECK(base_lx.empty() || base_lx.size() == samples_.points.size(), "{} for {} points", base_lx.size(),
               samples_.points.size());
  const std::size_t padded = 64 * table_.words;
  const std::size_t tasks = (samples_.interest + kPointsPerTabledTask - 1) / kPointsPerTabledTask;
  std::vector<std::vector<float>> sums(tasks);
  parallel_for(tasks, threads_, [&](std::size_t task) {
    std::vector<float>& sum = sums[task];
    sum.assign(padded, 0);
    std::vector<float> mine(padded), theirs(padded), largest(padded);
    const auto row = [&](std::uint32_t p, std::vector<float>& into) {
      beam_row(samples_.points[p], table_.of(p), base_lx.empty() ? 0.0f : base_lx[p], x_.data(), y_.data(), z_.data(),
               into.data(), padded);
    };
    for (std::size_t i = task * kPointsPerTabledTask;
         i < std::min(samples_.interest, (task + 1) * kPointsPerTabledTask); ++i) {
      row(static_cast<std::uint32_t>(i), mine);
      std::fill(largest.begin(), largest.end(), 0.0f);
      for (const std::uint32_t n : samples_.of(i)) {
        row(n, theirs);
        for (std::size_t b = 0; b < padded; ++b) largest[b] = std::max(largest[b], std::abs(mine[b] - theirs[b]));
      }
      for (std::size_t b = 0; b < padded; ++b) sum[b] += largest[b];
    }
  });
  std::vector<double> contrast_lx(table_.bins.count(), 0);
  for (const std::vector<float>& sum : sums)
    for (std::size_t b = 0; b < contrast_lx.size(); ++b) contrast_lx[b] += sum[b];
  for (double& c : contrast_lx) c /= static_cast<double>(std::max<std::size_t>(1, samples_.interest));
  return contrast_lx;
}

}  // namespace luxrig
