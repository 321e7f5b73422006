#include "core/radiometry/curve_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace luxrig {
namespace {

constexpr int kPieces = 20, kCoefficients = kPieces + 3, kCurveRounds = 6, kFineness = 512;
constexpr double kKnownTo = 0.003;   ///< light is never taken as known better than this, relative
constexpr double kSmoothing = 1e-4;  ///< of third differences, relative to the weight of the data

/// Uniform cubic B-splines over [low, high].
struct Spline {
  double low = 0, high = 1;

  struct Basis {
    Eigen::Index first;
    std::array<double, 4> value, slope;
  };
  [[nodiscard]] Basis at(double x) const {
    const double step = (high - low) / kPieces;
    const double scaled = std::clamp((x - low) / step, 0.0, static_cast<double>(kPieces));
    const int piece = std::min(static_cast<int>(scaled), kPieces - 1);
    const double u = scaled - piece, v = 1 - u;
    return {piece,
            {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6, u * u * u / 6},
            {-v * v / 2 / step, (3 * u * u - 4 * u) / 2 / step, -(3 * v * v - 4 * v) / 2 / step, u * u / 2 / step}};
  }
  [[nodiscard]] static double sum(const Eigen::VectorXd& c, const Basis& place, const std::array<double, 4>& part) {
    double out = 0;
    for (int i = 0; i < 4; ++i) out += c[place.first + i] * part[static_cast<std::size_t>(i)];
    return out;
  }
};

struct CurvePoint {
  Spline::Basis place;
  double exposure_s, sample, variance, mean_variance;
};

using CurveGroup = std::vector<CurvePoint>;

/// Adds the equations of a group: light over exposure is the same at all of its points.
void add_group(const CurveGroup& group, const Eigen::VectorXd& before, Eigen::MatrixXd& normal) {
  const auto n = static_cast<Eigen::Index>(group.size());
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n, kCoefficients);
  Eigen::VectorXd exposures(n), weight(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const CurvePoint& p = group[static_cast<std::size_t>(i)];
    exposures[i] = p.exposure_s;
    const double light = Spline::sum(before, p.place, p.place.value);
    const double slope = Spline::sum(before, p.place, p.place.slope);
    const double floor = kKnownTo * light;
    weight[i] = 1 / (slope * slope * p.mean_variance + floor * floor + 1e-12);
    for (int k = 0; k < 4; ++k) rows(i, p.place.first + k) = p.place.value[static_cast<std::size_t>(k)];
  }
  const Eigen::VectorXd along = weight.cwiseProduct(exposures);
  const Eigen::MatrixXd weighted = rows.transpose() * weight.asDiagonal() * rows;
  const Eigen::VectorXd shared = rows.transpose() * along;
  normal += weighted - shared * shared.transpose() / along.dot(exposures);
}

}  // namespace

Result<SampleCurve> fit_curve(const SampleGroups& groups) {
  Spline spline{1, 0};
  for (const auto& group : groups.groups)
    for (const GroupSample& sample : group)
      if (sample.usable) {
        spline.low = std::min(spline.low, sample.mean);
        spline.high = std::max(spline.high, sample.mean);
      }
  if (!(spline.high - spline.low > 0.05)) return refusal("samples that hardly differ: a longer exposure is needed");
  std::vector<CurveGroup> used;
  std::size_t points = 0;
  for (const auto& group : groups.groups) {
    CurveGroup one;
    for (std::size_t s = 0; s < group.size(); ++s)
      if (group[s].usable)
        one.push_back({spline.at(group[s].mean), groups.exposures_s[s], group[s].mean, group[s].variance,
                       group[s].mean_variance});
    if (one.size() < 2) continue;
    points += one.size();
    used.push_back(std::move(one));
  }
  if (points < 3 * kCoefficients) return refusal("too few lights that two exposures see without clipping");

  // Starts with a line through the least light seen, to have weights.
  Eigen::VectorXd c(kCoefficients);
  for (Eigen::Index i = 0; i < kCoefficients; ++i) c[i] = std::max(1e-3, (static_cast<double>(i) - 1) / kPieces);
  Eigen::MatrixXd differences = Eigen::MatrixXd::Zero(kCoefficients - 3, kCoefficients);
  for (Eigen::Index i = 0; i + 3 < kCoefficients; ++i) {
    differences(i, i) = -1, differences(i, i + 1) = 3, differences(i, i + 2) = -3, differences(i, i + 3) = 1;
  }
  const Spline::Basis end = spline.at(spline.high);
  Eigen::VectorXd one_at_end = Eigen::VectorXd::Zero(kCoefficients);
  for (int k = 0; k < 4; ++k) one_at_end[end.first + k] = end.value[static_cast<std::size_t>(k)];
  for (int round = 0; round < kCurveRounds; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(kCoefficients, kCoefficients);
    for (const CurveGroup& group : used) add_group(group, c, normal);
    const double scale = normal.trace() / kCoefficients;
    normal += kSmoothing * scale * differences.transpose() * differences;
    normal.diagonal().array() += 1e-12 * scale;
    // Minimum of cᵀ N c with light 1 at the upper end.
    const Eigen::VectorXd solved = normal.ldlt().solve(one_at_end);
    const double height = one_at_end.dot(solved);
    if (!solved.allFinite() || !(std::abs(height) > 0)) return refusal("the series does not tell the response");
    c = solved / height;
  }

  // Extended down to no light and up to saturation by straight lines. Where noise makes the curve fall, it is kept
  // level.
  const auto light_at = [&](double x) {
    const Spline::Basis place = spline.at(x);
    const double edge = std::clamp(x, spline.low, spline.high);
    return Spline::sum(c, place, place.value) + (x - edge) * Spline::sum(c, place, place.slope);
  };
  const double full = light_at(groups.saturation);
  if (!(full > 0)) return refusal("the series does not tell the response");
  std::vector<std::pair<double, double>> curve;
  const double low = std::max(0.0, spline.low);
  double most = light_at(low) / full;
  const double slope_low = std::max(0.0, Spline::sum(c, spline.at(low), spline.at(low).slope)) / full;
  if (most > 0 && slope_low > 0 && low - most / slope_low > 0) {
    curve.emplace_back(low - most / slope_low, 0.0);
  } else if (low > 1e-6) {
    curve.emplace_back(0.0, std::min(0.0, most - slope_low * low));
  }
  for (int i = 0; i <= kFineness; ++i) {
    const double x = low + (groups.saturation - low) * i / kFineness;
    most = std::max(most, light_at(x) / full);
    if (curve.empty() || x > curve.back().first + 1e-6)
      curve.emplace_back(x, std::max(most, curve.empty() ? most : curve.back().second));
  }
  return SampleCurve::through(std::move(curve));
}

CurveShape shape_of(const SampleCurve& curve, double saturation) {
  constexpr int kSteps = 90, kDarkSteps = 60;
  constexpr double kNoLight = 0.002;
  const double full = curve.light(saturation);
  // The start of light is hard to see on a curve that starts flat, so candidates run from zero to where there is some
  // light.
  double some_light = 0;
  while (some_light < 0.9 * saturation && curve.light(some_light) < kNoLight * full) some_light += 0.002;
  CurveShape shape;
  double best = 1e9;
  for (int d = 0; d <= kDarkSteps; ++d) {
    const double dark = some_light * d / kDarkSteps;
    const auto each = [&](auto&& body) {
      for (int i = 0; i <= kSteps; ++i) {
        const double share = 0.1 + 0.9 * i / kSteps;
        if (const double light = curve.light(dark + share * (saturation - dark)) / full; light > 0) body(share, light);
      }
    };
    double top = 0, bottom = 0;  // the exponent from logarithms, through (1, 1)
    int count = 0;
    each([&](double share, double light) {
      top += std::log(share) * std::log(light), bottom += std::log(share) * std::log(share), ++count;
    });
    if (count < kSteps / 2) continue;
    const double exponent = std::max(0.05, top / bottom);
    const std::pair<const char*, SampleCurve> known[] = {{"linear", SampleCurve::linear()},
                                                         {"srgb", SampleCurve::srgb()},
                                                         {"bt709", SampleCurve::bt709()},
                                                         {"power", SampleCurve::power(exponent)}};
    for (const auto& entry : known) {
      const SampleCurve& candidate = entry.second;
      double squares = 0;
      each([&](double share, double light) { squares += std::pow(light / candidate.light(share) - 1, 2); });
      // A named curve is chosen if it is nearly as good as a free exponent.
      const double rms = std::sqrt(squares / count);
      const double judged = rms + (std::string_view(entry.first) == "power" ? 0.01 : 0.0);
      if (judged >= best) continue;
      best = judged;
      shape = {exponent, entry.first, rms};
    }
  }
  return shape;
}

}  // namespace luxrig
