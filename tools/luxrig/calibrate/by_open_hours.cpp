#include "tools/luxrig/calibrate/by_open_hours.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>
#include <vector>

#include "core/calibration/open_run.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

/// In opening hours: no step takes less. Most take longer, by the rig's fade and its slowest meter.
constexpr double kShortestOpenStep_s = 2;
constexpr double kLikelyOpenStep_s = 4.3;
/// So slowly that nobody sees 2 %; and what the show has to correct at the end.
constexpr double kOpenFade_s = 1, kBackToTheShow_s = 20;

/// Which lamps take part, told before it begins.
void tell_of_open_hours(const Rig& rig, const OpenRun& run, double minutes) {
  for (const OpenRun::LeftOut& left : run.left_out())
    fmt::print("\"{}\" takes no part: {}.\n", rig.fixtures[left.fixture].name, left.why);
  fmt::print(
      "{} lamps are measured for {:.0f} minutes. No step changes the light at any place by more than {:.0f} %. The "
      "look is held meanwhile: the show corrects nothing and dims no lamp to find faults until the end.\n",
      run.part().size(), minutes, 100 * OpenRun::kLargestStep);
  std::fflush(stdout);
}

}  // namespace

Result<void> by_meters_in_open_hours(Measuring& measuring, double minutes) {
  const Rig& rig = measuring.session.rig;
  if (auto steady = measuring.daemon.wait_until_steady(measuring.stop); !steady) return steady;
  const auto look = measuring.daemon.levels_now();
  if (!look) return tl::unexpected(look.error());
  const double wanted_s = 60 * minutes;
  const OpenRun one_round(rig, *look, 1);
  const auto period = static_cast<double>(one_round.period());
  tell_of_open_hours(rig, one_round, minutes);
  if (one_round.plan().empty())
    return tl::unexpected(Fault{Cause::invalid,
                                "",
                                "no lamp can be measured so: apply a plan that lights lamps that dim, or measure with "
                                "--hours closed",
                                {}});
  if (period * kLikelyOpenStep_s > wanted_s)
    return tl::unexpected(
        Fault{Cause::invalid,
              "",
              fmt::format(
                  "{} lamps take about {:.0f} minutes; give it so many with --minutes, or measure with --hours closed",
                  one_round.part().size(), std::ceil(period * kLikelyOpenStep_s / 60)),
              {}});
  measuring.daemon.fade_in(kOpenFade_s, kBackToTheShow_s);
  using Steady = std::chrono::steady_clock;
  const auto progress = progress_line("measuring");
  const auto begun = Steady::now();
  const auto elapsed_s = [&] { return std::chrono::duration<double>(Steady::now() - begun).count(); };
  const int rounds = 1 + static_cast<int>(wanted_s / (kShortestOpenStep_s * period));
  std::vector<OpenRun> runs{OpenRun(rig, *look, rounds)};
  std::vector<double> before = *look;
  int limited = 0;
  double round_s = 0;
  for (std::size_t done = 0; elapsed_s() + round_s < wanted_s;) {
    OpenRun& run = runs.back();
    if (run.plan().empty() || done >= run.plan().size()) break;
    const double round_began_s = elapsed_s();
    bool small = true;
    const auto read = measuring.daemon.measure(
        std::span(run.plan()).subspan(done, run.period()), {},
        [&](std::size_t) {
          if (progress) progress(std::min(1.0, elapsed_s() / wanted_s));
        },
        measuring.stop,
        [&](const DaemonRig::Read& light) {
          small = run.is_small_step(before, light.sent);
          before = light.sent;
          return small;
        });
    if (!read) return tl::unexpected(read.error());
    for (std::size_t k = 0; k + (small ? 0 : 1) < read->size(); ++k) run.take((*read)[k].sent, (*read)[k].readings);
    round_s = elapsed_s() - round_began_s;
    done += run.period();
    if (small) continue;
    // A limit took light: it goes on from what is left.
    ++limited;
    done = 0;
    runs.emplace_back(rig, before, rounds);
  }
  if (limited > 0)
    fmt::print("{} times a limit took light from the look. That is the show's own; it was measured on from there.\n",
               limited);
  const OpenRun& longest = *std::max_element(
      runs.begin(), runs.end(), [](const OpenRun& a, const OpenRun& b) { return a.steps_taken() < b.steps_taken(); });
  measuring.light.read_at(
      Eigen::Map<const Eigen::VectorXd>(longest.look().data(), static_cast<Eigen::Index>(longest.look().size()))
          .cwiseMax(kDimmestLevel));
  std::vector<LightReading> readings;
  for (const OpenRun& run : runs)
    for (LightReading& reading : run.readings(*measuring.first_slope)) readings.push_back(std::move(reading));
  if (readings.empty())
    return tl::unexpected(
        Fault{Cause::invalid,
              "",
              fmt::format("in {:.0f} minutes the luxmeters told nothing of any lamp; give it more --minutes",
                          elapsed_s() / 60),
              {}});
  measuring.any = true;
  measuring.slope_of = longest.part();
  return measuring.light.learn(readings);
}

}  // namespace luxrig
