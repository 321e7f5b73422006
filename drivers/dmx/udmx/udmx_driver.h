#pragma once
/// DMX through a uDMX (anyma) or one of its clones: vendor control requests. See README.md.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/registry.h"
#include "drivers/usb/usb_channel.h"

namespace luxrig {

[[nodiscard]] std::span<const OptionDoc> udmx_options();
[[nodiscard]] std::vector<Problem> check_udmx(const Rig& rig, std::size_t bus);
[[nodiscard]] std::unique_ptr<Driver> make_udmx(const Rig& rig, std::size_t bus,
                                                const std::optional<Redirect>& redirect);
[[nodiscard]] WhenDataStops udmx_when_data_stops(const Rig& rig, std::size_t fixture);
/// The same over the caller's channel.
[[nodiscard]] std::unique_ptr<Driver> make_udmx_over(std::unique_ptr<UsbChannel> channel, const Rig& rig,
                                                     std::size_t bus);

}  // namespace luxrig
