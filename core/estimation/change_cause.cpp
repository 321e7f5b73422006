#include "core/estimation/change_cause.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/estimation/cause_evidence.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Kind = ChangeCause::Kind;

/// A change counts if nothing at all explains it worse than this, in χ² above its expectation.
constexpr double kBeyondNoise = 40;
/// What one cause must be better by than the next.
constexpr double kMargin = 10;
/// A cause explains a change if its χ² per meter is less than this: models are wrong by more than noise.
constexpr double kExplains = 6;
/// A separation of causes by a dip that is less than this tells nothing, and more than the other is enough.
constexpr double kTells = 4, kTellsEnough = 40;

/// Those within kMargin of the best; none if even that explains nothing.
std::vector<ChangeCause> near_best(const CauseJudge& judge) {
  std::vector<CauseEvidence> found = judge.all();
  std::sort(found.begin(), found.end(),
            [](const CauseEvidence& a, const CauseEvidence& b) { return a.badness < b.badness; });
  std::vector<ChangeCause> causes;
  if (found.empty() || found.front().chi_squared > kExplains ||
      judge.of_nothing() - found.front().badness < kBeyondNoise / 2)
    return causes;
  for (CauseEvidence& each : found)
    if (each.badness - found.front().badness <= kMargin) causes.push_back(std::move(each.cause));
  return causes;
}

bool anything_changed(const CauseJudge& judge) {
  return judge.read() > 0 && judge.of_change_of_nothing() - static_cast<double>(judge.read()) >= kBeyondNoise;
}

void check_sizes(const LightChange& change) {
  const Index meters = change.before_lx.size(), fixtures = change.level.size();
  LUXRIG_CHECK(change.now_lx.size() == meters && change.error_lx.size() == meters &&
                   change.of_fixture.rows() == meters && change.of_fixture.cols() == fixtures &&
                   (change.fixture_error.size() == 0 ||
                    (change.fixture_error.rows() == meters && change.fixture_error.cols() == fixtures)) &&
                   (change.curve_error.size() == 0 || change.curve_error.size() == fixtures) &&
                   (change.daylight.size() == 0 || change.daylight.size() == meters),
               "{} meters, {} readings", meters, change.now_lx.size());
  for (const LampDip& dip : change.dips)
    LUXRIG_CHECK(static_cast<Index>(dip.fixture) < fixtures && dip.change_lx.size() == meters &&
                     dip.error_lx.size() == meters && dip.level_share > 0 && dip.level_share < 1,
                 "a dip of another rig");
}

}  // namespace

std::vector<ChangeCause> likely_causes(const LightChange& change) {
  check_sizes(change);
  const CauseJudge judge(change);
  if (!anything_changed(judge)) return {};
  std::vector<ChangeCause> causes = near_best(judge);
  if (causes.empty()) return {{Kind::unclear, {}, 1}};
  return causes;
}

std::vector<ChangeCause> causes_to_tell(std::vector<ChangeCause> likely) {
  if (likely.size() > kMostCauses) return {{Kind::unclear, {}, 1}};
  return likely;
}

std::vector<ChangeCause> causes_of(const LightChange& change) { return causes_to_tell(likely_causes(change)); }

std::optional<std::size_t> lamp_that_tells(const LightChange& change, std::span<const ChangeCause> causes,
                                           std::span<const std::uint8_t> may, double level_share,
                                           const VectorXd& dip_error_lx) {
  check_sizes(change);
  const CauseJudge judge(change);
  std::optional<std::size_t> best;
  double most = 0;
  for (std::size_t f = 0; f < may.size(); ++f) {
    if (may[f] == 0 || !(change.level[static_cast<Index>(f)] > 0)) continue;
    double sum = 0, least = kTellsEnough;
    for (std::size_t k = 1; k < causes.size(); ++k) {
      const double apart = judge.apart_by_dip(causes.front(), causes[k], f, level_share, dip_error_lx);
      sum += std::min(kTellsEnough, apart);
      least = std::min(least, apart);
    }
    // One that tells all apart comes before one that tells some.
    const double worth = sum + static_cast<double>(causes.size()) * least;
    if (sum < kTells || worth <= most) continue;
    most = worth;
    best = f;
  }
  return best;
}

}  // namespace luxrig
