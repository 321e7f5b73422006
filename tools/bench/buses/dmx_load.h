#pragma once
/// 64 universes full of 16-bit dimmers that all change with every frame.

#include <string>
#include <vector>

#include "core/output/output_program.h"
#include "core/rig/rig.h"
#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

inline constexpr int kLoadUniverses = 64, kLoadFixtures = 64;  ///< fixtures per universe, over all 512 slots
inline constexpr double kLoadPeriod_s = 1.0 / 44;

/// Universes 1 to 64 on one bus that sends to loopback.
[[nodiscard]] Rig loaded_rig(const std::string& driver);
/// From dark to full, over this time from `start` on.
[[nodiscard]] OutputProgram long_fade(const Rig& rig, Time start, double seconds);

/// Rows of the encode path alone; on request by name a day of it.
[[nodiscard]] std::vector<BenchRow> bench_dmx_encoding(const BenchOptions& options);

}  // namespace luxrig
