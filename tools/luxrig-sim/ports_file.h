#pragma once
/// Where a simulator listens, as a small JSON file: programs that talk to it read it, and a simulator that is started
/// again with it comes back on the same ports.
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
  std::map<std::string, int> buses;          ///< by bus name
  std::map<std::string, std::string> paths;  ///< of serial lines, the same
  int control = 0;
  std::uint64_t seed = 1;
};

[[nodiscard]] std::string to_json(const Ports& ports);  ///< one line
/// Nothing when there is no such file; problems when it is not such a file.
[[nodiscard]] Checked<std::optional<Ports>> read_ports(const std::filesystem::path& file);
/// Readers see the old file or the new one, never half of it.
[[nodiscard]] Result<void> write_ports(const std::filesystem::path& file, const Ports& ports);

}  // namespace luxrig::sim
