#pragma once
/// The load on the buses of the axes benches.

#include "core/output/head_move.h"
#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

inline constexpr int kCanBuses = 4, kHeadsOfBus = 8;
inline constexpr AxisLimits kPanLimits{90, 180}, kTiltLimits{60, 120};  // [deg/s, deg/s^2]
/// Allowed delay after the closed form: the handshake of a new aim, and the drives' rounding.
inline constexpr double kLatestArrival_s = 0.15;
inline constexpr double kThere_deg = 0.05;
inline constexpr const char* kAxesDay = "axes-day";

/// 32 heads with two axes each, on four buses; a fifth bus has their lamps.
[[nodiscard]] Rig rig_of_heads();

/// In simulated time, without sockets or threads. Every head gets a new aim every 10 to 60 s, all the way to the
/// simulated drives and back. error: the worst delay of the last head, as a share of the allowed delay; 100 if a head
/// never arrived or faulted, or if memory grew. seconds: processor time.
[[nodiscard]] BenchRow measure_axes_day(double simulated_s);

}  // namespace luxrig
