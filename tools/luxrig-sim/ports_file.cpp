#include "tools/luxrig-sim/ports_file.h"

#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>

namespace luxrig::sim {
namespace {

constexpr const char* kControlHost = "127.0.0.1";

}  // namespace

std::string to_json(const Ports& ports) {
  nlohmann::ordered_json json;
  json["buses"] = nlohmann::ordered_json::object();
  for (const auto& [bus, port] : ports.buses) json["buses"][bus] = {{"host", ports.host}, {"port", port}};
  for (const auto& [bus, path] : ports.paths) json["buses"][bus] = {{"path", path}};
  json["control"] = {{"host", kControlHost}, {"port", ports.control}};
  json["seed"] = ports.seed;
  return json.dump();
}

Checked<std::optional<Ports>> read_ports(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::optional<Ports>();
  const auto refused = [&file](const char* what) {
    return tl::unexpected(
        std::vector<Problem>{{file.string(), 0, 0, what, "delete the file, or name another with --ports-file"}});
  };
  std::ifstream in(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  if (!in) return refused("cannot be read");
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  const auto port_of = [](const nlohmann::json& entry) -> std::optional<int> {
    if (!entry.is_object() || !entry.contains("port") || !entry["port"].is_number_unsigned()) return std::nullopt;
    const auto port = entry["port"].get<std::uint64_t>();
    return port >= 1 && port <= 65535 ? std::optional(static_cast<int>(port)) : std::nullopt;
  };
  if (!json.is_object() || !json.contains("buses") || !json["buses"].is_object() || !json.contains("control")) {
    return refused("is not a ports file");
  }
  Ports ports;
  for (const auto& [bus, entry] : json["buses"].items()) {
    if (entry.is_object() && entry.contains("path") && entry["path"].is_string()) {
      ports.paths[bus] = entry["path"].get<std::string>();
      continue;
    }
    const auto port = port_of(entry);
    if (!port) return refused("has a bus whose port is not a number 1…65535");
    ports.buses[bus] = *port;
  }
  const auto control = port_of(json["control"]);
  if (!control) return refused("has a control port that is not a number 1…65535");
  ports.control = *control;
  return std::optional(ports);
}

Result<void> write_ports(const std::filesystem::path& file, const Ports& ports) {
  const auto failed = [&file](const std::string& why) {
    return tl::unexpected(Fault{Cause::system, "", "cannot write " + file.string() + ": " + why, {}});
  };
  std::filesystem::path draft = file;
  draft += "." + std::to_string(::getpid()) + ".new";
  {
    std::ofstream out(draft, std::ios::binary | std::ios::trunc);
    out << to_json(ports) << '\n';
    out.flush();
    if (!out) return failed(std::generic_category().message(errno));
  }
  std::error_code error;
  std::filesystem::rename(draft, file, error);
  if (error) return failed(error.message());
  return {};
}

}  // namespace luxrig::sim
