#pragma once
/// A lit room with the converged illuminance of its receivers, and its rows in `luxrig bench transport`.

#include <functional>

#include "tools/bench/bench.h"
#include "tools/bench/measured.h"
#include "tools/bench/rooms/lit_room.h"

namespace luxrig {

/// The reference for all methods: path tracing with a small wanted error and its own seed.
struct Reference {
  Eigen::VectorXd lux;
  double rms_error = 0;  ///< of itself, from its standard errors; relative as below
  double seconds = 0;    ///< time to compute; 0 when read from a file
  std::string refused;   ///< why there is none
};

/// Errors are relative to max(lux, this share of the mean), rms over the receivers. One lamp of a flat leaves most
/// rooms nearly dark: 10 % of the mean of its column are as much as 1 % of the mean of all lamps' light.
constexpr double kFloorOfAll = 0.01, kFloorOfColumn = 0.1;

/// The lamps of a reference; empty = all at level 1.
struct ReferenceLevels {
  std::vector<double> wanted;    ///< levels that lux is for
  std::vector<double> steering;  ///< levels at which path tracing reaches the wanted error
  double floor = kFloorOfAll;    ///< for its own error
};

struct TransportCase {
  explicit TransportCase(LitRoom lit) : room(std::move(lit)), rays(room.scene) {}
  LitRoom room;
  RayScene rays;
};

/// rms of the relative errors over the receivers, and their signed mean.
struct RoomError {
  double rms = 0, bias = 0;
};
[[nodiscard]] RoomError error_of(const Eigen::VectorXd& lux, const Eigen::VectorXd& reference_lux,
                                 double floor = kFloorOfAll);

/// 64 bits that change with geometry, materials, lamps or receivers.
[[nodiscard]] std::uint64_t hash_of(const LitRoom& room);

/// Read from options.references_folder, if a file there is as good as wanted; else computed and saved there.
[[nodiscard]] Reference reference_of(const TransportCase& one, const BenchOptions& options,
                                     const ReferenceLevels& of_lamps = {});

/// A row of the transport suite: the columns of measured.h, then bias, reference_error and cpu_seconds, and `note`
/// last.
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
void add_turned_head_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_cache_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_candidate_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_growth_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_candidate_skip_rows(const BenchOptions& options, std::vector<BenchRow>& rows);
void add_evaluator_skip_rows(const BenchOptions& options, std::vector<BenchRow>& rows);

/// Writes Radiance's input for the same receivers: NAME.rad, NAME.pts, NAME.lux. Returns an empty string, or the
/// problem.
[[nodiscard]] std::string export_for_radiance(const LitRoom& room, const std::filesystem::path& folder);

/// Whether options.only selects the case.
[[nodiscard]] bool wanted_case(const BenchOptions& options, const std::string& case_name);

}  // namespace luxrig
