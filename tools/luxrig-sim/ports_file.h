#pragma once
/// The ports of a simulator, as a small JSON file. Programs that talk to the simulator read it. A simulator that is
/// started again with the file comes back on the same ports.
///
///   {"buses":{"dmx":{"host":"127.0.0.1","port":40001},"line":{"path":"/tmp/luxrig-line-AbCdEf/port"}},
///    "control":{"host":"127.0.0.1","port":40010},"seed":1}

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "core/result.h"

namespace luxrig::sim {

struct Ports {
  std::string host = "127.0.0.1";            ///< of the buses with a port; the control port is always on 127.0.0.1
  std::map<std::string, int> buses;          ///< by bus name
  std::map<std::string, std::string> paths;  ///< of serial lines, by bus name
  int control = 0;
  std::uint64_t seed = 1;
};

[[nodiscard]] std::string to_json(const Ports& ports);  ///< one line
/// Nothing if the file does not exist; problems if it is no ports file. Ignores the host.
[[nodiscard]] Checked<std::optional<Ports>> read_ports(const std::filesystem::path& file);
/// Readers see the old file or the new one, never half of it.
[[nodiscard]] Result<void> write_ports(const std::filesystem::path& file, const Ports& ports);

}  // namespace luxrig::sim
