#include "core/calibration/lamp_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/check.h"
#include "core/output/dimming.h"

namespace luxrig {
namespace {

/// Lamps may be this much stronger than stated, and their light this power of the level, and a limit still holds.
constexpr double kStrongest = 1.5, kFlattest = 0.8;
/// A share of a curve whose error is larger says nothing of how well the curve is known; above that one, nothing at all.
constexpr double kMostCurveError = 0.05, kTellsNothing = 0.3;
/// No share is known better.
constexpr double kSmallestError = 1e-4;
/// Standard deviations of a dimmer's dead band, as a share of full level, and of the share of its light with which it
/// begins above that; how many of each are tried, up to three times that.
constexpr double kDeadBand = 0.03, kTail = 0.005;
constexpr int kDeadBands = 30, kTails = 12;
/// Of a reading, what is above the tail is at least this share of it.
constexpr double kOfTail = 0.1;
/// By so much, as a logarithm, any dimmer departs from the law below.
constexpr double kDeparts = 0.003;
/// Standard deviation of a dimmer's exponent above the brightest level that was read, from that below.
constexpr double kGoesOn = 0.1;
/// Share of its light at which a lamp mostly is.
constexpr double kInUse = 0.4;
/// A curve is stated at so many more levels between any two that were read.
constexpr int kBetween = 3;

struct ReadShare {
  double level = 0, log_share = 0, error = 0;  ///< error: of log_share
};

/// Light as a power of the level above a dead band, beside what it begins with there:
/// share = tail + (1 − tail) · ((level − band) / (top − band))^exponent.
struct DimmerLaw {
  double exponent = 1, band = 0, tail = 0, top = 1;
  [[nodiscard]] double log_share(double level) const {
    return std::log(tail + (1 - tail) * std::pow((level - band) / (top - band), exponent));
  }
};

/// The best exponent for this band and tail; false = it cannot be so. read: brightest first, the first is the top.
bool take_exponent(std::span<const ReadShare> read, DimmerLaw& law) {
  double xy = 0, xx = 0;
  for (const ReadShare& at : read.subspan(1)) {
    const double share = std::exp(at.log_share), of_power = (share - law.tail) / (1 - law.tail);
    if (!(of_power > kOfTail * law.tail)) return false;
    const double x = std::log((at.level - law.band) / (law.top - law.band));
    const double error = at.error * share / (share - law.tail);
    xy += x * std::log(of_power) / (error * error);
    xx += x * x / (error * error);
  }
  law.exponent = xy / xx;
  return law.exponent > 0;
}

/// By least squares, over dead bands and tails of which none are likely. read: brightest first, the first is the top.
DimmerLaw law_of(std::span<const ReadShare> read) {
  const double top = read.front().level, most = std::min(3 * kDeadBand * top, 0.9 * read.back().level);
  DimmerLaw best{1, 0, 0, top};
  double best_misfit = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= kDeadBands; ++k)
    for (int t = 0; t <= kTails; ++t) {
      DimmerLaw law{1, most * k / kDeadBands, 3 * kTail * t / kTails, top};
      if (!take_exponent(read, law)) continue;
      double misfit = std::pow(law.band / (kDeadBand * top), 2) + std::pow(law.tail / kTail, 2);
      for (const ReadShare& at : read.subspan(1))
        misfit += std::pow((at.log_share - law.log_share(at.level)) / at.error, 2);
      if (misfit < best_misfit) {
        best_misfit = misfit;
        best = law;
      }
    }
  return best;
}

/// Shares at the levels that were read and between them: by the law, and by what of each reading's distance from it is
/// more than noise. Brightest first, the top's share as 1.
MeasuredCurve smooth_curve(const DimmerLaw& law, std::span<const ReadShare> read) {
  double beyond_noise = 0;
  for (const ReadShare& at : read.subspan(1))
    beyond_noise += (std::pow(at.log_share - law.log_share(at.level), 2) - at.error * at.error) /
                    static_cast<double>(read.size() - 1);
  const double departs = kDeparts * kDeparts + std::max(0.0, beyond_noise);
  std::vector<double> off{0};
  for (const ReadShare& at : read.subspan(1))
    off.push_back((at.log_share - law.log_share(at.level)) * departs / (departs + at.error * at.error));
  MeasuredCurve curve{{law.top, 1.0}};
  for (std::size_t k = 1; k < read.size(); ++k) {
    const double lower = std::log(read[k].level), upper = std::log(read[k - 1].level);
    for (int part = 1; part <= kBetween + 1; ++part) {
      const double way = static_cast<double>(part) / (kBetween + 1);
      const double level = part > kBetween ? read[k].level : std::exp(upper + way * (lower - upper));
      const double share = std::exp(law.log_share(level) + off[k - 1] + way * (off[k] - off[k - 1]));
      if (share < curve.back().second && share > 0) curve.emplace_back(level, share);
    }
  }
  return curve;
}

}  // namespace

std::string words_of(const LampStep& step, const Rig& rig) {
  if (!(step.level > 0)) return "every lamp dark";
  return fmt::format("\"{}\" alone at level {:.3g}", rig.fixtures[step.fixture].name, step.level);
}

std::vector<double> levels_of(const LampStep& step, const Rig& rig) { return levels_of(std::span(&step, 1), rig); }

std::vector<double> levels_of(std::span<const LampStep> lit, const Rig& rig) {
  std::vector<double> level(rig.fixtures.size(), 0.0);
  for (const LampStep& step : lit) level[step.fixture] = step.level;
  return level;
}

double most_share(double level) { return kStrongest * std::pow(level, kFlattest); }

std::vector<double> brightest_levels(const Rig& rig, const Eigen::MatrixXd& stated_lux) {
  LUXRIG_CHECK(stated_lux.cols() == static_cast<Eigen::Index>(rig.fixtures.size()), "light of {} fixtures",
               stated_lux.cols());
  std::vector<double> levels;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    double level = rig.max_level(rig.fixtures[f]);
    for (std::size_t p = 0; p < rig.points.size(); ++p) {
      const double lux = stated_lux(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(f));
      if (rig.points[p].max_lx && lux * most_share(level) > *rig.points[p].max_lx)
        level = std::pow(*rig.points[p].max_lx / (kStrongest * lux), 1 / kFlattest);
    }
    levels.push_back(rig.fixtures[f].switched && level < 1 ? 0 : level);
  }
  return levels;
}

std::vector<double> levels_together(const Rig& rig, const Eigen::MatrixXd& stated_lux,
                                    std::span<const double> brightest) {
  Eigen::VectorXd level(static_cast<Eigen::Index>(brightest.size()));
  for (std::size_t f = 0; f < brightest.size(); ++f)
    level[static_cast<Eigen::Index>(f)] =
        rig.fixtures[f].switched ? 0 : brightest[f] / std::sqrt(static_cast<double>(brightest.size()));
  const Eigen::VectorXd most = level.unaryExpr(&most_share);
  double share = 1;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    const double most_lx = stated_lux.row(static_cast<Eigen::Index>(p)).dot(most);
    if (rig.points[p].max_lx && most_lx > *rig.points[p].max_lx)
      share = std::min(share, *rig.points[p].max_lx / most_lx);
  }
  level *= std::pow(share, 1 / kFlattest);
  return {level.begin(), level.end()};
}

LampCurve curve_of(std::span<const ReadAtLevel> brightest_first, double used_over_brightest) {
  LampCurve curve;
  if (brightest_first.size() < 2) return curve;
  const ReadAtLevel& full = brightest_first.front();
  const auto error_of = [](const SteadyReading& light) {
    return light.lux > 0 ? light.standard_error_lx / light.lux : 1.0;
  };
  const double error_of_full = error_of(full.light);
  if (!(full.level > 0) || error_of_full > kMostCurveError) return curve;
  std::vector<ReadShare> shares{{full.level, 0, error_of_full}};
  for (const ReadAtLevel& read : brightest_first.subspan(1)) {
    const double error = std::hypot(error_of(read.light), error_of_full);
    if (!(error < kTellsNothing && read.level < shares.back().level)) continue;
    const double log_share = std::log(read.light.lux / full.light.lux);
    if (!(log_share < shares.back().log_share)) continue;
    shares.push_back({read.level, log_share, std::max(error, kSmallestError)});
    if (error > kMostCurveError) continue;
    curve.error = std::max(curve.error, error);
    if (!(curve.error_in_use > 0)) curve.error_in_use = error;  // the brightest of them
    curve.known_from = read.level;
  }
  if (!(curve.error > 0)) return {};
  const DimmerLaw law = law_of(shares);
  MeasuredCurve of_level = smooth_curve(law, shares);
  std::reverse(of_level.begin(), of_level.end());
  // Above what a limit lets it reach, a dimmer goes on as it does below.
  if (law.top < 1) {
    const double top = std::exp(-law.log_share(1));
    for (auto& entry : of_level) entry.second *= top;
    of_level.emplace_back(1, 1);
    const double used_level =
        level_of_share(of_level, std::clamp(kInUse, top, std::max(top, top * used_over_brightest)));
    curve.error_in_use = std::hypot(curve.error_in_use, kGoesOn * std::log(used_level / law.top));
  }
  curve.of_level = std::move(of_level);
  return curve;
}

}  // namespace luxrig
