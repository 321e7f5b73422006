#pragma once
/// Model of a daemon's promises. An acknowledged change is in force until it is changed again, also after any restart.
/// A refused one has changed nothing. A blackout is dark. Random sequences of commands, faults, kills and disk errors
/// are checked against it. A sequence that breaks a promise is shrunk to the shortest that still does.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace luxrig::promises {

enum class Act { blackout, lift, apply, hold, release, refuse, fault, well, disk_fails, disk_is_well, kill, end, wait, stall };

struct Step {
  Act act = Act::wait;
  std::size_t which = 0;  ///< plan, lamp, fault, or kind of request to refuse
  double value = 0;       ///< level or seconds
};

/// Commands to the rig under test; each returns whether it was acknowledged.
class Subject {
 public:
  virtual ~Subject() = default;
  virtual bool blackout(bool on) = 0;
  virtual bool apply(std::size_t plan) = 0;
  virtual bool hold(std::size_t lamp, double level) = 0;
  virtual bool release() = 0;
  /// A request that must be refused.
  virtual bool nonsense(std::size_t kind) = 0;
  virtual void fault(std::size_t which, bool on) = 0;
  virtual void disk(bool fails) = 0;
  /// Ends, in order or as by a power cut, and starts again.
  virtual void restart(bool in_order) = 0;
  /// Stalls the control loop for this long.
  virtual void stall(double seconds) = 0;
  virtual void wait(double seconds) = 0;

  struct Seen {
    bool blackout = false;
    std::optional<std::size_t> plan;       ///< in force; none if it is not one of our plans
    bool plan_waits = false;               ///< a plan waits until a failure is over
    std::map<std::size_t, double> by_hand; ///< lamps held
  };
  virtual Seen seen() = 0;
  /// A fault of the light itself since the last call: light in a blackout, an exceeded limit, a jump. Empty if none.
  virtual std::string broken() = 0;
  /// From now on every frame must be dark (true) or may be lit (false).
  virtual void expect_dark(bool dark) = 0;
};

/// The present value, and the values allowed after a restart: an unsaved change may be there or not.
template <class T>
struct Kept {
  T live{};
  std::set<T> may{T{}};
  void acknowledged(T value) {
    live = value;
    may = {value};
  }
  void unsaved(T value) {
    live = value;
    may.insert(value);
  }
};

class Model {
 public:
  /// The first broken promise, in words; empty if none is broken.
  std::string run(Subject& subject, const std::vector<Step>& steps) {
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const std::string why = take(subject, steps[i]);
      if (!why.empty()) return fmt::format("step {}: {}", i, why);
    }
    // Once all faults are gone, a waiting plan comes into force.
    for (const Step& step : steps)
      if (step.act == Act::fault) subject.fault(step.which, false);
    subject.disk(false);
    for (int s = 0; s < kLongestRecovery_s && subject.seen().plan_waits; ++s) subject.wait(1);
    const Subject::Seen seen = subject.seen();
    if (seen.plan_waits) return "all is well, and a plan still waits";
    if (seen.plan.value_or(kNoPlan) != plan_.live)
      return fmt::format("all is well, and plan {} is in force instead of {}", seen.plan.value_or(kNoPlan), plan_.live);
    return {};
  }

 private:
  using Hands = std::map<std::size_t, double>;
  /// A dead unit is retried within some seconds, then the light fades in.
  static constexpr int kLongestRecovery_s = 30;

  /// An acknowledged save contains the whole present state.
  void all_saved() {
    blackout_.acknowledged(blackout_.live);
    plan_.acknowledged(plan_.live);
    hands_.acknowledged(hands_.live);
  }
  template <class T>
  void done(Kept<T>& what, T value, bool acknowledged) {
    if (!acknowledged) return what.unsaved(value);
    what.live = value;
    all_saved();
  }

  std::string take(Subject& subject, const Step& step) {
    switch (step.act) {
      case Act::blackout:
      case Act::lift: {
        const bool on = step.act == Act::blackout;
        const bool acknowledged = subject.blackout(on);
        done(blackout_, on, acknowledged);
        if (!acknowledged && !disk_fails_) return "a blackout was not acknowledged, though the disk is well";
        break;
      }
      case Act::apply: {
        // Refused if it cannot be saved; then nothing has changed.
        if (subject.apply(step.which)) {
          plan_.live = step.which;
          all_saved();
        } else if (!disk_fails_) {
          return "a plan was not acknowledged, though the disk is well";
        }
        break;
      }
      case Act::hold: {
        Hands hands = hands_.live;
        hands[step.which] = step.value;
        const bool acknowledged = subject.hold(step.which, step.value);
        done(hands_, hands, acknowledged);
        if (!acknowledged && !disk_fails_) return "a level by hand was not acknowledged, though the disk is well";
        break;
      }
      case Act::release: {
        const bool acknowledged = subject.release();
        done(hands_, Hands{}, acknowledged);
        if (!acknowledged && !disk_fails_) return "a release was not acknowledged, though the disk is well";
        break;
      }
      case Act::refuse:
        if (subject.nonsense(step.which)) return "nonsense was acknowledged";
        break;
      case Act::fault:
      case Act::well:
        subject.fault(step.which, step.act == Act::fault);
        break;
      case Act::disk_fails:
      case Act::disk_is_well:
        disk_fails_ = step.act == Act::disk_fails;
        subject.disk(disk_fails_);
        break;
      case Act::kill:
      case Act::end: {
        subject.expect_dark(!blackout_.may.contains(false));  // from its first frame on
        subject.restart(step.act == Act::end);
        const Subject::Seen after = subject.seen();
        if (!blackout_.may.contains(after.blackout))
          return after.blackout ? "after a restart there is a blackout that nobody asked for"
                                : "after a restart an acknowledged blackout is gone";
        blackout_.live = after.blackout;
        if (after.plan && !plan_.may.contains(*after.plan))
          return fmt::format("after a restart plan {} is in force, not the acknowledged one", *after.plan);
        if (!after.plan && !plan_.may.contains(kNoPlan)) return "after a restart an acknowledged plan is gone";
        plan_.live = after.plan.value_or(kNoPlan);
        if (!hands_.may.contains(after.by_hand)) return "after a restart levels by hand are others than acknowledged";
        hands_.live = after.by_hand;
        if (!disk_fails_) all_saved();
        break;
      }
      case Act::stall:
        subject.stall(step.value);
        break;
      case Act::wait:
        subject.wait(step.value);
        break;
    }
    subject.expect_dark(blackout_.live);
    subject.wait(0.1);
    if (const std::string broken = subject.broken(); !broken.empty()) return broken;
    const Subject::Seen seen = subject.seen();
    if (seen.blackout != blackout_.live) return seen.blackout ? "there is a blackout" : "the blackout is gone";
    if (!seen.plan_waits && seen.plan.value_or(kNoPlan) != plan_.live)
      return fmt::format("plan {} is in force instead of {}", seen.plan.value_or(kNoPlan), plan_.live);
    if (seen.by_hand != hands_.live) return "what is held by hand is not what was asked";
    return {};
  }

 public:
  static constexpr std::size_t kNoPlan = 99;

 private:
  Kept<bool> blackout_;
  Kept<std::size_t> plan_{kNoPlan, {kNoPlan}};
  Kept<Hands> hands_;
  bool disk_fails_ = false;
};

struct Extent {
  std::size_t plans = 3, lamps = 4, faults = 6, nonsense = 4;
  double longest_wait_s = 4;
};

inline std::vector<Step> random_steps(std::uint64_t seed, const Extent& extent) {
  std::mt19937_64 random(seed);
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  struct Chance {
    Act act;
    double weight;
    std::size_t of;
  };
  const Chance chances[] = {{Act::wait, 6, 1},
                            {Act::blackout, 2, 1},
                            {Act::lift, 2, 1},
                            {Act::apply, 3, extent.plans},
                            {Act::hold, 2, extent.lamps},
                            {Act::release, 1, 1},
                            {Act::refuse, 1, extent.nonsense},
                            {Act::fault, 2, extent.faults},
                            {Act::well, 2, extent.faults},
                            {Act::disk_fails, 1, 1},
                            {Act::disk_is_well, 1.5, 1},
                            {Act::kill, 2, 1},
                            {Act::end, 1, 1},
                            {Act::stall, 1, 1}};
  double all = 0;
  for (const Chance& chance : chances) all += chance.weight;
  std::vector<Step> steps(4 + random() % 16);
  for (Step& step : steps) {
    double at = share() * all;
    const Chance* drawn = chances;
    while (at > drawn->weight && drawn + 1 < std::end(chances)) at -= (drawn++)->weight;
    step = {drawn->act, random() % drawn->of, 0};
    if (step.act == Act::hold) step.value = static_cast<double>(random() % 17) / 16;
    if (step.act == Act::wait) step.value = share() * extent.longest_wait_s;
    if (step.act == Act::stall) step.value = 0.03 + 2 * share() * share();
  }
  return steps;
}

inline std::string in_words(const std::vector<Step>& steps) {
  static constexpr const char* names[] = {"blackout", "lift", "apply", "hold", "release", "refuse", "fault",
                                          "well", "disk fails", "disk is well", "kill", "end", "wait", "stall"};
  std::string text;
  for (std::size_t i = 0; i < steps.size(); ++i)
    text += fmt::format("  {:2} {} {} {:.3g}\n", i, names[static_cast<std::size_t>(steps[i].act)], steps[i].which,
                        steps[i].value);
  return text;
}

/// The shortest sequence that still `fails`, found by leaving out ever smaller parts.
inline std::vector<Step> shrunk(std::vector<Step> steps, const std::function<bool(const std::vector<Step>&)>& fails) {
  for (std::size_t part = std::max<std::size_t>(1, steps.size() / 2);; part = std::max<std::size_t>(1, part / 2)) {
    bool shorter = false;
    for (std::size_t at = 0; at < steps.size();) {
      std::vector<Step> tried = steps;
      tried.erase(tried.begin() + static_cast<std::ptrdiff_t>(at),
                  tried.begin() + static_cast<std::ptrdiff_t>(std::min(at + part, tried.size())));
      if (!tried.empty() && fails(tried)) {
        steps = std::move(tried);
        shorter = true;
      } else {
        at += part;
      }
    }
    if (part == 1 && !shorter) return steps;
  }
}

}  // namespace luxrig::promises
