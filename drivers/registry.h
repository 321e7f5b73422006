#pragma once
/// The table of drivers: one line each, in registry.cpp.

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "core/rig/rig.h"
#include "drivers/driver.h"
#include "drivers/when_data_stops.h"

namespace luxrig {

/// Redirects a bus: all its traffic goes to a stand-in, on loopback or at a path, not where the rig file points.
struct Redirect {
  std::string host;  ///< "127.0.0.1"
  int port = 0;
  std::string path{};  ///< of a serial port; empty = the stand-in has none
  int desk_port{};     ///< UDP port on which a lighting desk is heard in place of `input_port`; 0 = there
};

/// One option that a driver reads from its [[bus]] entry: a row of its table in the rig-file reference.
struct OptionDoc {
  std::string_view key, type, unit, fallback, range, summary;
};

struct DriverEntry {
  std::string_view name;     ///< as in [[bus]] driver = "…"
  std::string_view summary;  ///< "ANSI E1.31 over UDP, send"
  std::span<const OptionDoc> options;
  /// Problems with the bus's options, and with the patches of the fixtures and meters on it. Touches no device.
  std::vector<Problem> (*check)(const Rig& rig, std::size_t bus);
  /// requires check() to be empty.
  std::unique_ptr<Driver> (*make)(const Rig& rig, std::size_t bus, const std::optional<Redirect>& redirect);
  /// The lamp's behaviour when data stops; null = this bus carries no lamps.
  WhenDataStops (*when_data_stops)(const Rig& rig, std::size_t fixture);
  /// Feedback from its lamps: which failures are noticed without a luxmeter or camera; empty = no lamps.
  std::string_view comes_back;
};

[[nodiscard]] std::span<const DriverEntry> drivers();
[[nodiscard]] const DriverEntry* find_driver(std::string_view name);

/// DriverEntry::comes_back of the bus's driver; empty for a null bus. requires check_buses() to be empty.
[[nodiscard]] std::string_view what_comes_back(const Bus& bus);

/// Checks every bus of the rig: driver known (else suggests the nearest name), options and patches valid.
[[nodiscard]] std::vector<Problem> check_buses(const Rig& rig);

}  // namespace luxrig
