#pragma once
/// What the axes benches load their buses with.

#include "core/output/head_move.h"
#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

inline constexpr int kCanBuses = 4, kHeadsOfBus = 8;
inline constexpr AxisLimits kPanLimits{90, 180}, kTiltLimits{60, 120};  // [deg/s, deg/s^2]
/// Behind the closed form: the handshake of a new aim, and the drives' rounding.
inline constexpr double kLatestArrival_s = 0.15;
inline constexpr double kThere_deg = 0.05;
inline constexpr const char* kAxesDay = "axes-day";

/// 32 heads, each two axes, on four buses; a fifth bus has their lamps.
[[nodiscard]] Rig rig_of_heads();

/// Simulated time, without sockets or threads: a new aim for every head every 10 to 60 s, all the way to the simulated
/// drives and back. Error is how late the last head was at worst, as a share of what is allowed, or 100 when one never
/// came, faulted, or memory grew; seconds are of the processor.
[[nodiscard]] BenchRow measure_axes_day(double simulated_s);

}  // namespace luxrig
