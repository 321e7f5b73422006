#include "tools/bench/buses/frame_intervals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace luxrig {

void TimeCounts::add(double seconds) {
  const double us = std::clamp(std::ceil(1e6 * seconds), 0.0, static_cast<double>(kMax_us));
  ++counts_[static_cast<std::size_t>(us)];
  ++count_;
  largest_ = std::max(largest_, seconds);
}

double TimeCounts::quantile(double share) const {
  const double wanted = share * static_cast<double>(count_);
  double seen = 0;
  for (std::size_t us = 0; us < kMax_us; ++us) {
    seen += counts_[us];
    if (seen >= wanted && seen > 0) return std::min(1e-6 * static_cast<double>(us), largest_);
  }
  return largest_;
}

std::string TimeCounts::histogram() const {
  constexpr std::array<std::size_t, 10> kEdges_us = {50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000};
  std::string text;
  auto from = counts_.begin();
  for (std::size_t e = 0; e <= kEdges_us.size(); ++e) {
    const bool last = e == kEdges_us.size();
    const auto to = last ? counts_.end() : counts_.begin() + static_cast<std::ptrdiff_t>(kEdges_us[e] + 1);
    const auto here = std::accumulate(from, to, std::uint64_t{0});
    from = to;
    const double share = count_ == 0 ? 0 : static_cast<double>(here) / static_cast<double>(count_);
    text += fmt::format("  {} {:>6} us {:>8} {:6.2f} %  {}\n", last ? "> " : "<=", kEdges_us[last ? e - 1 : e], here,
                        100 * share, std::string(static_cast<std::size_t>(50 * share + 0.5), '#'));
  }
  return text;
}

}  // namespace luxrig
