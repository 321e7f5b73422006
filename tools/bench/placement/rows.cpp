#include "tools/bench/placement/rows.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace luxrig {
namespace {

constexpr const char* kPlacementColumns[] = {"cpu_seconds", "lights",     "known_lights", "found",
                                             "farthest_m",  "worst_flux", "bound",        "evaluations",
                                             "columns",     "candidates", "points",       "note"};

}  // namespace

bool Recovery::found(double error) const {
  return as_many && error <= kRecoveredError && farthest_m <= kRecoveredWithin_m && worst_flux <= kRecoveredFlux;
}

Recovery recovery_of(const PlacementCase& one, const Solved& solved) {
  Recovery recovery;
  recovery.as_many = solved.poses.size() == one.known_places_world_m.size();
  for (std::size_t k = 0; k < one.known_places_world_m.size(); ++k) {
    double nearest_m = std::numeric_limits<double>::infinity(), flux = 1;
    for (std::size_t i = 0; i < solved.poses.size(); ++i) {
      const double off_m = (solved.poses[i].position_world_m - one.known_places_world_m[k]).norm();
      if (off_m >= nearest_m) continue;
      nearest_m = off_m;
      flux = std::abs(solved.levels[static_cast<Eigen::Index>(i)] / one.known_lumens[k] - 1);
    }
    recovery.farthest_m = std::max(recovery.farthest_m, nearest_m);
    recovery.worst_flux = std::max(recovery.worst_flux, flux);
  }
  return recovery;
}

BenchRow empty_placement_row(const std::string& name, const std::string& method) {
  BenchRow row{name, method, std::nan(""), 0, {}, {}, {}};
  for (const char* column : kPlacementColumns) row.further.emplace_back(column, "");
  return row;
}

void set_further(BenchRow& row, const std::string& column, std::string value) {
  for (auto& [name, text] : row.further)
    if (name == column) text = std::move(value);
}

BenchRow placement_row(const std::string& name, const std::string& method, const ReadyCase& ready, const Solved& solved,
                       std::optional<double> bound) {
  BenchRow row = empty_placement_row(name, method);
  row.seconds = solved.seconds.wall;
  set_further(row, "points", std::to_string(ready.of().receivers.size()));
  set_further(row, "candidates", std::to_string(ready.problem().poses.size()));
  if (!solved.refused.empty()) {
    set_further(row, "note", solved.refused);
    return row;
  }
  row.error = solved.error;
  set_further(row, "cpu_seconds", fmt::format("{:.3g}", solved.seconds.cpu));
  set_further(row, "lights", std::to_string(solved.poses.size()));
  set_further(row, "columns", std::to_string(solved.columns));
  if (solved.evaluations > 0) set_further(row, "evaluations", std::to_string(solved.evaluations));
  if (bound) set_further(row, "bound", fmt::format("{:.4g}", *bound));
  if (!ready.of().known_places_world_m.empty()) {
    const Recovery recovery = recovery_of(ready.of(), solved);
    set_further(row, "known_lights", std::to_string(ready.of().known_places_world_m.size()));
    set_further(row, "found", recovery.found(solved.error) ? "1" : "0");
    set_further(row, "farthest_m", fmt::format("{:.3g}", recovery.farthest_m));
    set_further(row, "worst_flux", fmt::format("{:.3g}", recovery.worst_flux));
  }
  return row;
}

}  // namespace luxrig
