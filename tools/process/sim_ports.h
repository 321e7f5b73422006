#pragma once
/// The ports of a simulated rig, in place of the rig's devices.

#include <filesystem>
#include <map>
#include <string>

#include "core/result.h"
#include "drivers/registry.h"

namespace luxrig {

struct SimPorts {
  std::map<std::string, Redirect> buses;  ///< by bus name
  Redirect control;
};

/// Parses a ports file as luxrig-sim writes it; `file`: its name in problems.
[[nodiscard]] Checked<SimPorts> sim_ports_of(const std::string& text, const std::string& file);
[[nodiscard]] Checked<SimPorts> read_sim_ports(const std::filesystem::path& file);

}  // namespace luxrig
