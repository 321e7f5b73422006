#pragma once
/// The evaluators under measurement, and one evaluation with its clock.

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
  double reflected_target;  ///< relative error its reflected light may have in `bench analytic`
};

/// Each with its line in methods.cpp.
[[nodiscard]] std::span<const Method> methods();

struct Measured {
  TransportMatrix matrix;
  double seconds = 0;   ///< making the evaluator and evaluating; the RayScene was there before
  std::string refused;  ///< what the evaluator said when it did not take the case
};

[[nodiscard]] Measured measure(const Method& method, const RayScene& rays, std::span<const Receiver> receivers,
                               std::span<const Emitter> emitters, const EvaluateOptions& options);

/// A row with the columns that all suites of evaluators have. A refused case has no error (NaN), and so no target.
[[nodiscard]] BenchRow row_of(const std::string& case_name, const std::string& method, double error,
                              const Measured& run, std::optional<double> wanted_error,
                              std::optional<double> target_error);

}  // namespace luxrig
