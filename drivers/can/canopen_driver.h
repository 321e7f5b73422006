#pragma once
/// Heads whose pan and tilt are CiA 402 drives on a CAN bus. See README.md.

#include <memory>
#include <optional>
#include <span>

#include "drivers/can/can_channel.h"
#include "drivers/registry.h"

namespace luxrig {

[[nodiscard]] std::span<const OptionDoc> canopen_options();
[[nodiscard]] std::vector<Problem> check_canopen(const Rig& rig, std::size_t bus);
/// For a head whose axes are on such a bus.
[[nodiscard]] AxesWithoutData canopen_axes_without_data(const Rig& rig, std::size_t fixture);
/// `redirect`: a bus in datagrams (can_datagrams.h) instead of the interface.
[[nodiscard]] std::unique_ptr<Driver> make_canopen(const Rig& rig, std::size_t bus,
                                                   const std::optional<Redirect>& redirect);
/// The same over a given channel, for tests.
[[nodiscard]] std::unique_ptr<Driver> make_canopen(const Rig& rig, std::size_t bus,
                                                   std::unique_ptr<can::CanChannel> channel);

}  // namespace luxrig
