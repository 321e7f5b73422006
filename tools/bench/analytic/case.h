#pragma once
/// A scene with known light, in closed form (or by a quadrature far finer than the errors that it judges), and the rows
/// from measuring it.

#include "tools/bench/bench.h"
#include "tools/bench/measured.h"

namespace luxrig {

struct AnalyticCase {
  enum class Part { total, direct, reflected };
  std::string name;
  Scene scene;
  std::vector<Receiver> receivers;
  std::vector<Emitter> emitters;  ///< all at level 1
  std::vector<double> exact_lx;   ///< one per receiver
  Part part = Part::total;        ///< the part of a method's answer that exact_lx is
  bool reflects = false;          ///< only for methods that claim interreflection
  double reflected_share = 1;     ///< share of exact_lx in the illuminance with the wanted error
  double direct_target = 1e-6;    ///< if nothing is reflected
};

/// Relative errors over the receivers, each relative to max(exact, 0.001 of the brightest).
struct AnalyticError {
  double rms = 0, worst = 0;  ///< both NaN if one of them is
};
[[nodiscard]] AnalyticError error_of(const AnalyticCase& one, const TransportMatrix& matrix);

/// The same case with at most this many receivers, spread evenly over the list: for quick runs.
[[nodiscard]] AnalyticCase with_receivers(AnalyticCase one, std::size_t most);

/// Measures every method that claims the case.
///
/// - Without reflection: one run, judged by its worst receiver.
/// - With reflection: a curve under the users' stop criterion, judged by it: the rms over the receivers (the note has
///   the worst). The last point has a third of the method's target as wanted error, and is judged by that target.
/// - With quick: only that last point; for direct light that has to be sampled, only the direct method (the others give
///   the same).
void measure_case(const AnalyticCase& one, const BenchOptions& options, std::vector<BenchRow>& rows);

/// Families of cases, a file each.
void add_point_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_area_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_flux_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_enclosure_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_furnace_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_reflection_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_daylight_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_error_bar_rows(const BenchOptions& options, std::vector<BenchRow>& rows);

}  // namespace luxrig
