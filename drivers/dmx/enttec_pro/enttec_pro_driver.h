#pragma once
/// DMX through an ENTTEC DMX USB Pro or a compatible widget, over libusb. See README.md.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/registry.h"
#include "drivers/usb/usb_channel.h"

namespace luxrig {

[[nodiscard]] std::span<const OptionDoc> enttec_pro_options();
[[nodiscard]] std::vector<Problem> check_enttec_pro(const Rig& rig, std::size_t bus);
[[nodiscard]] std::unique_ptr<Driver> make_enttec_pro(const Rig& rig, std::size_t bus,
                                                      const std::optional<Redirect>& redirect);
[[nodiscard]] WhenDataStops enttec_pro_when_data_stops(const Rig& rig, std::size_t fixture);
/// The same over the caller's channel.
[[nodiscard]] std::unique_ptr<Driver> make_enttec_pro_over(std::unique_ptr<UsbChannel> channel, const Rig& rig,
                                                           std::size_t bus);

}  // namespace luxrig
