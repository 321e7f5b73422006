#include "tools/luxrig/calibrate/by_hand.h"

#include <algorithm>
#include <functional>

#include "core/calibration/lamp_steps.h"
#include "tools/luxrig/calibrate/hand_meter.h"
#include "tools/luxrig/calibrate/simulated_hand.h"

namespace luxrig {
namespace {

std::string place_words(const Point& point) {
  return fmt::format("Hold the luxmeter at \"{}\": x {:.2f} m, y {:.2f} m, {:.2f} m high, {}.", point.name,
                     point.position_world_m.x(), point.position_world_m.y(), point.position_world_m.z(),
                     facing_words(point.normal_world));
}

/// For the page: what is asked at this step of the place.
HandQuestion question_of(const Measuring& measuring, const HandPlace& place, std::size_t k) {
  const Rig& rig = measuring.session.rig;
  const Point& point = rig.points[place.point];
  const LampStep& step = place.steps[k];
  const GoalError known = measuring.light.error_of_goals(measuring.levels.use);
  HandQuestion question;
  question.text = place_words(point);
  question.position_world_m = point.position_world_m;
  question.normal_world = point.normal_world;
  if (step.level > 0) {
    question.fixture = rig.fixtures[step.fixture].name;
    question.level = std::min(1.0, step.level);
  }
  question.step = static_cast<int>(k + 1);
  question.steps = static_cast<int>(place.steps.size());
  question.readings = measuring.by_hand;
  if (known.goals > 0) {
    question.known_to = known.rms;
    question.known_to_worst = known.worst;
  }
  return question;
}

/// Answers at one place, under the light that is set. what: at the terminal.
using Asking = std::function<Result<HandAnswer>(const std::string& what, const HandPlace& place, std::size_t k)>;

/// One place; false = the person is done.
Result<bool> at_place(Measuring& measuring, HandPlace place, const Asking& ask) {
  const Rig& rig = measuring.session.rig;
  std::vector<std::optional<double>> lux(place.steps.size());
  bool done = false;
  for (std::size_t k = 0; k < place.steps.size(); ++k) {
    LampStep& step = place.steps[k];
    const auto sent = measuring.daemon.light(levels_of(step, rig), measuring.stop);
    if (!sent)
      return tl::unexpected(Fault{sent.error().cause, "", words_of(step, rig) + ": " + sent.error().detail, {}});
    step.level = (*sent)[step.fixture];
    const auto answer = ask(fmt::format("{} of {}, {}", k + 1, place.steps.size(), words_of(step, rig)), place, k);
    if (!answer) return tl::unexpected(answer.error());
    done = answer->what == HandAnswer::What::done;
    if (done || answer->what == HandAnswer::What::other_place) break;
    if (answer->what != HandAnswer::What::reading) continue;
    lux[k] = answer->lux;
    ++measuring.by_hand;
  }
  // Without the dark, light of no lamp would count as theirs.
  const auto readings = lux.front() ? readings_at(rig, place, lux, measuring.curves) : std::vector<LightReading>{};
  if (readings.empty()) return !done;
  if (auto learnt = measuring.light.learn(readings); !learnt) return tl::unexpected(learnt.error());
  const GoalError now = measuring.light.error_of_goals(measuring.levels.use);
  fmt::print("Now the light at {} goals is known to {}.\n\n", now.goals, known_words(now));
  measuring.any = true;
  return !done;
}

/// One place after the other, until the person is done or none would help.
Result<void> at_best_places(Measuring& measuring, std::optional<int> most, const Asking& ask) {
  std::vector<std::size_t> been = measuring.no_points();
  for (int places = 0; !most || places < *most; ++places) {
    const Rig& rig = measuring.session.rig;
    const auto place = next_hand_place(rig, measuring.light, measuring.levels, measuring.curves, been);
    if (!place) {
      fmt::print("There is no further place that would help.\n");
      break;
    }
    fmt::print("{}\n", place_words(rig.points[place->point]));
    const auto more = at_place(measuring, *place, ask);
    if (!more) return tl::unexpected(more.error());
    if (!*more) break;
    been.push_back(place->point);
  }
  return {};
}

}  // namespace

Result<void> measure_by_hand(Measuring& measuring, const std::optional<std::filesystem::path>& meter_file) {
  PageQuestion page(measuring.daemon.daemon(), DaemonRig::kHeld_s);
  HandMeter meter(meter_file, page);
  fmt::print(
      "Type each reading in lux{}. s skips a lamp, n goes to another place, q ends. The daemon's page asks, too: "
      "luxrig page opens it.\n\n",
      meter.has_file() ? ", or Enter alone to take it from the meter's file" : "");
  return at_best_places(measuring, std::nullopt, [&](const std::string& what, const HandPlace& place, std::size_t k) {
    return meter.ask(
        what, question_of(measuring, place, k), DaemonRig::kHoldAgain, [&] { return measuring.daemon.hold_again(); },
        measuring.stop);
  });
}

Result<void> measure_by_simulated_hand(Measuring& measuring, int places, const std::string& world) {
  if (!measuring.daemon.sim_control()) return refusal("the daemon's rig is real: somebody has to hold the luxmeter");
  SimulatedHand hand(*measuring.daemon.sim_control(), world);
  fmt::print("A simulated hand holds the luxmeter, at {} places at most.\n\n", places);
  return at_best_places(measuring, places, [&](const std::string& what, const HandPlace& place, std::size_t) {
    auto answer = hand.read(measuring.session.rig.points[place.point], measuring.stop);
    if (answer) fmt::print("  {}: {}\n", what, words_of(*answer));
    return answer;
  });
}

}  // namespace luxrig
