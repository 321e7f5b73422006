#pragma once
/// Dimmers and luxmeters on one RS-485 line. See README.md.

#include <memory>
#include <optional>
#include <span>

#include "drivers/registry.h"

namespace luxrig {

[[nodiscard]] std::span<const OptionDoc> modbus_rtu_options();
[[nodiscard]] std::vector<Problem> check_modbus_rtu(const Rig& rig, std::size_t bus);
[[nodiscard]] std::unique_ptr<Driver> make_modbus_rtu(const Rig& rig, std::size_t bus,
                                                      const std::optional<Redirect>& redirect);

}  // namespace luxrig
