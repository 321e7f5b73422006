#pragma once
/// The load on the buses of the Modbus benches.

#include "core/rig/rig.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

struct ModbusLoad {
  const char* driver;
  int units, dead;  ///< the first `dead` of them never answer
};

inline constexpr const char* kModbusDay = "modbus-day";

/// Units 1, 2, …, each a dimmer and a luxmeter.
[[nodiscard]] Rig unit_rig(const ModbusLoad& load);

/// 247 units in simulated time, without sockets: requests and answers go as bytes between the driver and the simulated
/// units, and every write changes every level. error: 1 if a request failed, a unit was read later than twice the
/// wanted round, a lamp was not at its level, or memory grew. seconds: processor time.
[[nodiscard]] BenchRow measure_modbus_day(double simulated_s);

}  // namespace luxrig
