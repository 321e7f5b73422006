#include "tools/bench/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <limits>

#include "tools/bench/row_progress.h"

namespace luxrig {

CallSeconds timed(const std::function<void()>& call) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t cpu_start = std::clock();
  call();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC};
}

double median_of(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

CallSeconds median_of(std::span<const CallSeconds> calls) {
  std::vector<double> wall, cpu;
  for (const CallSeconds& one : calls) wall.push_back(one.wall), cpu.push_back(one.cpu);
  return {median_of(std::move(wall)), median_of(std::move(cpu))};
}

Measured measure(const Method& method, const RayScene& rays, std::span<const Receiver> receivers,
                 std::span<const Emitter> emitters, const EvaluateOptions& options) {
  Measured run;
  Result<TransportMatrix> result = TransportMatrix{};
  const CallSeconds took = timed([&] { result = method.make(rays)->evaluate(receivers, emitters, options); });
  run.seconds = took.wall;
  run.cpu_seconds = took.cpu;
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
  BenchRow row{case_name,
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
  say_row_made(row);
  return row;
}

}  // namespace luxrig
