#pragma once
/// What a run of a scenario showed.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace luxrig::scenario {

/// One expectation, or one rule that always holds.
struct Judged {
  std::string expected;  ///< "always lux drawing-* <= 50"; of a rule, its sentence
  bool held = true;
  std::optional<double> at_s;  ///< when it failed
  std::string found;           ///< "lux of drawing-1 is 52.3 lx"; empty if it held
  std::string why;             ///< of the file
  int line = 0;                ///< in the scenario; 0 for a rule
};

struct Trace {
  std::vector<std::string> columns;  ///< "lux drawing-1", "level spot-1", "phase"
  std::vector<double> at_s;
  std::vector<std::vector<double>> rows;  ///< per instant, a value per column
};

struct Happened {
  double at_s = 0;
  std::string text;
};

struct Outcome {
  std::uint64_t seed = 1;
  std::vector<Judged> expectations, rules;
  std::vector<Happened> events;      ///< and changes of phase
  std::vector<std::size_t> refused;  ///< events: commands that the daemon refused; not in files
  std::string error;                 ///< why there was no run, or a command's wrong answer; empty if all is well
  Trace trace;                       ///< empty unless asked for

  [[nodiscard]] bool passed() const {
    const auto held = [](const std::vector<Judged>& all) {
      for (const Judged& one : all)
        if (!one.held) return false;
      return true;
    };
    return error.empty() && held(expectations) && held(rules);
  }
};

}  // namespace luxrig::scenario
