/// The radiance cache: time for a changed light in a fixed scene against paths at equal error, the gain of each of its
/// parts, and its ways through voxels.

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "tools/bench/cache/cache_ablation.h"
#include "tools/bench/transport/case.h"

namespace luxrig {
namespace {

constexpr double kEqualError = 0.03, kTimesFaster = 5;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

BenchRow cache_row(const std::string& case_name, const AblationRow& measured, double seconds, double reference_error) {
  Measured run;
  run.seconds = seconds;
  BenchRow row = transport_row(case_name, measured.setting, measured.rms_error, run, std::nullopt, std::nullopt,
                               {measured.rms_error, measured.mean_error}, reference_error);
  set_note(row, fmt::format(
                    "build {:.3g} s; all lamps {:.3g} s; one lamp {:.3g} s; {:.3g} MB; {} cells; stated error {:.2g}",
                    measured.build_seconds, measured.evaluate_seconds, measured.changed_lamp_seconds,
                    static_cast<double>(measured.report.bytes) / 1e6, measured.report.cells, measured.reported_error));
  return row;
}

Result<std::vector<AblationRow>> cache_rows(const TransportCase& one, const Reference& reference,
                                            const std::vector<NamedCacheSettings>& settings,
                                            const BenchOptions& options) {
  EvaluateOptions evaluate;
  evaluate.threads = options.threads;
  return run_cache_ablation(one.room.scene, one.rays, one.room.receivers, one.room.emitters, reference.lux, settings,
                            seconds_now, evaluate);
}

/// From coarse to fine.
std::vector<NamedCacheSettings> steps() {
  std::vector<NamedCacheSettings> all;
  for (const int gather_rays : {256, 1024, 4096, 16384, 65536}) {
    CacheSettings settings;
    settings.gather_rays = gather_rays;
    settings.light_samples = gather_rays / 2;
    all.push_back({fmt::format("cache-{}", gather_rays), settings});
  }
  return all;
}

/// The fastest run of an evaluator with an rms error of kEqualError, or its last run.
BenchRow fastest(const TransportCase& one, const Method& method, const Reference& reference,
                 const std::string& case_name, const BenchOptions& options) {
  std::optional<BenchRow> found;
  for (const double wanted : {0.3, 0.2, 0.15, 0.1, 0.08, 0.06, 0.04}) {
    EvaluateOptions evaluate;
    evaluate.wanted_relative_error = wanted;
    evaluate.threads = options.threads;
    const Measured run = measure(method, one.rays, one.room.receivers, one.room.emitters, evaluate);
    RoomError error;
    if (run.refused.empty())
      error = error_of(run.matrix.lux(Eigen::VectorXd::Ones(run.matrix.emitters())), reference.lux);
    found = transport_row(case_name, method.name, error.rms, run, wanted, std::nullopt, error, reference.rms_error);
    if (error.rms <= kEqualError) break;
  }
  return *found;
}

void add_equal_error(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::string name = "cache-equal-" + one.room.name;
  const Reference reference = reference_of(one, options);
  if (!reference.refused.empty()) return;
  double path_seconds = HUGE_VAL;
  for (const Method& method : methods()) {
    if (!method.reflects) continue;
    rows.push_back(fastest(one, method, reference, name, options));
    if (std::string(method.name) == "path") path_seconds = rows.back().seconds;
  }
  const auto measured = cache_rows(one, reference, steps(), options);
  if (!measured) return;
  std::optional<BenchRow> best;
  for (const AblationRow& row : *measured) {
    rows.push_back(cache_row(name, row, row.evaluate_seconds, reference.rms_error));
    if (!best && row.rms_error <= kEqualError) best = rows.back();
  }
  if (!best) best = rows.back();
  best->case_name += "-to-0.03";
  best->target_error = kEqualError;
  best->target_seconds = path_seconds / kTimesFaster;
  rows.push_back(*best);
}

void add_parts(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const Reference reference = reference_of(one, options);
  if (!reference.refused.empty()) return;
  const auto measured = cache_rows(one, reference, cache_ablation_settings(), options);
  if (!measured) return;
  for (const AblationRow& row : *measured)
    rows.push_back(
        cache_row("cache-parts-" + one.room.name, row, row.build_seconds + row.evaluate_seconds, reference.rms_error));
}

void add_traversals(const TransportCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const std::size_t lines = options.quick ? 20'000 : 200'000;
  for (const TraversalRow& row : compare_traversals(one.room.scene, one.rays, 128, lines, 1, seconds_now)) {
    Measured run;
    run.seconds = row.seconds_per_ray * static_cast<double>(lines);
    rows.push_back(transport_row("cache-traversal-" + one.room.name, row.name, row.missed + row.invented, run,
                                 std::nullopt, std::nullopt));
    set_note(rows.back(), fmt::format("{:.0f} ns per line; misses {:.3g} of what blocks; blocks {:.3g} of what is free",
                                      1e9 * row.seconds_per_ray, row.missed, row.invented));
  }
}

}  // namespace

void add_cache_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  if (!options.quick)
    for (const auto make : {+[] { return make_eight_room_flat(); }, +[] { return make_gallery_hall(); }}) {
      const TransportCase one(make());
      if (wanted_case(options, "cache-equal-" + one.room.name)) add_equal_error(one, options, rows);
      if (wanted_case(options, "cache-traversal-" + one.room.name)) add_traversals(one, options, rows);
      if (wanted_case(options, "cache-parts-" + one.room.name)) add_parts(one, options, rows);
    }
  const TransportCase box(make_box_room());
  if (wanted_case(options, "cache-traversal-box")) add_traversals(box, options, rows);
  if (wanted_case(options, "cache-parts-box")) add_parts(box, options, rows);
}

}  // namespace luxrig
