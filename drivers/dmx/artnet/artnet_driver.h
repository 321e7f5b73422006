#pragma once
/// Sends the fixtures of one bus by Art-Net 4 over UDP, to nodes that it finds or to a given one. See README.md.

#include <memory>
#include <optional>
#include <span>

#include "drivers/io/datagram.h"
#include "drivers/registry.h"

namespace luxrig {

[[nodiscard]] std::span<const OptionDoc> artnet_options();
[[nodiscard]] std::vector<Problem> check_artnet(const Rig& rig, std::size_t bus);
[[nodiscard]] std::unique_ptr<Driver> make_artnet(const Rig& rig, std::size_t bus,
                                                  const std::optional<Redirect>& redirect);

[[nodiscard]] WhenDataStops artnet_when_data_stops(const Rig& rig, std::size_t fixture);

/// The same over the caller's channel.
[[nodiscard]] std::unique_ptr<Driver> make_artnet_over(std::unique_ptr<DatagramChannel> channel, const Rig& rig,
                                                       std::size_t bus, const std::optional<Redirect>& redirect);

}  // namespace luxrig
