#include "tools/process/sim_process.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/text/plain_text.h"
#include "tools/http/client.h"
#include "tools/process/files.h"
#include "tools/process/status_fields.h"

namespace luxrig {
namespace {

Fault fault_of(std::string detail) { return {Cause::system, "luxrig-sim", std::move(detail), {}}; }

}  // namespace

Result<SimProcess> SimProcess::start(const std::filesystem::path& rig, std::uint64_t seed,
                                     const std::string& deviations) {
  SimProcess made;
  const std::filesystem::path& folder = made.folder_.path();
  if (folder.empty()) return tl::unexpected(fault_of("no temporary folder: " + std::string(std::strerror(errno))));
  auto child = ChildProcess::start("luxrig-sim",
                                   {rig.string(), "--seed", std::to_string(seed), "--deviations", deviations,
                                    "--ports-file", (folder / "ports.json").string(), "--with-parent"},
                                   {folder / "log", {}});
  if (!child) return tl::unexpected(child.error());
  made.child_.emplace(std::move(*child));
  return made;
}

Result<SimPorts> SimProcess::wait_ready(const Watch& watch) {
  const auto ports_file = folder_.path() / "ports.json";
  while (true) {
    if (watch.stop.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "luxrig-sim", "stopped", {}});
    std::error_code error;
    if (std::filesystem::exists(ports_file, error)) {
      const auto ports = read_sim_ports(ports_file);
      if (!ports) return tl::unexpected(fault_of(ports.error().front().text()));
      return *ports;
    }
    if (const auto code = child_->ended())
      return tl::unexpected(fault_of(
          fmt::format("ended before it was ready (exit code {}): {}", *code, tail_of(folder_.path() / "log"))));
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

std::string ask_world(const HttpPeer& control) {
  const auto answer = http_get(control, "/rig");
  if (!answer || answer->status != 200) return {};
  const auto json = nlohmann::json::parse(answer->body, nullptr, false);
  const std::string world = text_of(json, "world");
  return is_plain_text(world) ? world : "";
}

}  // namespace luxrig
