#pragma once
/// DMX through an ENTTEC Open DMX USB or another FTDI cable with an RS-485 driver; the host makes the timing. See
/// README.md.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/registry.h"
#include "drivers/usb/usb_channel.h"

namespace luxrig {

[[nodiscard]] std::span<const OptionDoc> open_dmx_options();
[[nodiscard]] std::vector<Problem> check_open_dmx(const Rig& rig, std::size_t bus);
[[nodiscard]] std::unique_ptr<Driver> make_open_dmx(const Rig& rig, std::size_t bus,
                                                    const std::optional<Redirect>& redirect);
[[nodiscard]] WhenDataStops open_dmx_when_data_stops(const Rig& rig, std::size_t fixture);
/// The same over the caller's channel.
[[nodiscard]] std::unique_ptr<Driver> make_open_dmx_over(std::unique_ptr<UsbChannel> channel, const Rig& rig,
                                                         std::size_t bus);

}  // namespace luxrig
