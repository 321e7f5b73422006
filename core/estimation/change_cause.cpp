#include "core/estimation/change_cause.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/check.h"
#include "core/geometry.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = ChangeCause::Kind;

/// A change counts if nothing at all explains it worse than this, in χ² above its expectation.
constexpr double kBeyondNoise = 40;
/// What one cause must be better by than the next.
constexpr double kMargin = 12;
/// How much rarer than a failed lamp or a covered meter it is that something was exchanged or knocked, as -2 log of the
/// ratio: 1 in 20.
constexpr double kRare = 6;
/// A cause explains a change if its χ² per meter is less than this: models are wrong by more than noise.
constexpr double kExplains = 6;
/// By how much two meters differ over the same light, as a share.
constexpr double kMeterShare = 0.02;
/// A lamp lights a meter directly if it gives this share of its light.
constexpr double kLightsDirectly = 0.05;
/// Two meters or levels that differ by less may be exchanged unnoticed.
constexpr double kAlike = 0.1;
constexpr double kMostGain = 1.5;

struct Explained {
  ChangeCause cause;
  double badness = 0;      ///< χ² and penalties
  double chi_squared = 0;  ///< per meter
};

class Judge {
 public:
  explicit Judge(const LightChange& change) : change_(change) {
    for (Index m = 0; m < change.now_lx.size(); ++m)
      if (std::isfinite(change.now_lx[m])) read_.push_back(m);
    off_ = change.now_lx - change.before_lx;
  }

  [[nodiscard]] std::size_t read() const { return read_.size(); }
  [[nodiscard]] double of_nothing() const {
    return chi_squared(VectorXd::Zero(off_.size()), VectorXd::Zero(off_.size()));
  }

  [[nodiscard]] std::vector<Explained> all() {
    const auto fixtures = static_cast<std::size_t>(change_.of_fixture.cols());
    one_factor(Kind::all_light, {}, change_.before_lx, 1);
    if (change_.daylight.size() > 0) one_factor(Kind::daylight, {}, change_.daylight, 1);
    for (std::size_t f = 0; f < fixtures; ++f) {
      if (!(change_.level[static_cast<Index>(f)] > 0)) continue;
      one_factor(Kind::lamp, {f}, change_.of_fixture.col(static_cast<Index>(f)), fixtures);
      moved(f, fixtures);
      for (std::size_t g = f + 1; g < fixtures; ++g) lamps_swapped(f, g, fixtures);
    }
    for (const Index m : read_) meter(m);
    for (std::size_t a = 0; a < read_.size(); ++a)
      for (std::size_t b = a + 1; b < read_.size(); ++b) meters_swapped(read_[a], read_[b]);
    return std::move(found_);
  }

 private:
  /// With an expected change, and how uncertain that is.
  [[nodiscard]] double chi_squared(const VectorXd& expected, const VectorXd& uncertain_lx) const {
    double sum = 0;
    for (const Index m : read_) {
      const double variance = change_.error_lx[m] * change_.error_lx[m] + uncertain_lx[m] * uncertain_lx[m];
      const double left = off_[m] - expected[m];
      // The spread itself counts, or a cause that predicts nothing would explain all.
      sum += left * left / variance + std::log(variance / (change_.error_lx[m] * change_.error_lx[m]));
    }
    return sum;
  }
  /// What a reading that could be anything up to `range` costs a cause: the share of that which it turned out to be.
  [[nodiscard]] double free_reading(Index m, double range_lx) const {
    return 2 * std::log(std::max(1.0, range_lx / (std::sqrt(2 * kPi) * change_.error_lx[m])));
  }
  void add(Kind kind, std::vector<std::size_t> who, double share, double chi_squared, double penalty, double alike) {
    Explained explained;
    explained.cause = {kind, std::move(who), share, 0};
    explained.chi_squared = chi_squared / static_cast<double>(read_.size());
    explained.badness = chi_squared + penalty + 2 * std::log(std::max(1.0, alike));
    found_.push_back(std::move(explained));
  }
  /// The change is a share of `light`, which is known to kLampShare at each meter.
  void one_factor(Kind kind, std::vector<std::size_t> who, const VectorXd& light, std::size_t alike) {
    double lost = 0, lost_error = 1;
    for (int round = 0; round < 4; ++round) {
      double up = 0, down = 0;
      for (const Index m : read_) {
        const double uncertain = kLampShare * lost * light[m];
        const double weight = 1 / (change_.error_lx[m] * change_.error_lx[m] + uncertain * uncertain);
        up -= weight * light[m] * off_[m];
        down += weight * light[m] * light[m];
      }
      if (!(down > 0)) return;
      lost = std::clamp(up / down, -kMostGain, 1.0);
      lost_error = 1 / std::sqrt(down);
    }
    const double known_to = kind == Kind::all_light ? 0 : kLampShare;
    add(kind, std::move(who), 1 - lost, chi_squared(-lost * light, std::abs(lost) * known_to * light),
        2 * std::log(std::max(1.0, (1 + kMostGain) / (std::sqrt(2 * kPi) * lost_error))), static_cast<double>(alike));
  }
  void meter(Index m) {
    VectorXd expected = VectorXd::Zero(off_.size());
    expected[m] = off_[m];
    const double share = change_.before_lx[m] > 0 ? change_.now_lx[m] / change_.before_lx[m] : 1;
    add(Kind::meter, {static_cast<std::size_t>(m)}, share, chi_squared(expected, VectorXd::Zero(off_.size())),
        free_reading(m, 2 * change_.before_lx[m]), static_cast<double>(read_.size()));
  }
  void meters_swapped(Index a, Index b) {
    const double at_a = change_.before_lx[a], at_b = change_.before_lx[b];
    if (std::abs(at_a - at_b) < kAlike * std::max(at_a, at_b)) return;
    VectorXd expected = VectorXd::Zero(off_.size()), uncertain = expected;
    expected[a] = at_b - at_a;
    expected[b] = at_a - at_b;
    uncertain[a] = kMeterShare * at_b;
    uncertain[b] = kMeterShare * at_a;
    const auto pairs = static_cast<double>(read_.size() * (read_.size() - 1)) / 2;
    add(Kind::meters_swapped, {static_cast<std::size_t>(a), static_cast<std::size_t>(b)}, 1,
        chi_squared(expected, uncertain), kRare, pairs);
  }
  /// Each gets the level of the other. Both must be lit: what a dark lamp gives here is not known.
  void lamps_swapped(std::size_t f, std::size_t g, std::size_t fixtures) {
    const double of_f = change_.level[static_cast<Index>(f)], of_g = change_.level[static_cast<Index>(g)];
    if (!(of_f > 0 && of_g > 0) || std::abs(of_f - of_g) < kAlike * std::max(of_f, of_g)) return;
    const VectorXd by_f = change_.of_fixture.col(static_cast<Index>(f)) * (of_g / of_f - 1);
    const VectorXd by_g = change_.of_fixture.col(static_cast<Index>(g)) * (of_f / of_g - 1);
    const VectorXd uncertain = kLampShare * (by_f.cwiseAbs2() + by_g.cwiseAbs2()).cwiseSqrt();
    add(Kind::lamps_swapped, {f, g}, 1, chi_squared(by_f + by_g, uncertain), kRare,
        static_cast<double>(fixtures * (fixtures - 1)) / 2);
  }
  /// It gives any other light where it shone, and may give some at one more meter. Its reflections change by less.
  void moved(std::size_t f, std::size_t fixtures) {
    const VectorXd light = change_.of_fixture.col(static_cast<Index>(f));
    VectorXd expected = VectorXd::Zero(off_.size()), uncertain = expected;
    double penalty = kRare;
    int free = 0;
    Index brightest = -1;
    double reached = 0;
    for (const Index m : read_) {
      uncertain[m] = 0.5 * light[m];
      if (light[m] > kLightsDirectly * change_.before_lx[m]) {
        // Its beam's middle may come to lie there, but no more than that.
        expected[m] = std::clamp(off_[m], -light[m], kMostGain * light.maxCoeff());
        uncertain[m] = off_[m] < -light[m] ? kLampShare * light[m] : 0;
        penalty += free_reading(m, 2 * light[m]);
        ++free;
      } else if (off_[m] > reached) {
        reached = off_[m];
        brightest = m;
      }
    }
    if (free == 0) return;
    if (brightest >= 0 && reached > 5 * change_.error_lx[brightest]) {
      expected[brightest] = std::min(off_[brightest], kMostGain * light.maxCoeff());
      uncertain[brightest] = 0;
      penalty += free_reading(brightest, light.maxCoeff()) + 2 * std::log(static_cast<double>(read_.size()));
      ++free;
    }
    if (free < 2) return;  // a lamp that is dimmer explains as much
    add(Kind::lamp_moved, {f}, 1, chi_squared(expected, uncertain), penalty, static_cast<double>(fixtures));
  }

  const LightChange& change_;
  std::vector<Index> read_;
  VectorXd off_;
  std::vector<Explained> found_;
};

}  // namespace

std::vector<ChangeCause> causes_of(const LightChange& change) {
  const Index meters = change.before_lx.size();
  LUXRIG_CHECK(change.now_lx.size() == meters && change.error_lx.size() == meters &&
                   change.of_fixture.rows() == meters && change.of_fixture.cols() == change.level.size() &&
                   (change.daylight.size() == 0 || change.daylight.size() == meters),
               "{} meters, {} readings", meters, change.now_lx.size());
  Judge judge(change);
  const auto read = static_cast<double>(judge.read());
  if (judge.read() == 0 || judge.of_nothing() - read < kBeyondNoise) return {};
  std::vector<Explained> found = judge.all();
  std::sort(found.begin(), found.end(), [](const Explained& a, const Explained& b) { return a.badness < b.badness; });
  std::vector<ChangeCause> causes;
  const ChangeCause unclear{Kind::unclear, {}, 1, 0};
  if (found.empty() || found.front().chi_squared > kExplains ||
      judge.of_nothing() - found.front().badness < kBeyondNoise / 2)
    return {unclear};
  for (const Explained& each : found) {
    const double behind = each.badness - found.front().badness;
    if (behind > kMargin) {
      causes.front().margin = causes.size() == 1 ? behind : 0;
      break;
    }
    if (causes.size() == kMostCauses) return {unclear};
    causes.push_back(each.cause);
  }
  return causes;
}

}  // namespace luxrig
