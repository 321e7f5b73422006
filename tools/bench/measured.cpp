#include "tools/bench/measured.h"

#include <fmt/format.h>

#include <chrono>
#include <limits>

namespace luxrig {

Measured measure(const Method& method, const RayScene& rays, std::span<const Receiver> receivers,
                 std::span<const Emitter> emitters, const EvaluateOptions& options) {
  Measured run;
  const auto start = std::chrono::steady_clock::now();
  auto result = method.make(rays)->evaluate(receivers, emitters, options);
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (result) {
    run.matrix = std::move(*result);
  } else {
    run.refused = result.error().detail.empty() ? name_of(result.error().cause) : result.error().detail;
  }
  return run;
}

BenchRow row_of(const std::string& case_name, const std::string& method, double error, const Measured& run,
                std::optional<double> wanted_error, std::optional<double> target_error) {
  const bool refused = !run.refused.empty();
  const double rays = static_cast<double>(run.matrix.rays);
  std::string note = run.refused;
  for (char& c : note)
    if (c == ',' || c == '\n') c = ';';
  return {case_name,
          method,
          refused ? std::numeric_limits<double>::quiet_NaN() : error,
          run.seconds,
          refused ? std::nullopt : target_error,
          std::nullopt,
          {{"wanted_error", wanted_error ? fmt::format("{:g}", *wanted_error) : ""},
           {"reported_error", refused ? "" : fmt::format("{:.3g}", run.matrix.relative_error)},
           {"receivers", refused ? "" : fmt::format("{}", run.matrix.receivers())},
           {"rays", refused ? "" : fmt::format("{}", run.matrix.rays)},
           {"rays_per_second", refused || run.seconds <= 0 ? "" : fmt::format("{:.3g}", rays / run.seconds)},
           {"note", refused ? "refused: " + note : ""}}};
}

}  // namespace luxrig
