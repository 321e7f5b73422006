#include "core/calibration/lamp_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"

namespace luxrig {
namespace {

/// Lamps may be this much stronger than stated, and a limit still holds.
constexpr double kStrongest = 1.35;
/// A share of a curve whose error is larger says nothing.
constexpr double kMostCurveError = 0.05;

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

bool keeps_limits(const Rig& rig, const Eigen::MatrixXd& stated_lux, const Eigen::VectorXd& level) {
  for (std::size_t p = 0; p < rig.points.size(); ++p)
    if (rig.points[p].max_lx &&
        kStrongest * stated_lux.row(static_cast<Eigen::Index>(p)).dot(level) > *rig.points[p].max_lx)
      return false;
  return true;
}

std::vector<double> brightest_levels(const Rig& rig, const Eigen::MatrixXd& stated_lux) {
  LUXRIG_CHECK(stated_lux.cols() == static_cast<Eigen::Index>(rig.fixtures.size()), "light of {} fixtures",
               stated_lux.cols());
  std::vector<double> levels;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    double most = rig.max_level(rig.fixtures[f]);
    for (std::size_t p = 0; p < rig.points.size(); ++p) {
      const double lux = kStrongest * stated_lux(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(f));
      if (rig.points[p].max_lx && lux * most > *rig.points[p].max_lx) most = *rig.points[p].max_lx / lux;
    }
    levels.push_back(rig.fixtures[f].switched && most < 1 ? 0 : most);
  }
  return levels;
}

LampCurve curve_of(std::span<const ReadAtLevel> brightest_first) {
  LampCurve curve;
  if (brightest_first.size() < 2) return curve;
  const ReadAtLevel& full = brightest_first.front();
  const auto error_of = [](const SteadyReading& light) {
    return light.lux > 0 ? light.standard_error_lx / light.lux : 1.0;
  };
  const double error_of_full = error_of(full.light);
  if (!(full.level > 0) || error_of_full > kMostCurveError) return curve;
  MeasuredCurve shares{{full.level, 1.0}};
  for (const ReadAtLevel& read : brightest_first.subspan(1)) {
    const double error = std::hypot(error_of(read.light), error_of_full);
    const std::pair<double, double> entry{read.level, read.light.lux / full.light.lux};
    if (error > kMostCurveError || !(entry.first < shares.back().first && entry.second < shares.back().second))
      continue;
    shares.push_back(entry);
    curve.error = std::max(curve.error, error);
  }
  if (shares.size() < 2) return {};
  std::reverse(shares.begin(), shares.end());
  // Above what a limit lets it reach, the maker's curve is all there is.
  const double top = shares.back().first;
  for (auto& entry : shares) entry.second *= top;
  if (top < 1) shares.emplace_back(1, 1);
  curve.of_level = std::move(shares);
  return curve;
}

}  // namespace luxrig
