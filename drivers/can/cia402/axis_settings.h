#pragma once
/// Set-up of an axis's drive before it moves: every object by SDO, in order. NOTES.md has the table. Pure.

#include <string>
#include <vector>

#include "drivers/can/canopen/sdo_client.h"

namespace luxrig::cia402 {

enum class HomeRule {
  at_start,     ///< as soon as the drive is able to, after every loss of its position
  when_needed,  ///< the same, but not before the first aim is ordered
  never         ///< the drive knows its own position
};

/// In the drive's own units: counts, counts/s, counts/s².
struct AxisSettings {
  int node = 1;
  int master_node = 127;
  Duration cycle = std::chrono::milliseconds(20);       ///< between two SYNCs
  Duration heartbeat = std::chrono::milliseconds(100);  ///< of node and master; each times out after three
  std::int32_t lowest = 0, highest = 0;                 ///< soft limits of the position
  std::uint32_t speed = 1, acceleration = 1;
  HomeRule home = HomeRule::at_start;
  int homing_method = 17;
  std::uint32_t homing_speed = 1;  ///< towards the switch; a quarter of it to find the edge
  Duration homing_timeout = std::chrono::seconds(60);
  bool hold_on_stop = true;  ///< after a quick stop stay energised, else switch off
  int fault_resets = 3;      ///< in a row, before a person must act
};

/// Timeout for the master's silence.
[[nodiscard]] inline Duration heartbeat_timeout(const AxisSettings& settings) { return 3 * settings.heartbeat; }

/// Time of a quick stop from full speed, including the time until the drive notices.
[[nodiscard]] Duration stops_within(const AxisSettings& settings);

struct SetupStep {
  canopen::SdoRequest request;
  bool optional = false;  ///< a drive may lack this object
};

[[nodiscard]] std::vector<SetupStep> setup_steps(const AxisSettings& settings);
/// Value of object 1016:1, by which the node listens to the master. A reset clears it, so its presence proves that the
/// node was not reset.
[[nodiscard]] std::uint32_t consumer_entry(const AxisSettings& settings);

}  // namespace luxrig::cia402
