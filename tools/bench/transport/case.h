#pragma once
/// A lit room with the converged illuminance of its receivers, and the rows that `luxrig bench transport` makes of it.

#include <functional>

#include "tools/bench/bench.h"
#include "tools/bench/measured.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {

/// What all methods are measured against: path tracing with a small wanted error and a seed of its own.
struct Reference {
  Eigen::VectorXd lux;
  double rms_error = 0;  ///< its own, by its standard errors; relative as below
  double seconds = 0;    ///< what it took; 0 when it came from a file
  std::string refused;   ///< why there is none
};

/// Errors are relative to max(lux, this share of the mean), rms over the receivers. One lamp of a flat leaves most
/// rooms nearly dark, and of its column 10 % of the mean are what 1 % are of all lamps' light.
constexpr double kFloorOfAll = 0.01, kFloorOfColumn = 0.1;

/// Which lamps a reference is of; empty = all at level 1.
struct ReferenceLevels {
  std::vector<double> wanted;    ///< levels at which lux is given
  std::vector<double> steering;  ///< levels under which path tracing reaches the wanted error
  double floor = kFloorOfAll;    ///< its own error is stated by
};

struct TransportCase {
  explicit TransportCase(LitRoom lit) : room(std::move(lit)), rays(room.scene) {}
  LitRoom room;
  RayScene rays;
};

/// Relative errors' rms over the receivers, and their mean with its sign.
struct RoomError {
  double rms = 0, bias = 0;
};
[[nodiscard]] RoomError error_of(const Eigen::VectorXd& lux, const Eigen::VectorXd& reference_lux,
                                 double floor = kFloorOfAll);

/// 64 bits that change with the geometry, the materials, the lamps or the receivers.
[[nodiscard]] std::uint64_t hash_of(const LitRoom& room);

/// With options.references_folder, from its file there when one as good is kept; else computed, and kept.
[[nodiscard]] Reference reference_of(const TransportCase& one, const BenchOptions& options,
                                     const ReferenceLevels& of_lamps = {});

/// A row of the transport suite: measured.h's columns, then bias, reference_error and cpu_seconds, and `note` last.
[[nodiscard]] BenchRow transport_row(const std::string& case_name, const std::string& method, double error,
                                     const Measured& run, std::optional<double> wanted_error,
                                     std::optional<double> target_error, const RoomError& bias = {},
                                     double reference_error = 0);
void set_note(BenchRow& row, std::string note);

/// Parts of the suite, a file each.
void add_error_bar_rows_of_rooms(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_curve_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_identity_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_moved_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_changed_lamp_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_cache_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_candidate_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_growth_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_candidate_skip_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_evaluator_skip_rows(const BenchOptions& options, std::vector<BenchRow>& rows);

/// Writes what Radiance needs to compute the same receivers: NAME.rad, NAME.pts, NAME.lux. Empty, or what went wrong.
[[nodiscard]] std::string export_for_radiance(const LitRoom& room, const std::filesystem::path& folder);

/// True unless options.only says otherwise.
[[nodiscard]] bool wanted_case(const BenchOptions& options, const std::string& case_name);

}  // namespace luxrig
