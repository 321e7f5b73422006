#pragma once
/// Where a simulated rig listens in place of the rig's devices.

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

/// The text of a ports file as luxrig-sim writes it; `file`: its name in problems.
[[nodiscard]] Checked<SimPorts> sim_ports_of(const std::string& text, const std::string& file);
[[nodiscard]] Checked<SimPorts> read_sim_ports(const std::filesystem::path& file);

}  // namespace luxrig
