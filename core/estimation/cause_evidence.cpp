#include "core/estimation/cause_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/geometry.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// How much rarer than a failed lamp or a covered meter it is that something was exchanged or knocked, as -2 log of the
/// ratio: 1 in 20.
constexpr double kRare = 6;
/// By how much two meters differ over the same light, as a share.
constexpr double kMeterShare = 0.02;
/// A lamp lights a meter directly if it gives this share of its light.
constexpr double kLightsDirectly = 0.05;
/// A meter has changed if it is off by so many standard errors.
constexpr double kChanged = 3;
/// Two meters or levels that differ by less may be exchanged unnoticed.
constexpr double kNearlyAlike = 0.02;
/// A lamp gives none of its light, less, or more: probabilities, and the most that it may give.
constexpr double kGivesNone = 0.5, kGivesMore = 0.003, kMostShare = 2.5;
constexpr double kFineStep = 0.02, kCoarseStep = 0.05;
constexpr double kMostGain = 1.5;
/// Exponents of a curve are tried so many standard errors to either side, in these steps.
constexpr double kFarthest = 3, kExponentStep = 0.1, kCoarseExponentStep = 0.6;

/// -2 log of a mean of densities that are given as -2 log.
class MeanDensity {
 public:
  void add(double weight, double badness, double chi_squared) {
    if (!(weight > 0)) return;
    const double log = std::log(weight) - badness / 2;
    if (log > most_) {
      sum_ = sum_ * std::exp(most_ - log) + 1;
      most_ = log;
      chi_squared_ = chi_squared;
    } else {
      sum_ += std::exp(log - most_);
    }
    weights_ += weight;
  }
  [[nodiscard]] double badness() const { return -2 * (most_ + std::log(sum_ / weights_)); }
  [[nodiscard]] double chi_squared() const { return chi_squared_; }

 private:
  double most_ = -std::numeric_limits<double>::infinity(), sum_ = 0, weights_ = 0, chi_squared_ = 0;
};

/// Calls use(exponent, weight) for exponents of a curve around 1.
template <class Use>
void for_exponents(double error, double step, const Use& use) {
  if (!(error > 0)) return use(1.0, 1.0);
  for (double z = -kFarthest; z <= kFarthest + step / 2; z += step) use(std::exp(error * z), std::exp(-z * z / 2));
}

}  // namespace

CauseJudge::CauseJudge(const LightChange& change) : change_(change) {
  for (Index m = 0; m < change.now_lx.size(); ++m)
    if (std::isfinite(change.now_lx[m])) read_.push_back(m);
  off_ = change.now_lx - change.before_lx;
  for (const LampDip& dip : change.dips)
    if (std::find(dipped_.begin(), dipped_.end(), dip.fixture) == dipped_.end()) dipped_.push_back(dip.fixture);
  usual_dips_ = of_dips([](std::size_t dipped, Index meter) {
    return Follows{meter, static_cast<Index>(dipped), 1, 0};
  });
}

double CauseJudge::light_error(Index meter, Index lamp) const {
  return change_.fixture_error.size() > 0 ? change_.fixture_error(meter, lamp)
                                          : kLampShare * change_.of_fixture(meter, lamp);
}

double CauseJudge::curve_error(Index lamp) const {
  return change_.curve_error.size() > 0 ? change_.curve_error[lamp] : kCurve;
}

double CauseJudge::of_no_change(Index m, double uncertain_lx) const {
  const double noise = change_.error_lx[m] * change_.error_lx[m], variance = noise + uncertain_lx * uncertain_lx;
  // The spread itself counts, or a cause that predicts nothing would explain all.
  return off_[m] * off_[m] / variance + std::log(variance / noise);
}

double CauseJudge::of_nothing() const { return of_change_of_nothing() + usual_dips_.badness; }

double CauseJudge::of_change_of_nothing() const {
  double sum = 0;
  for (const Index m : read_) sum += of_no_change(m);
  return sum;
}

/// The light of both lamps is integrated over in closed form: Gaussian, about what is known of it.
CauseJudge::Fit CauseJudge::fit(std::span<const Datum> data, Index at, Index lamp, Index other) const {
  const std::array<Index, 2> lamps{lamp, other};
  std::array<double, 2> light{}, precision{1, 1};
  for (std::size_t k = 0; k < 2; ++k) {
    if (lamps[k] < 0) continue;
    light[k] = change_.of_fixture(at, lamps[k]);
    precision[k] = 1 / std::max(1e-12, std::pow(light_error(at, lamps[k]), 2));
  }
  double a00 = precision[0], a01 = 0, a11 = precision[1], b0 = 0, b1 = 0, chi_squared = 0;
  for (const Datum& datum : data) {
    const double left = datum.value - datum.offset - datum.slope[0] * light[0] - datum.slope[1] * light[1];
    const double weight = 1 / (datum.error * datum.error);
    chi_squared += weight * left * left;
    a00 += weight * datum.slope[0] * datum.slope[0];
    a01 += weight * datum.slope[0] * datum.slope[1];
    a11 += weight * datum.slope[1] * datum.slope[1];
    b0 += weight * datum.slope[0] * left;
    b1 += weight * datum.slope[1] * left;
  }
  const double determinant = a00 * a11 - a01 * a01;
  chi_squared -= (b0 * b0 * a11 - 2 * b0 * b1 * a01 + b1 * b1 * a00) / determinant;
  return {chi_squared + std::log(determinant / (precision[0] * precision[1])), chi_squared};
}

CauseJudge::Fit CauseJudge::of_dips_of(std::size_t fixture, const Following& following) const {
  MeanDensity mean;
  std::vector<Datum> data;
  for_exponents(curve_error(static_cast<Index>(fixture)), kExponentStep, [&](double exponent, double weight) {
    Fit sum;
    for (const Index m : read_) {
      const Follows follows = following(fixture, m);
      data.clear();
      for (const LampDip& dip : change_.dips) {
        if (dip.fixture != fixture || !std::isfinite(dip.change_lx[m])) continue;
        const double taken = 1 - std::pow(dip.level_share, exponent);
        data.push_back({dip.change_lx[m], dip.error_lx[m], -taken * follows.plus_lx, {-taken * follows.share, 0}});
      }
      const Fit one = fit(data, follows.at, follows.lamp, -1);
      sum.badness += one.badness;
      sum.chi_squared += one.chi_squared;
    }
    mean.add(weight, sum.badness, sum.chi_squared);
  });
  return {mean.badness(), mean.chi_squared()};
}

CauseJudge::Fit CauseJudge::of_dips(const Following& following, std::ptrdiff_t without) const {
  Fit sum;
  for (const std::size_t fixture : dipped_) {
    if (static_cast<std::ptrdiff_t>(fixture) == without) continue;
    const Fit one = of_dips_of(fixture, following);
    sum.badness += one.badness;
    sum.chi_squared += one.chi_squared;
  }
  return sum;
}

/// What a reading that could be anything up to `range` costs a cause: the share of that which it turned out to be.
double CauseJudge::free_reading(Index m, double range_lx) const {
  return 2 * std::log(std::max(1.0, range_lx / (std::sqrt(2 * kPi) * change_.error_lx[m])));
}

void CauseJudge::add(std::vector<CauseEvidence>& found, Kind kind, std::vector<std::size_t> who, double share,
                     const Fit& fit, double alike) const {
  CauseEvidence evidence;
  evidence.cause = {kind, std::move(who), share};
  evidence.chi_squared = fit.chi_squared / static_cast<double>(data());
  evidence.badness = fit.badness + 2 * std::log(std::max(1.0, alike));
  found.push_back(std::move(evidence));
}

std::vector<CauseEvidence> CauseJudge::all() const {
  std::vector<CauseEvidence> found;
  const auto fixtures = static_cast<std::size_t>(change_.of_fixture.cols());
  all_light(found);
  if (change_.daylight.size() > 0) daylight(found);
  // Only what reaches a meter can be told of.
  std::vector<std::size_t> seen;
  for (std::size_t f = 0; f < fixtures; ++f) {
    const auto column = static_cast<Index>(f);
    if (change_.level[column] > 0 && std::any_of(read_.begin(), read_.end(), [&](Index m) {
          return change_.of_fixture(m, column) > change_.error_lx[m];
        }))
      seen.push_back(f);
  }
  // Meters first: they are few, and once a cause explains the change, most lamps need not be looked at.
  for (const Index m : read_) meter(found, m);
  for (std::size_t a = 0; a < read_.size(); ++a)
    for (std::size_t b = a + 1; b < read_.size(); ++b) meters_swapped(found, read_[a], read_[b]);
  for (const std::size_t f : seen) {
    lamp(found, f);
    moved(found, f);
  }
  // One of two exchanged lamps lights a meter that changed: all pairs of hundreds would take seconds.
  const auto lights_a_change = [&](std::size_t f) {
    return std::any_of(read_.begin(), read_.end(), [&](Index m) {
      return std::abs(off_[m]) > kChanged * change_.error_lx[m] &&
             change_.of_fixture(m, static_cast<Index>(f)) > kLightsDirectly * change_.before_lx[m];
    });
  };
  const auto rest = std::stable_partition(seen.begin(), seen.end(), lights_a_change);
  for (auto f = seen.begin(); f != rest; ++f)
    for (auto g = f + 1; g != seen.end(); ++g) lamps_swapped(found, std::min(*f, *g), std::max(*f, *g));
  return found;
}

double CauseJudge::least_misfit(std::span<const Gives> lamps) const {
  double sum = 0;
  for (const Index m : read_) {
    double lowest = 0, highest = 0, variance = change_.error_lx[m] * change_.error_lx[m];
    for (const Gives& gives : lamps) {
      const double light = change_.of_fixture(m, gives.lamp), least = (gives.least - 1) * light,
                   most = (gives.most - 1) * light;
      lowest += std::min(least, most);
      highest += std::max(least, most);
      variance +=
          std::pow(std::max(std::abs(gives.least - 1), std::abs(gives.most - 1)) * light_error(m, gives.lamp), 2);
    }
    const double off = off_[m] < lowest ? lowest - off_[m] : off_[m] > highest ? off_[m] - highest : 0;
    sum += off * off / variance;
  }
  return sum;
}

bool CauseJudge::far_behind(const std::vector<CauseEvidence>& found, double least_badness) {
  return std::any_of(found.begin(), found.end(),
                     [&](const CauseEvidence& each) { return each.badness + kFarBehind < least_badness; });
}

void CauseJudge::all_light(std::vector<CauseEvidence>& found) const {
  double up = 0, down = 0;
  for (const Index m : read_) {
    const double weight = 1 / (change_.error_lx[m] * change_.error_lx[m]);
    up += weight * change_.before_lx[m] * off_[m];
    down += weight * change_.before_lx[m] * change_.before_lx[m];
  }
  if (!(down > 0)) return;
  const double by = std::clamp(up / down, -1.0, kMostGain);
  Fit sum = of_dips([&](std::size_t dipped, Index m) { return Follows{m, static_cast<Index>(dipped), 1 + by, 0}; });
  for (const Index m : read_) {
    const double left = (off_[m] - by * change_.before_lx[m]) / change_.error_lx[m];
    sum.badness += left * left;
    sum.chi_squared += left * left;
  }
  sum.badness += 2 * std::log(std::max(1.0, (1 + kMostGain) * std::sqrt(down / (2 * kPi))));
  add(found, Kind::all_light, {}, 1 + by, sum, 1);
}

void CauseJudge::daylight(std::vector<CauseEvidence>& found) const {
  double by = 0, by_error = 1;
  for (int round = 0; round < 4; ++round) {
    double up = 0, down = 0;
    for (const Index m : read_) {
      const double uncertain = kLampShare * by * change_.daylight[m];
      const double weight = 1 / (change_.error_lx[m] * change_.error_lx[m] + uncertain * uncertain);
      up += weight * change_.daylight[m] * off_[m];
      down += weight * change_.daylight[m] * change_.daylight[m];
    }
    if (!(down > 0)) return;
    by = std::clamp(up / down, -1.0, kMostGain);
    by_error = 1 / std::sqrt(down);
  }
  Fit sum = usual_dips_;
  for (const Index m : read_) {
    const double noise = change_.error_lx[m] * change_.error_lx[m],
                 variance = noise + std::pow(kLampShare * by * change_.daylight[m], 2);
    const double left = std::pow(off_[m] - by * change_.daylight[m], 2) / variance;
    sum.badness += left + std::log(variance / noise);
    sum.chi_squared += left;
  }
  sum.badness += 2 * std::log(std::max(1.0, (1 + kMostGain) / (std::sqrt(2 * kPi) * by_error)));
  add(found, Kind::daylight, {}, 1 + by, sum, 1);
}

/// The change and the dips of this lamp together: both are of the same light.
CauseJudge::Fit CauseJudge::lamp_at(std::size_t f, double share) const {
  const auto column = static_cast<Index>(f);
  const bool dips = std::find(dipped_.begin(), dipped_.end(), f) != dipped_.end();
  MeanDensity mean;
  std::vector<Datum> data;
  for_exponents(dips ? curve_error(column) : 0, kExponentStep, [&](double exponent, double weight) {
    Fit sum;
    for (const Index m : read_) {
      data.assign(1, {off_[m], change_.error_lx[m], 0, {share - 1, 0}});
      for (const LampDip& dip : change_.dips)
        if (dip.fixture == f && std::isfinite(dip.change_lx[m]))
          data.push_back(
              {dip.change_lx[m], dip.error_lx[m], 0, {share * (std::pow(dip.level_share, exponent) - 1), 0}});
      const Fit one = fit(data, m, column, -1);
      sum.badness += one.badness;
      sum.chi_squared += one.chi_squared;
    }
    mean.add(weight, sum.badness, sum.chi_squared);
  });
  return {mean.badness(), mean.chi_squared()};
}

void CauseJudge::lamp(std::vector<CauseEvidence>& found, std::size_t f) const {
  const Gives gives{static_cast<Index>(f), 0, kMostShare};
  if (far_behind(found, least_misfit(std::span(&gives, 1)))) return;
  MeanDensity mean;
  double best = std::numeric_limits<double>::infinity(), share = 1;
  const auto attempt = [&](double at, double weight) {
    const Fit one = lamp_at(f, at);
    mean.add(weight, one.badness, one.chi_squared);
    if (one.badness >= best) return;
    best = one.badness;
    share = at;
  };
  attempt(0, kGivesNone);
  for (double at = kFineStep / 2; at < 1; at += kFineStep) attempt(at, (1 - kGivesNone - kGivesMore) * kFineStep);
  for (double at = 1 + kCoarseStep / 2; at < kMostShare; at += kCoarseStep)
    attempt(at, kGivesMore * kCoarseStep / (kMostShare - 1));
  const Fit others = of_dips(
      [](std::size_t dipped, Index m) {
        return Follows{m, static_cast<Index>(dipped), 1, 0};
      },
      static_cast<std::ptrdiff_t>(f));
  add(found, Kind::lamp, {f}, share, {mean.badness() + others.badness, mean.chi_squared() + others.chi_squared},
      static_cast<double>(change_.of_fixture.cols()));
}

void CauseJudge::meter(std::vector<CauseEvidence>& found, Index covered) const {
  const double before_lx = change_.before_lx[covered];
  const double share = before_lx > 0 ? change_.now_lx[covered] / before_lx : 1;
  Fit sum = of_dips([&](std::size_t dipped, Index m) {
    return Follows{m, static_cast<Index>(dipped), m == covered ? share : 1, 0};
  });
  for (const Index m : read_) {
    if (m == covered) continue;
    sum.badness += of_no_change(m);
    sum.chi_squared += of_no_change(m);
  }
  sum.badness += free_reading(covered, 2 * before_lx);
  add(found, Kind::meter, {static_cast<std::size_t>(covered)}, share, sum, static_cast<double>(read_.size()));
}

void CauseJudge::meters_swapped(std::vector<CauseEvidence>& found, Index a, Index b) const {
  const double at_a = change_.before_lx[a], at_b = change_.before_lx[b];
  if (std::abs(at_a - at_b) < kNearlyAlike * std::max(at_a, at_b)) return;
  Fit sum = of_dips([&](std::size_t dipped, Index m) {
    return Follows{m == a ? b : m == b ? a : m, static_cast<Index>(dipped), 1, 0};
  });
  for (const Index m : read_) {
    const double expected = m == a ? at_b - at_a : m == b ? at_a - at_b : 0;
    const double uncertain = m == a ? kMeterShare * at_b : m == b ? kMeterShare * at_a : 0;
    const double noise = change_.error_lx[m] * change_.error_lx[m], variance = noise + uncertain * uncertain;
    const double left = std::pow(off_[m] - expected, 2) / variance;
    sum.badness += left + std::log(variance / noise);
    sum.chi_squared += left;
  }
  sum.badness += kRare;
  const auto pairs = static_cast<double>(read_.size() * (read_.size() - 1)) / 2;
  add(found, Kind::meters_swapped, {static_cast<std::size_t>(a), static_cast<std::size_t>(b)}, 1, sum, pairs);
}

/// of_f, of_g: level over that before. A dip of one is a dip of the other.
CauseJudge::Fit CauseJudge::lamps_swapped_at(std::size_t f, std::size_t g, double of_f, double of_g, double exponent_f,
                                             double exponent_g) const {
  const double gives_f = std::pow(of_f, exponent_f), gives_g = std::pow(of_g, exponent_g);
  Fit sum;
  std::vector<Datum> data;
  for (const Index m : read_) {
    data.assign(1, {off_[m], change_.error_lx[m], 0, {gives_f - 1, gives_g - 1}});
    for (const LampDip& dip : change_.dips) {
      if ((dip.fixture != f && dip.fixture != g) || !std::isfinite(dip.change_lx[m])) continue;
      Datum datum{dip.change_lx[m], dip.error_lx[m], 0, {}};
      if (dip.fixture == g) datum.slope[0] = gives_f * (std::pow(dip.level_share, exponent_f) - 1);
      if (dip.fixture == f) datum.slope[1] = gives_g * (std::pow(dip.level_share, exponent_g) - 1);
      data.push_back(datum);
    }
    const Fit one = fit(data, m, static_cast<Index>(f), static_cast<Index>(g));
    sum.badness += one.badness;
    sum.chi_squared += one.chi_squared;
  }
  return sum;
}

/// Both must be lit: what a dark lamp gives here is not known.
void CauseJudge::lamps_swapped(std::vector<CauseEvidence>& found, std::size_t f, std::size_t g) const {
  const double level_f = change_.level[static_cast<Index>(f)], level_g = change_.level[static_cast<Index>(g)];
  const double then_f = change_.level_with_drive_of ? change_.level_with_drive_of(f, g) : level_g;
  const double then_g = change_.level_with_drive_of ? change_.level_with_drive_of(g, f) : level_f;
  if (!(then_f > 0 && then_g > 0) || std::abs(then_f - level_f) < kNearlyAlike * std::max(then_f, level_f)) return;
  const auto range = [this](std::size_t lamp, double level_share) {
    const double far = std::exp(kFarthest * curve_error(static_cast<Index>(lamp)));
    const double a = std::pow(level_share, far), b = std::pow(level_share, 1 / far);
    return Gives{static_cast<Index>(lamp), std::min(a, b), std::max(a, b)};
  };
  const std::array<Gives, 2> give{range(f, then_f / level_f), range(g, then_g / level_g)};
  if (far_behind(found, kRare + least_misfit(give))) return;
  MeanDensity mean;
  for_exponents(curve_error(static_cast<Index>(f)), kCoarseExponentStep, [&](double of_f, double weight_f) {
    for_exponents(curve_error(static_cast<Index>(g)), kCoarseExponentStep, [&](double of_g, double weight_g) {
      const Fit one = lamps_swapped_at(f, g, then_f / level_f, then_g / level_g, of_f, of_g);
      mean.add(weight_f * weight_g, one.badness, one.chi_squared);
    });
  });
  Fit sum{mean.badness() + kRare, mean.chi_squared()};
  for (const std::size_t dipped : dipped_) {
    if (dipped == f || dipped == g) continue;
    const Fit one = of_dips_of(dipped, [](std::size_t of, Index m) {
      return Follows{m, static_cast<Index>(of), 1, 0};
    });
    sum.badness += one.badness;
    sum.chi_squared += one.chi_squared;
  }
  const auto fixtures = static_cast<double>(change_.of_fixture.cols());
  add(found, Kind::lamps_swapped, {f, g}, 1, sum, fixtures * (fixtures - 1) / 2);
}

/// It gives any other light where it shone, and may give some at one more meter. Its reflections change by less.
void CauseJudge::moved(std::vector<CauseEvidence>& found, std::size_t f) const {
  const VectorXd light = change_.of_fixture.col(static_cast<Index>(f));
  Index brightest = -1;
  int free = 0;
  for (const Index m : read_) {
    if (light[m] > kLightsDirectly * change_.before_lx[m])
      ++free;
    else if (off_[m] > 5 * change_.error_lx[m] && (brightest < 0 || off_[m] > off_[brightest]))
      brightest = m;
  }
  if (free == 0 || (free == 1 && brightest < 0)) return;  // a lamp that is dimmer explains as much
  Fit sum{kRare, 0};
  for (const Index m : read_) {
    const bool direct = light[m] > kLightsDirectly * change_.before_lx[m];
    if (!direct && m != brightest) {
      sum.badness += of_no_change(m, 0.5 * light[m]);
      sum.chi_squared += std::pow(off_[m], 2) / (std::pow(change_.error_lx[m], 2) + std::pow(0.5 * light[m], 2));
      continue;
    }
    // Its beam's middle may come to lie there, but no more than that; it cannot take away more than it gave.
    const double expected = std::clamp(off_[m], -light[m], kMostGain * light.maxCoeff());
    const double uncertain = off_[m] < -light[m] ? light_error(m, static_cast<Index>(f)) : 0;
    const double left = std::pow(off_[m] - expected, 2) / (std::pow(change_.error_lx[m], 2) + uncertain * uncertain);
    sum.badness += left + free_reading(m, direct ? 2 * light[m] : light.maxCoeff());
    if (!direct) sum.badness += 2 * std::log(static_cast<double>(read_.size()));
    sum.chi_squared += left;
  }
  if (far_behind(found, sum.badness)) return;
  const Fit dips = of_dips([&](std::size_t dipped, Index m) {
    return Follows{m, static_cast<Index>(dipped), 1, dipped == f ? off_[m] : 0};
  });
  sum.badness += dips.badness;
  sum.chi_squared += dips.chi_squared;
  add(found, Kind::lamp_moved, {f}, 1, sum, static_cast<double>(change_.of_fixture.cols()));
}

CauseJudge::Follows CauseJudge::follows(const ChangeCause& cause, std::size_t dipped, Index m) const {
  const auto meter = static_cast<std::size_t>(m);
  Follows usual{m, static_cast<Index>(dipped), 1, 0};
  switch (cause.kind) {
    case Kind::lamp:
      if (cause.who[0] == dipped) usual.share = std::max(0.0, cause.share);
      break;
    case Kind::lamp_moved:
      if (cause.who[0] == dipped) usual.plus_lx = off_[m];
      break;
    case Kind::meter:
      if (cause.who[0] == meter) usual.share = std::max(0.0, cause.share);
      break;
    case Kind::all_light:
      usual.share = cause.share;
      break;
    case Kind::meters_swapped:
      if (cause.who[0] == meter) usual.at = static_cast<Index>(cause.who[1]);
      if (cause.who[1] == meter) usual.at = static_cast<Index>(cause.who[0]);
      break;
    case Kind::lamps_swapped:
      for (const std::size_t k : {0u, 1u}) {
        const std::size_t other = cause.who[1 - k];
        if (cause.who[k] != dipped) continue;
        const double then =
            change_.level_with_drive_of ? change_.level_with_drive_of(other, dipped) : change_.level[usual.lamp];
        usual.lamp = static_cast<Index>(other);
        usual.share = then / change_.level[usual.lamp];
        break;
      }
      break;
    case Kind::none:
    case Kind::unclear:
    case Kind::daylight:
      break;
  }
  return usual;
}

double CauseJudge::apart_by_dip(const ChangeCause& a, const ChangeCause& b, std::size_t lamp, double level_share,
                                const VectorXd& dip_error_lx) const {
  const double taken = 1 - level_share;
  double sum = 0;
  for (const Index m : read_) {
    const Follows by_a = follows(a, lamp, m), by_b = follows(b, lamp, m);
    const double lx_a = by_a.share * change_.of_fixture(by_a.at, by_a.lamp) + by_a.plus_lx;
    const double lx_b = by_b.share * change_.of_fixture(by_b.at, by_b.lamp) + by_b.plus_lx;
    const double known_to =
        std::hypot(by_a.share * light_error(by_a.at, by_a.lamp), by_b.share * light_error(by_b.at, by_b.lamp),
                   curve_error(static_cast<Index>(lamp)) * std::min(lx_a, lx_b));
    sum += std::pow(taken * (lx_a - lx_b), 2) / (std::pow(dip_error_lx[m], 2) + std::pow(taken * known_to, 2));
  }
  return sum;
}

}  // namespace luxrig
