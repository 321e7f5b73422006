#pragma once
/// Sends the fixtures of one bus by sACN (ANSI E1.31-2018) over UDP, multicast or unicast. See README.md.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/io/datagram.h"
#include "drivers/registry.h"

namespace luxrig {

[[nodiscard]] std::span<const OptionDoc> sacn_options();
[[nodiscard]] std::vector<Problem> check_sacn(const Rig& rig, std::size_t bus);
[[nodiscard]] std::unique_ptr<Driver> make_sacn(const Rig& rig, std::size_t bus,
                                                const std::optional<Redirect>& redirect);

[[nodiscard]] WhenDataStops sacn_when_data_stops(const Rig& rig, std::size_t fixture);

/// The same over the caller's channels, one for each network interface.
[[nodiscard]] std::unique_ptr<Driver> make_sacn_over(std::vector<std::unique_ptr<DatagramChannel>> channels,
                                                     const Rig& rig, std::size_t bus,
                                                     const std::optional<Redirect>& redirect);

}  // namespace luxrig
