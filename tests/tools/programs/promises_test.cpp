// The promises against the programs themselves: real processes, signals, sockets and files, in real time.
#include "tests/promises/promises.h"

#include <cstdlib>

#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

using promises::Model;
using promises::Step;

class LiveSubject final : public promises::Subject {
 public:
  LiveSubject() : rig_(source("tests/rigs/room")) {
    EXPECT_TRUE(rig_.wait_phase("holding", 60s)) << rig_.daemon().output();
    const auto plan = rig_.file("plan.json").string();
    EXPECT_EQ(run({program("luxrig"), "solve", source("tests/rigs/room"), "-o", plan}).code, 0);
    const json solved = json::parse(text_of(plan), nullptr, false);
    for (std::size_t k = 0; k < kPlans; ++k) {
      json changed = solved;
      for (json& point : changed["points"])
        if (point["name"] == kTellingPoint) point["goal_lux"] = goal_of(k);
      std::ofstream(plan_file(k)) << changed.dump();
    }
  }

  bool blackout(bool on) override {
    const Ran ran = asked({"blackout", on ? "on" : "off"});
    if (ran.code == 0 || !field_may_be_dead()) return ran.code == 0;
    // Lamps on a dead bus cannot be made dark: this is the only complaint allowed then.
    const auto says = [&](const char* what) { return ran.output.find(what) != std::string::npos; };
    return says("lamps may be lit: bus \"field\"") && !says("forgotten");
  }
  bool apply(std::size_t plan) override { return ask({"apply", plan_file(plan)}); }
  bool hold(std::size_t lamp, double level) override {
    return ask({"level", lamp_name(lamp), std::to_string(level)});
  }
  bool release() override { return ask({"release", "all"}); }
  bool nonsense(std::size_t kind) override {
    switch (kind) {
      case 0: {
        const auto file = rig_.file("nonsense.json").string();
        std::ofstream(file) << "{\"tasks\": [[[";
        return ask({"apply", file});
      }
      case 1:
        return ask({"level", "nobody", "0.5"});
      default:
        return ask({"level", lamp_name(0), "1.5"});
    }
  }
  void fault(std::size_t which, bool on) override {
    const char* faults[][2] = {{"meter-1", "silent"}, {"meter-2", "lost"}, {"meter-1", "stuck"}, {"field", "dead"}};
    rig_.fault(faults[which][0], faults[which][1], on, which == 1 ? 0.5 : 1);
    if (which != 3) return;
    if (field_dead_ && !on) field_well_since_ = std::chrono::steady_clock::now();
    field_dead_ = on;
  }
  void disk(bool fails) override {
    std::error_code ignored;
    const auto in_the_way = rig_.file("state/state.json.new");
    if (fails) {
      std::filesystem::create_directory(in_the_way, ignored);
    } else {
      std::filesystem::remove(in_the_way, ignored);
    }
  }
  void restart(bool in_order) override {
    rig_.daemon().signal(in_order ? SIGTERM : SIGKILL);
    if (in_order && rig_.daemon().wait(20s) != 0) broken_ = "does not end in order: " + rig_.daemon().output();
    rig_.start_daemon();
    if (!rig_.wait_status([](const json& s) { return s["phase"] != "idle"; }, 30s))
      broken_ = "does not start: " + rig_.daemon().output();
  }
  void stall(double seconds) override {
    rig_.daemon().signal(SIGSTOP);
    watch(seconds);
    rig_.daemon().signal(SIGCONT);
  }
  void wait(double seconds) override { watch(seconds); }

  Seen seen() override {
    // The status is at most a tenth of a second old.
    std::this_thread::sleep_for(200ms);
    Seen seen;
    if (!rig_.wait_status([](const json&) { return true; }, 10s)) {
      broken_ = "does not answer: " + rig_.daemon().output();
      return seen;
    }
    const json& status = rig_.last();
    seen.blackout = status["blackout"];
    seen.plan_waits = status["plan_waits"];
    for (const json& point : status["points"])
      for (std::size_t k = 0; k < kPlans; ++k)
        if (point["name"] == kTellingPoint && std::abs(point.value("goal_lux", 0.0) - goal_of(k)) < 1e-6) seen.plan = k;
    for (const json& held : status["overrides"])
      for (std::size_t lamp = 0; lamp < kLamps; ++lamp)
        if (held["name"] == lamp_name(lamp) && !held.contains("of_plan")) seen.by_hand[lamp] = held["level"];
    return seen;
  }
  std::string broken() override {
    const json truth = rig_.truth();
    if (broken_.empty() && truth.is_object() && !truth["violations"].empty())
      broken_ = "a limit was exceeded: " + truth["violations"].dump();
    return std::exchange(broken_, {});
  }
  void expect_dark(bool dark) override {
    if (dark && !dark_) dark_since_ = std::chrono::steady_clock::now();
    dark_ = dark;
  }

  static constexpr std::size_t kPlans = 3, kLamps = 2;

 private:
  static constexpr const char* kTellingPoint = "floor";
  static constexpr auto kLampGoesOut = 1s;  ///< generous
  static constexpr auto kBusIsFoundAgain = 10s;
  static constexpr const char* kLampOnField = "bulb-1";

  [[nodiscard]] static double goal_of(std::size_t plan) { return 100 + 5 * static_cast<double>(plan); }
  [[nodiscard]] static std::string lamp_name(std::size_t lamp) { return lamp == 0 ? "spot-1" : "bulb-1"; }
  [[nodiscard]] std::string plan_file(std::size_t plan) const {
    return rig_.file("plan-" + std::to_string(plan) + ".json").string();
  }
  bool ask(std::vector<std::string> words) { return asked(std::move(words)).code == 0; }
  Ran asked(std::vector<std::string> words) {
    if (rig_.port() == 0) (void)rig_.status();
    words.insert(words.begin(), program("luxrig"));
    words.insert(words.end(), {"--port", std::to_string(rig_.port())});
    return run(words, 30s);
  }
  [[nodiscard]] bool field_may_be_dead() const {
    return field_dead_ || std::chrono::steady_clock::now() - field_well_since_ < kBusIsFoundAgain;
  }
  void watch(double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    do {
      const json truth = rig_.truth();
      if (dark_ && std::chrono::steady_clock::now() - dark_since_ > kLampGoesOut && truth.is_object())
        for (const json& lamp : truth["fixtures"])
          if (lamp["level"].get<double>() > 0.01 && broken_.empty() &&
              !(lamp["name"] == kLampOnField && field_may_be_dead()))
            broken_ = "lit in a blackout: " + lamp.dump();
      std::this_thread::sleep_for(50ms);
    } while (std::chrono::steady_clock::now() < end);
  }

  LiveRig rig_;
  std::string broken_;
  bool dark_ = false, field_dead_ = false;
  std::chrono::steady_clock::time_point field_well_since_{};
  std::chrono::steady_clock::time_point dark_since_;
};

// LUXRIG_PROMISES_LIVE: number of sequences, LUXRIG_PROMISES_FIRST: the first one; tools/nightly runs 200.
TEST(PromisesOverTheWire, HoldThroughRandomCommandsFaultsKillsAndDiskErrors) {
  const auto number = [](const char* name, std::uint64_t otherwise) {
    const char* wanted = std::getenv(name);
    return wanted != nullptr ? std::strtoull(wanted, nullptr, 10) : otherwise;
  };
  const std::uint64_t first = number("LUXRIG_PROMISES_FIRST", 1), count = number("LUXRIG_PROMISES_LIVE", 3);
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const std::vector<Step> steps =
        promises::random_steps(seed, {LiveSubject::kPlans, LiveSubject::kLamps, 4, 3, 1.5});
    LiveSubject subject;
    const std::string why = Model().run(subject, steps);
    ASSERT_EQ(why, "") << "sequence " << seed << "\n" << promises::in_words(steps);
  }
}

}  // namespace
}  // namespace luxrig::testing
