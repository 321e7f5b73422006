#pragma once
/// The evaluators to measure, and one timed evaluation.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/transport/evaluator.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

struct Method {
  const char* name;
  std::unique_ptr<Evaluator> (*make)(const RayScene&);
  bool reflects;            ///< claims interreflection, not only direct light
  double reflected_target;  ///< relative error allowed for its reflected light in `bench analytic`
};

/// Each with its line in methods.cpp.
[[nodiscard]] std::span<const Method> methods();

/// Time of a call, by the wall and by the processors. On a machine with other work only processor time is meaningful.
struct CallSeconds {
  double wall = 0;
  double cpu = 0;  ///< of all threads of the process
};
[[nodiscard]] CallSeconds timed(const std::function<void()>& call);

/// Middle of three, upper middle of an even number; NaN if empty.
[[nodiscard]] double median_of(std::vector<double> values);
/// The median of wall time and that of processor time, separately.
[[nodiscard]] CallSeconds median_of(std::span<const CallSeconds> calls);

struct Measured {
  TransportMatrix matrix;
  double seconds = 0;      ///< making the evaluator and evaluating; without making the RayScene
  double cpu_seconds = 0;  ///< the same in processor time; 0 if not measured
  std::string refused;     ///< the evaluator's reason, if it refused the case
};

[[nodiscard]] Measured measure(const Method& method, const RayScene& rays, std::span<const Receiver> receivers,
                               std::span<const Emitter> emitters, const EvaluateOptions& options);

/// A row with the columns of all suites of evaluators. A refused case has no error (NaN) and so no target.
[[nodiscard]] BenchRow row_of(const std::string& case_name, const std::string& method, double error,
                              const Measured& run, std::optional<double> wanted_error,
                              std::optional<double> target_error);

}  // namespace luxrig
