#include "tools/process/sim_ports.h"

#include <nlohmann/json.hpp>
#include <optional>

#include "core/text/plain_text.h"
#include "tools/process/files.h"

namespace luxrig {

Checked<SimPorts> sim_ports_of(const std::string& text, const std::string& file) {
  const auto refuse = [&](const char* what) {
    return tl::unexpected(
        std::vector<Problem>{{file, 0, 0, what, "give the file that `luxrig-sim RIG --ports-file FILE` wrote"}});
  };
  const auto json = nlohmann::json::parse(text, nullptr, false);
  const auto endpoint = [](const nlohmann::json& j) -> std::optional<Redirect> {
    if (!j.is_object() || !j.contains("host") || !j["host"].is_string() || !j.contains("port") ||
        !j["port"].is_number_integer()) {
      return {};
    }
    const auto port = j["port"].get<long long>();
    const auto host = j["host"].get<std::string>();
    if (port < 1 || port > 65535 || host.empty() || !is_plain_text(host)) return {};
    Redirect to{host, static_cast<int>(port)};
    if (!j.contains("desk_port")) return to;
    if (!j["desk_port"].is_number_integer()) return {};
    const auto desk_port = j["desk_port"].get<long long>();
    if (desk_port < 1 || desk_port > 65535) return {};
    to.desk_port = static_cast<int>(desk_port);
    return to;
  };
  if (!json.is_object() || !json.contains("buses") || !json["buses"].is_object()) return refuse("is not a ports file");
  SimPorts ports;
  for (const auto& [name, value] : json["buses"].items()) {
    if (value.is_object() && value.contains("path") && value["path"].is_string()) {
      const auto path = value["path"].get<std::string>();
      if (!path.starts_with('/') || !is_plain_text(path)) return refuse("has a bus whose path is not from the root");
      ports.buses[name] = Redirect{"", 0, path};
      continue;
    }
    const auto to = endpoint(value);
    if (!to) return refuse("has a bus without host and port, or path");
    ports.buses[name] = *to;
  }
  const auto control = json.contains("control") ? endpoint(json["control"]) : std::nullopt;
  if (!control) return refuse("has no control port");
  ports.control = *control;
  return ports;
}

Checked<SimPorts> read_sim_ports(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  return sim_ports_of(*text, file.string());
}

}  // namespace luxrig
