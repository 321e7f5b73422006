#include "tools/luxrig/calibrate/simulated_run.h"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "tools/process/meeting_place.h"
#include "tools/process/status_fields.h"

namespace luxrig {
namespace {

using namespace std::chrono_literals;

/// A look that is not held by then never will be.
constexpr auto kLongestCorrecting = 120s;
/// In the safe look, luxmeters have been read after this.
constexpr auto kSafeIsRead = 10s;

Fault no_run(Cause cause, std::string detail) { return {cause, "", std::move(detail), {}}; }

/// The status of the daemon on that port; null if there is none.
nlohmann::json status_on(int port) {
  const auto daemon = daemon_on(port);
  if (!daemon) return {};
  const auto answer = http_get(*daemon, "/api/status");
  return answer && answer->status == 200 ? nlohmann::json::parse(answer->body, nullptr, false) : nlohmann::json();
}

}  // namespace

Result<SimulatedRun> SimulatedRun::start(const std::filesystem::path& rig, const SimArguments& sim, int port,
                                         const std::stop_token& stop) {
  if (!status_on(port).is_null())
    return tl::unexpected(no_run(
        Cause::invalid, fmt::format("a daemon runs on port {} already; measure its rig without --sim, or give the "
                                    "simulated one another --port",
                                    port)));
  SimulatedRun run;
  const std::filesystem::path& folder = run.folder_.path();
  if (folder.empty())
    return tl::unexpected(no_run(Cause::system, "no temporary folder: " + std::string(std::strerror(errno))));
  auto child = ChildProcess::start("luxrigd",
                                   {rig.string(), "--sim", "--sim-seed", std::to_string(sim.seed), "--sim-deviations",
                                    sim.deviations, "--port", std::to_string(port)},
                                   {folder / "log", {}});
  if (!child) return tl::unexpected(child.error());
  run.child_.emplace(std::move(*child));
  fmt::print("A simulated rig starts, deviations {}, seed {}, and a daemon that lights it.\n", sim.deviations,
             sim.seed);
  std::fflush(stdout);
  if (auto held = run.wait_held(port, stop); !held) return tl::unexpected(held.error());
  return run;
}

Result<void> SimulatedRun::wait_held(int port, const std::stop_token& stop) {
  std::optional<std::chrono::steady_clock::time_point> answered;
  auto safe_since = std::chrono::steady_clock::now();
  while (true) {
    if (stop.stop_requested()) return tl::unexpected(no_run(Cause::cancelled, "stopped"));
    if (const auto code = child_->ended())
      return tl::unexpected(
          no_run(Cause::system, fmt::format("the daemon of the simulated rig ended (exit code {}): {}", *code,
                                            tail_of(folder_.path() / "log"))));
    const nlohmann::json status = status_on(port);
    const std::string phase = text_of(status, "phase");
    if (phase == "holding" || (phase == "safe" && flag_of(status, "may_be_measured"))) return {};
    const auto seen = std::chrono::steady_clock::now();
    if (phase != "safe") safe_since = seen;
    if (seen - safe_since > kSafeIsRead)
      return tl::unexpected(
          no_run(Cause::system, "the simulated rig is in its safe look: " + text_of(status, "detail")));
    const auto now = std::chrono::steady_clock::now();
    if (!status.is_null() && !answered) answered = now;
    if (answered && now - *answered > kLongestCorrecting)
      return tl::unexpected(no_run(Cause::system, fmt::format("the simulated rig is not lit after {:.0f} s: {}",
                                                              std::chrono::duration<double>(now - *answered).count(),
                                                              text_of(status, "detail"))));
    std::this_thread::sleep_for(50ms);
  }
}

}  // namespace luxrig
