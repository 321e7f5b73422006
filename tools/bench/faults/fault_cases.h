#pragma once
/// One fault of a bus, from its beginning to the recovery, and the row for hundreds of one kind.

#include <optional>
#include <string>
#include <vector>

#include "sim/faults/faults.h"
#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

struct FaultOutcome {
  double departure = 0;   ///< largest deviation from the asked value: level 0…1, or joint [deg]
  double departed_s = 0;  ///< duration of the deviation
  /// Most beyond all values asked since it was last right: a level brighter than any, or a joint past its aim [deg].
  double excess = 0;
  std::optional<double> reported_s;   ///< time after its beginning; nothing = never, if it cannot be noticed
  std::optional<double> recovered_s;  ///< from its end until all is right and reported healthy; nothing = not in time
  std::string astray;                 ///< a state that was never asked for; empty = none
};

/// How a kind of fault is injected.
struct FaultPlan {
  sim::FaultKind kind;
  std::string device;                          ///< a bus, a fixture, an axis
  double value_least = 1, value_most = 1;      ///< drawn from this range
  double shortest_s = 0.3, longest_s = 2.5;    ///< its duration, drawn from this range
  double rest_s = 0;                           ///< between two cases
  bool loses_position = false, homes = false;  ///< an axis loses it by this fault; it may be homed afterwards
  const char* suffix = "";                     ///< end of the row's name: the part that is hit
  const char* note = "";                       ///< without commas
};

/// `unit`: of departure and excess. error: share of cases that went astray or did not recover; target 0. seconds:
/// longest recovery; target `bound_s`.
[[nodiscard]] BenchRow row_of_faults(const std::string& bus, const FaultPlan& plan, const std::string& unit,
                                     const std::vector<FaultOutcome>& outcomes, double bound_s);

/// Whether --only selects this kind on this bus: it is a prefix of "bus-kind".
[[nodiscard]] bool fault_wanted(const BenchOptions& options, const std::string& bus, const FaultPlan& plan);
/// Number of cases of each kind.
[[nodiscard]] int fault_count(const BenchOptions& options);

/// Lamps on sACN, Art-Net, USB and Modbus.
void add_level_faults(const BenchOptions& options, std::vector<BenchRow>& rows);
/// Axes on a CAN bus.
void add_axis_faults(const BenchOptions& options, std::vector<BenchRow>& rows);

}  // namespace luxrig
