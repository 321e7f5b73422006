#pragma once
/// Rows of the placement suite: all have the same columns.

#include <string>

#include "tools/bench/placement/solve.h"

namespace luxrig {

/// Distance of found lights from the known ones.
struct Recovery {
  double farthest_m = 0;  ///< of a known light from the nearest found one
  double worst_flux = 0;  ///< of that pair, relative
  bool as_many = false;
  [[nodiscard]] bool found(double error) const;
};
inline constexpr double kRecoveredError = 0.002, kRecoveredWithin_m = 0.03, kRecoveredFlux = 0.02;

/// Zeros if no lights are known.
[[nodiscard]] Recovery recovery_of(const PlacementCase& one, const Solved& solved);

/// bound   certified for the number of lights found; none = an empty field
[[nodiscard]] BenchRow placement_row(const std::string& name, const std::string& method, const ReadyCase& ready,
                                     const Solved& solved, std::optional<double> bound = {});

/// The same columns, empty except for the arguments.
[[nodiscard]] BenchRow empty_placement_row(const std::string& name, const std::string& method);
void set_further(BenchRow& row, const std::string& column, std::string value);

}  // namespace luxrig
