#pragma once
/// What the Modbus benches load their buses with.

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

/// 247 units in simulated time, without sockets: requests and answers as bytes between the driver and the simulated
/// units, every level another at every write. Error is 1 when a request failed, a unit was read later than twice the
/// wanted round, a lamp was not as asked, or memory grew; seconds are of the processor.
[[nodiscard]] BenchRow measure_modbus_day(double simulated_s);

}  // namespace luxrig
