#include "core/solve/placement/place_lights.h"

#include "core/check.h"

namespace luxrig {
namespace {

constexpr std::uint64_t kMaxStarts = 1'000;
/// If the error of one of two starts is below this share of the other's, no race is needed.
constexpr double kClearlyBetter = 0.85;
constexpr int kRaceRounds = 2;

class Search {
 public:
  Search(const MovableLight& light, const LightingGoal& goal, const ComplementSearch& candidates,
         const PlaceOptions& options)
      : options_(options), exchange_(candidates, options.exchange), none_(light, goal), best_{none_, 0, 0} {}

  Placement run() {
    int idle = 0;
    for (std::uint64_t start = 0; !ended() && start < kMaxStarts && idle < options_.max_idle_starts; ++start) {
      ++best_.starts;
      const double best_error = best_.lights.error();
      std::mt19937_64 random(options_.seed * 0x9E3779B97F4A7C15ull + start);
      PlacedLights lights = added_one_by_one(start, random);
      offer(lights);
      begin_otherwise(lights, start);
      while (!ended() && exchanged(lights, random)) offer(lights);
      offer(lights);
      idle = best_.lights.error() < (1 - options_.min_progress) * best_error ? 0 : idle + 1;
    }
    best_.columns = exchange_.columns();
    return std::move(best_);
  }

 private:
  [[nodiscard]] bool ended() const {
    return options_.exchange.watch.stop.stop_requested() || best_.lights.error() <= options_.wanted_error ||
           exchange_.columns() >= options_.max_columns;
  }

  /// Replaces the lights with the other start if the goal is hard and that start is better.
  void begin_otherwise(PlacedLights& lights, std::uint64_t start) {
    if (ended() || !options_.other || !options_.start.empty() || lights.error() <= kHardGoalError) return;
    auto other = begun_otherwise(exchange_, none_, options_.other, options_.lights, options_.seed + start,
                                 [this] { return ended(); });
    if (!other || other->error() > lights.error() / kClearlyBetter) return;
    offer(*other);
    if (other->error() > kClearlyBetter * lights.error()) {
      // Two similar starts show only after a few exchanges which one ends lower.
      std::mt19937_64 random(options_.seed + start);
      for (PlacedLights* way : {&lights, &*other}) {
        for (int round = 0; round < kRaceRounds && !ended() && exchange_.singly(*way, random); ++round) {
        }
        offer(*way);
      }
    }
    if (other->error() < lights.error()) lights = std::move(*other);
  }

  /// False when nothing improves it enough.
  bool exchanged(PlacedLights& lights, std::mt19937_64& random) {
    const double enough = (1 - options_.min_progress) * lights.error();
    const auto more_than_enough = [&](bool changed) { return changed && lights.error() < enough; };
    return more_than_enough(exchange_.singly(lights, random)) || more_than_enough(exchange_.by_twos(lights)) ||
           more_than_enough(exchange_.through_more(lights, 2, random)) ||
           more_than_enough(exchange_.through_more(lights, 4, random));
  }

  void offer(const PlacedLights& lights) {
    if (best_.lights.size() > 0 && !(lights.error() < best_.lights.error())) return;
    best_.lights = lights;
    if (options_.better) options_.better(best_.lights, exchange_.columns());
  }

  /// The first start takes the best candidate each time, later ones one of the three best.
  PlacedLights added_one_by_one(std::uint64_t start, std::mt19937_64& random) {
    PlacedLights lights = none_;
    if (start == 0)
      for (const LightPose& pose : options_.start)
        if (lights.size() < options_.lights) lights.add(pose);
    while (lights.size() < options_.lights && !options_.exchange.watch.stop.stop_requested())
      if (!exchange_.with_one_more(lights, start == 0 ? 1 : 3, random)) break;
    exchange_.refine(lights);
    return lights;
  }

  const PlaceOptions& options_;
  LightExchange exchange_;
  PlacedLights none_;
  Placement best_;
};

}  // namespace

Placement place_lights(const MovableLight& light, const LightingGoal& goal, const ComplementSearch& candidates,
                       const PlaceOptions& options) {
  LUXRIG_CHECK(options.lights > 0, "{} lights", options.lights);
  return Search(light, goal, candidates, options).run();
}

}  // namespace luxrig
