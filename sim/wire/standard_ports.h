#pragma once
/// The ports at which the world's software looks for a bus: sACN 5568, Art-Net 6454, Modbus TCP 502.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "sim/wire/bus_endpoint.h"

namespace luxrig::sim {

/// Gives each bus of these protocols its standard port, in `places`. Modbus gets 1502 where `may_listen_on(502)` is
/// false. One address has each port once, so further buses of a protocol get the next ports. Returns what a person
/// has to know about that, one sentence each.
std::vector<std::string> use_standard_ports(const Rig& rig, const std::function<bool(int)>& may_listen_on,
                                            std::map<std::string, EndpointPlace>& places);

}  // namespace luxrig::sim
