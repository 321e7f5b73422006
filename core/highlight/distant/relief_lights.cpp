#include "core/highlight/distant/relief_lights.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr std::size_t kMaxRelightRounds = 12;
constexpr int kMaxReliefLights = 64;
constexpr double kSpreadReach = 2.5;  // of its standard deviation
/// Least gain for which a light moves: less is within the change between two meshes of the same object.
constexpr double kMinRelightGain = 0.01;

double angle_rad(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

tl::unexpected<Fault> relief_search_stopped() {
  return tl::unexpected(Fault{Cause::cancelled, "", "the search for lights was stopped", {}});
}

}  // namespace

Result<ReliefLightSearch> ReliefLightSearch::make(const TargetSurface& surface, const TargetRays& target,
                                                  std::span<const std::uint32_t> interest,
                                                  const ReliefLightOptions& options) {
  if (options.side < 1 || options.side > 64)
    return refusal(fmt::format("bins of the sphere come 1 to 64 to a side, not {}", options.side));
  if (!(options.min_angle_rad >= 0 && options.min_angle_rad <= kPi))
    return refusal(fmt::format("lights cannot be {} rad apart", options.min_angle_rad));
  if (!(options.spread_rad >= 0 && options.spread_rad <= 1))
    return refusal(fmt::format("spread of {} rad is not within 0 to 1", options.spread_rad));
  if (!(options.lift_m >= 0) || !std::isfinite(options.lift_m))
    return refusal(fmt::format("rays cannot start {} m off the surface", options.lift_m));
  if (!options.preferred.allFinite() || !(options.preference >= 0 && options.preference <= 1))
    return refusal(fmt::format("a preference of {} is not within 0 to 1, or what is preferred has no direction",
                               options.preference));
  if (interest.empty()) return refusal("no interest points: there is no relief that a light could bring out");
  ContrastSamples samples = one_ring_samples(surface, interest);
  auto table = find_lit_bins(target, samples, DirectionBins(options.side), {options, false, options.lift_m});
  if (!table) return tl::unexpected(table.error());
  ReliefLightSearch search(std::move(samples), std::move(*table), options);
  if (!(*std::max_element(search.alone_lx_.begin(), search.alone_lx_.end()) > 0))
    return refusal(
        "light from outside reaches none of the interest points from any direction: is the target a closed hull whose "
        "triangles face inwards?");
  return search;
}

ReliefLightSearch::ReliefLightSearch(ContrastSamples samples, LitTable table, const ReliefLightOptions& options)
    : options_(options), samples_(std::move(samples)), table_(std::move(table)) {
  const DirectionBins& bins = table_.bins;
  for (std::uint32_t b = 0; b < bins.count(); ++b) directions_.push_back(bins.direction_of(b));
  spread_ = bins_within(bins, std::min(kPi, kSpreadReach * options.spread_rad));
  around_ = bins_within(bins, std::min(kPi / 3, 2.6 * bin_width_rad(bins)));
  for (std::uint32_t b = 0; b < bins.count(); ++b) {
    for (const std::uint32_t other : spread_.of(b)) {
      const double away = angle_rad(directions_[b], directions_[other]) / options.spread_rad;
      spread_weights_.push_back(static_cast<float>(std::exp(-away * away / 2)));
    }
  }
  liking_.assign(bins.count(), 1);
  if (!options.preferred.isZero(0)) {
    const Vec3 preferred = options.preferred.normalized();
    for (std::uint32_t b = 0; b < bins.count(); ++b)
      liking_[b] -= options.preference * (1 - directions_[b].dot(preferred)) / 2;
  }
  if (options.may_light)
    for (std::uint32_t b = 0; b < bins.count(); ++b)
      if (!options.may_light(directions_[b])) liking_[b] = 0;
  alone_lx_ = sums().with_each_bin({});
  alone_smooth_ = smoothed(alone_lx_);
}

std::vector<double> ReliefLightSearch::smoothed(const std::vector<double>& values) const {
  std::vector<double> means(values.size());
  for (std::uint32_t b = 0; b < values.size(); ++b) {
    double sum = values[b], weight = 1;
    for (std::uint32_t k = spread_.begin[b]; k < spread_.begin[b + 1]; ++k) {
      sum += spread_weights_[k] * values[spread_.bins[k]];
      weight += spread_weights_[k];
    }
    means[b] = liking_[b] * sum / weight;
  }
  return means;
}

/// Least-squares fit of a quadric over the tangent plane; moves at most a bin's width.
Vec3 ReliefLightSearch::peak_near(std::uint32_t bin, const std::vector<double>& smooth) const {
  const Vec3& middle = directions_[bin];
  const Vec3 x = middle.unitOrthogonal(), y = middle.cross(x);
  const double width = bin_width_rad(table_.bins);
  Eigen::Matrix<double, 6, 6> squares = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> sides = Eigen::Matrix<double, 6, 1>::Zero();
  const auto add = [&](std::uint32_t b) {
    const double u = directions_[b].dot(x) / width, v = directions_[b].dot(y) / width;
    Eigen::Matrix<double, 6, 1> terms;
    terms << 1, u, v, u * u / 2, u * v, v * v / 2;
    squares += terms * terms.transpose();
    sides += smooth[b] * terms;
  };
  add(bin);
  for (const std::uint32_t other : around_.of(bin)) add(other);
  const Eigen::Matrix<double, 6, 1> fit = squares.ldlt().solve(sides);
  const double determinant = fit[3] * fit[5] - fit[4] * fit[4];
  if (!fit.allFinite() || !(fit[3] < 0) || !(determinant > 0)) return middle;
  double u = (fit[4] * fit[2] - fit[5] * fit[1]) / determinant, v = (fit[4] * fit[1] - fit[3] * fit[2]) / determinant;
  const double far = std::hypot(u, v);
  if (!std::isfinite(far)) return middle;
  if (far > 1) u /= far, v /= far;
  return (middle + width * (u * x + v * y)).normalized();
}

Result<ReliefLights> ReliefLightSearch::lights(int lights, std::span<const Vec3> start) const {
  if (lights < 1 || lights > kMaxReliefLights)
    return refusal(fmt::format("1 to {} lights can be placed, not {}", kMaxReliefLights, lights));
  if (start.size() > static_cast<std::size_t>(lights))
    return refusal(fmt::format("{} lights cannot start from {}", lights, start.size()));
  const TabledContrast contrast = sums();
  const double max_cosine = std::cos(options_.min_angle_rad);
  std::vector<std::uint32_t> chosen;
  for (const Vec3& direction : start) {
    if (!direction.allFinite() || direction.isZero(0)) return refusal("a light to start from has no direction");
    chosen.push_back(table_.bins.bin_of(direction));
  }

  struct Choice {
    std::uint32_t bin;
    std::vector<double> smooth;
  };
  const auto too_near = [&](std::uint32_t bin, const std::vector<std::uint32_t>& others) {
    return std::ranges::any_of(
        others, [&](std::uint32_t other) { return directions_[bin].dot(directions_[other]) > max_cosine; });
  };
  // The best bin apart from the others; kNone if no lit bin is left.
  const auto best_beside = [&](const std::vector<std::uint32_t>& others) {
    Choice choice{TargetSurface::kNone, {}};
    choice.smooth = others.empty() ? alone_smooth_ : smoothed(contrast.with_each_bin(contrast.illuminance_lx(others)));
    double best = 0;
    for (std::uint32_t b = 0; b < choice.smooth.size(); ++b) {
      if (!(choice.smooth[b] > best) || too_near(b, others)) continue;
      best = choice.smooth[b];
      choice.bin = b;
    }
    return choice;
  };

  std::vector<Vec3> peaks(chosen.size());
  std::size_t settled = 0;  // lights in a row that are already at their best with the others fixed
  while (chosen.size() < static_cast<std::size_t>(lights)) {
    if (options_.watch.stop.stop_requested()) return relief_search_stopped();
    const Choice next = best_beside(chosen);
    if (next.bin == TargetSurface::kNone) break;
    chosen.push_back(next.bin);
    peaks.push_back(peak_near(next.bin, next.smooth));
    settled = 1;
  }
  for (std::size_t step = 0; settled < chosen.size() && step < kMaxRelightRounds * chosen.size(); ++step) {
    if (options_.watch.stop.stop_requested()) return relief_search_stopped();
    const std::size_t k = step % chosen.size();
    std::vector<std::uint32_t> others = chosen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const Choice next = best_beside(others);
    ++settled;
    const double least = too_near(chosen[k], others) ? 0 : (1 + kMinRelightGain) * next.smooth[chosen[k]];
    if (next.bin != TargetSurface::kNone && next.bin != chosen[k] && next.smooth[next.bin] > least) {
      chosen[k] = next.bin;
      settled = 1;
    }
    peaks[k] = peak_near(chosen[k], next.smooth);
  }
  ReliefLights result{std::move(peaks), 0};
  result.local_contrast_lx = contrast.of(chosen).local_contrast_lx;
  return result;
}

double ReliefLightSearch::exposed_contrast_of(std::span<const Vec3> directions) const {
  std::vector<std::uint32_t> bins;
  for (const Vec3& direction : directions) bins.push_back(table_.bins.bin_of(direction));
  return sums().of(bins).exposed_contrast;
}

Result<ReliefLightCount> ReliefLightSearch::count_lights(int max_lights) const {
  if (max_lights < 1 || max_lights > kMaxReliefLights)
    return refusal(fmt::format("1 to {} lights can be placed, not {}", kMaxReliefLights, max_lights));
  ReliefLightCount count;
  for (int n = 1; n <= max_lights; ++n) {
    auto next =
        count.by_number.empty() ? lights(n) : lights(n, std::span<const Vec3>(count.by_number.back().directions));
    if (!next) return tl::unexpected(next.error());
    if (next->directions.size() < static_cast<std::size_t>(n)) break;  // no room for more
    count.exposed_contrast.push_back(exposed_contrast_of(next->directions));
    count.by_number.push_back(std::move(*next));
  }
  count.best = number_at_peak(count.exposed_contrast);
  return count;
}

}  // namespace luxrig
