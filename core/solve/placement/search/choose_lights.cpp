#include "core/solve/placement/search/choose_lights.h"

#include <algorithm>

#include "core/check.h"

namespace luxrig {
namespace {

/// Lights added beyond the chosen number: that number / kBeyondOf, at least kMinBeyond.
constexpr std::size_t kMinBeyond = 2;
constexpr std::size_t kBeyondOf = 5;
/// In units of the wanted error.
constexpr double kNearlyWanted = 10;

class Choice {
 public:
  Choice(const MovableLight& light, const LightingGoal& goal, const ComplementSearch& candidates,
         const ChooseOptions& options)
      : options_(options), exchange_(candidates, options.exchange), random_(options.seed) {
    curve_.cuts.emplace_back(light, goal);
  }

  LightCurve run() {
    PlacedLights lights = way_up();
    way_down(std::move(lights));
    begin_otherwise();
    do {
      while (!ended() && better_at(curve_.chosen)) {
      }
    } while (!ended() && look_ahead());
    while (!ended() && fewer_will_do()) {
    }
    if (options_.whole_curve) fill_curve();
    curve_.columns = exchange_.columns();
    return std::move(curve_);
  }

 private:
  [[nodiscard]] bool ended() const {
    return options_.exchange.watch.stop.stop_requested() || exchange_.columns() >= options_.max_columns;
  }
  [[nodiscard]] double error(std::size_t lights) const {
    return curve_.cuts[std::min(lights, curve_.cuts.size() - 1)].error();
  }

  /// Keeps them if they are the best of their number; true if so.
  bool offer(const PlacedLights& lights) {
    const std::size_t count = lights.size();
    while (curve_.cuts.size() < count) curve_.cuts.push_back(curve_.cuts.back());
    if (curve_.cuts.size() == count)
      curve_.cuts.push_back(lights);
    else if (lights.error() < curve_.cuts[count].error())
      curve_.cuts[count] = lights;
    else
      return false;
    for (std::size_t more = count + 1; more < curve_.cuts.size() && lights.error() < curve_.cuts[more].error(); ++more)
      curve_.cuts[more] = lights;
    const std::size_t was = curve_.chosen;
    const double was_error = chosen_error_;
    curve_.chosen = fewest_worth_it(
        curve_.cuts.size(), [&](std::size_t k) { return error(k); }, options_.number);
    chosen_error_ = error(curve_.chosen);
    if (options_.better && (curve_.chosen != was || chosen_error_ < was_error))
      options_.better(curve_.cuts[curve_.chosen], exchange_.columns());
    return true;
  }

  PlacedLights way_up() {
    PlacedLights lights = curve_.cuts.front();
    for (const LightPose& pose : options_.start) lights.add(pose);
    if (lights.size() > 0) {
      exchange_.refine(lights);
      offer(lights);
    }
    while (!ended() && lights.size() < options_.max_lights && lights.error() > options_.number.wanted_error) {
      if (!exchange_.with_one_more(lights, 1, random_)) break;
      offer(lights);
      if (lights.size() >= curve_.chosen + std::max(kMinBeyond, curve_.chosen / kBeyondOf)) break;
    }
    return lights;
  }

  /// From more lights than needed down to one fewer than chosen.
  void way_down(PlacedLights lights) {
    exchange_.refine(lights);
    offer(lights);
    while (!ended() && lights.size() > 1 && lights.size() + 1 > curve_.chosen) {
      lights = exchange_.without_one(lights);
      exchange_.singly(lights, random_);
      if (lights.size() < curve_.cuts.size() && error(lights.size()) < lights.error())
        lights = curve_.cuts[lights.size()];
      offer(lights);
    }
  }

  /// If the goal is hard, starts the chosen number the other way.
  void begin_otherwise() {
    if (ended() || !options_.other || !options_.start.empty() || chosen_error_ <= kHardGoalError) return;
    const auto other = begun_otherwise(exchange_, curve_.cuts.front(), options_.other, curve_.chosen, options_.seed,
                                       [this] { return ended(); });
    if (other) offer(*other);
  }

  /// Whether more lights are worth it after all, from the present best.
  bool look_ahead() {
    const std::size_t was = curve_.chosen;
    PlacedLights lights = curve_.cuts[was];
    if (lights.error() <= options_.number.wanted_error) return false;
    for (int more = 0; more < 2 && lights.size() < options_.max_lights && !ended(); ++more) {
      if (!exchange_.with_one_more(lights, 1, random_)) break;
      exchange_.singly(lights, random_);
      offer(lights);
    }
    return curve_.chosen > was;
  }

  void fill_curve() {
    for (std::size_t k = curve_.chosen; k-- > 1 && !ended();) {
      PlacedLights lights = exchange_.without_one(curve_.cuts[k + 1]);
      if (error(k) < lights.error()) lights = curve_.cuts[k];
      exchange_.singly(lights, random_);
      offer(lights);
    }
  }

  /// Whether one light fewer, if nearly good enough, can be made good enough.
  bool fewer_will_do() {
    const std::size_t was = curve_.chosen;
    if (was < 2 || chosen_error_ > options_.number.wanted_error ||
        error(was - 1) > kNearlyWanted * options_.number.wanted_error)
      return false;
    while (!ended() && better_at(was - 1)) {
    }
    return curve_.chosen < was;
  }

  bool better_at(std::size_t count) {
    PlacedLights lights = curve_.cuts[count];
    const double was = lights.error();
    if (was <= options_.number.wanted_error || lights.size() == 0) return false;
    if (!exchange_.singly(lights, random_) && !exchange_.by_twos(lights) &&
        !exchange_.through_more(lights, kMinBeyond, random_))
      return false;
    return offer(lights) && lights.error() < (1 - options_.min_progress) * was;
  }

  const ChooseOptions& options_;
  LightExchange exchange_;
  std::mt19937_64 random_;
  LightCurve curve_;
  double chosen_error_ = 1;
};

}  // namespace

LightCurve choose_lights(const MovableLight& light, const LightingGoal& goal, const ComplementSearch& candidates,
                         const ChooseOptions& options) {
  LUXRIG_CHECK(options.max_lights > 0, "{} lights", options.max_lights);
  return Choice(light, goal, candidates, options).run();
}

}  // namespace luxrig
