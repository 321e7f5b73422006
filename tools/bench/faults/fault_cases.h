#pragma once
/// One fault of a bus, from its beginning to the recovery, and the row that hundreds of a kind make.

#include <optional>
#include <string>
#include <vector>

#include "sim/faults/faults.h"
#include "tools/bench/bench.h"
#include "tools/bench/bench_row.h"

namespace luxrig {

struct FaultOutcome {
  double departure = 0;   ///< largest, of what is from what is asked: of a level 0…1, or of a joint [deg]
  double departed_s = 0;  ///< how long it was off
  /// Most beyond all that was asked since it was right last: a level brighter than any, or a joint past its aim [deg].
  double excess = 0;
  std::optional<double> reported_s;   ///< after it began; nothing: never, as when nobody can notice
  std::optional<double> recovered_s;  ///< after it ended: all is as asked and said to be well; nothing: not in time
  std::string astray;                 ///< what state nobody asked for; empty: none
};

/// What a kind of fault is injected with.
struct FaultPlan {
  sim::FaultKind kind;
  std::string device;                          ///< a bus, a fixture, an axis
  double value_least = 1, value_most = 1;      ///< drawn between them
  double shortest_s = 0.3, longest_s = 2.5;    ///< it lasts, drawn between them
  double rest_s = 0;                           ///< between two cases
  bool loses_position = false, homes = false;  ///< of an axis: it does by itself; it may be homed for it
  const char* suffix = "";                     ///< of the row's name: what is hit
  const char* note = "";                       ///< without commas
};

/// `unit`: of departure and excess. error: the share of cases that were astray or did not recover; target 0.
/// seconds: longest recovery; target `bound_s`.
[[nodiscard]] BenchRow row_of_faults(const std::string& bus, const FaultPlan& plan, const std::string& unit,
                                     const std::vector<FaultOutcome>& outcomes, double bound_s);

/// Whether --only wants this kind on this bus: a beginning of "bus-kind".
[[nodiscard]] bool fault_wanted(const BenchOptions& options, const std::string& bus, const FaultPlan& plan);
/// How many cases of each kind.
[[nodiscard]] int fault_count(const BenchOptions& options);

/// Lamps by sACN, Art-Net, USB and Modbus.
void add_level_faults(const BenchOptions& options, std::vector<BenchRow>& rows);
/// Axes on a CAN bus.
void add_axis_faults(const BenchOptions& options, std::vector<BenchRow>& rows);

}  // namespace luxrig
