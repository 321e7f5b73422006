#include "tools/process/sim_process.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "tools/http/client.h"
#include "tools/process/files.h"

namespace luxrig {
namespace {

Fault fault_of(std::string detail) { return {Cause::system, "luxrig-sim", std::move(detail), {}}; }

}  // namespace

Result<SimProcess> SimProcess::start(const std::filesystem::path& rig, std::uint64_t seed,
                                     const std::string& deviations) {
  std::string folder = (std::filesystem::temp_directory_path() / "luxrig-sim-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr)
    return tl::unexpected(fault_of("no temporary folder: " + std::string(std::strerror(errno))));
  SimProcess made{std::filesystem::path(folder)};
  auto child = ChildProcess::start("luxrig-sim",
                                   {rig.string(), "--seed", std::to_string(seed), "--deviations", deviations,
                                    "--ports-file", (made.folder_ / "ports.json").string(), "--with-parent"},
                                   {made.folder_ / "log", {}});
  if (!child) return tl::unexpected(child.error());
  made.child_.emplace(std::move(*child));
  return made;
}

SimProcess::SimProcess(SimProcess&& other) noexcept
    : folder_(std::exchange(other.folder_, {})), child_(std::exchange(other.child_, std::nullopt)) {}

SimProcess::~SimProcess() {
  child_.reset();
  if (folder_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

Result<SimPorts> SimProcess::wait_ready(const Watch& watch) {
  const auto ports_file = folder_ / "ports.json";
  while (true) {
    if (watch.stop.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "luxrig-sim", "stopped", {}});
    std::error_code error;
    if (std::filesystem::exists(ports_file, error)) {
      const auto ports = read_sim_ports(ports_file);
      if (!ports) return tl::unexpected(fault_of(ports.error().front().text()));
      return *ports;
    }
    if (const auto code = child_->ended())
      return tl::unexpected(
          fault_of(fmt::format("ended before it was ready (exit code {}): {}", *code, tail_of(folder_ / "log"))));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

std::optional<SimTruth> ask_truth(const Redirect& control) {
  const auto answer = http_get({control.host, control.port}, "/truth");
  if (!answer || answer->status != 200) return {};
  const auto json = nlohmann::json::parse(answer->body, nullptr, false);
  if (!json.is_object() || !json.contains("points") || !json.contains("violations")) return {};
  SimTruth truth;
  for (const auto& point : json["points"]) {
    truth.points.push_back({point.value("name", ""), point.value("lux", 0.0), point.value("max_lux_seen", 0.0)});
  }
  truth.violations = json["violations"].size();
  return truth;
}

}  // namespace luxrig
