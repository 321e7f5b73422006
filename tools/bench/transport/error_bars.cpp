/// Are stated errors honest, and are wanted errors reached? Many seeds in each room: how often a point's error is
/// within two standard errors, and the rms and the worst over the points. The same for the light of each lamp alone,
/// from one evaluation of all lamps: levels are computed from that.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/bench/transport/case.h"

namespace luxrig {
namespace {

/// Wanted error 0: this stop is not tested.
struct Room {
  const char* name;
  LitRoom (*make)();
  double wanted_rms = 0.01, wanted_worst = 0.03;
  bool columns = false;  ///< also of its single lamps, if several lamps light different parts
};

/// The closed box, all surfaces varnished.
LitRoom make_glossy_room() {
  LitRoom room = make_box_room();
  for (Material& material : room.scene.materials) {
    material.specular_reflectance = 0.05;
    material.roughness = 0.3;
  }
  return room;
}

/// The flat with one of its lamps: few paths find the light through the doors.
LitRoom make_flat_by_one_lamp() {
  LitRoom room = make_eight_room_flat();
  room.emitters = {room.emitters[2]};
  return room;
}

constexpr Room kRooms[] = {{"box", [] { return make_box_room(); }},
                           {"glossy-box", make_glossy_room},
                           {"flat", [] { return make_eight_room_flat(); }, 0.01, 0.03, true},
                           {"gallery", [] { return make_gallery_hall(); }, 0.01, 0.03, true},
                           {"polished-gallery", [] { return make_gallery_hall(1, true); }},
                           {"atrium", [] { return make_atrium(); }},
                           {"flat-by-one-lamp", make_flat_by_one_lamp, 0.1, 0}};
/// As a share of the wanted rms.
constexpr double kReferenceError = 0.2;

struct Stop {
  const char* name;
  double rms, worst;  ///< wanted; only one is set
};

int seeds_of(const BenchOptions& options) { return options.quick ? 4 : 20; }

void add_row_of_stop(const TransportCase& one, const Reference& reference, const Method& method, const Stop& stop,
                     const BenchOptions& options, std::vector<BenchRow>& rows) {
  const int seeds = seeds_of(options);
  Measured last;
  std::vector<double> seconds, cpu_seconds, rms_off, worst_off, rms_stated;
  int within = 0, within_wish = 0, count = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    EvaluateOptions evaluate;
    if (stop.worst > 0) evaluate.wanted_relative_error = stop.worst;
    evaluate.wanted_rms_error = stop.rms;
    evaluate.seed = static_cast<std::uint64_t>(seed);
    evaluate.threads = options.threads;
    last = measure(method, one.rays, one.room.receivers, one.room.emitters, evaluate);
    if (!last.refused.empty()) break;
    seconds.push_back(last.seconds), cpu_seconds.push_back(last.cpu_seconds);
    const Eigen::VectorXd levels = Eigen::VectorXd::Ones(last.matrix.emitters());
    const Eigen::ArrayXd off_lx = (last.matrix.lux(levels) - reference.lux).array().abs(),
                         bars_lx = last.matrix.standard_error_lux(levels).array(),
                         of_lx = reference.lux.array().max(0.001 * reference.lux.maxCoeff());
    within += static_cast<int>((off_lx <= 2 * bars_lx).count());
    within_wish += static_cast<int>((off_lx <= (stop.rms > 0 ? stop.rms : stop.worst) * of_lx).count());
    count += static_cast<int>(off_lx.size());
    rms_off.push_back(std::sqrt((off_lx / of_lx).square().mean()));
    rms_stated.push_back(std::sqrt((bars_lx / of_lx).square().mean()));
    worst_off.push_back((off_lx / of_lx).maxCoeff());
  }
  last.seconds = median_of(seconds), last.cpu_seconds = median_of(cpu_seconds);
  const double share = count > 0 ? static_cast<double>(within) / count : 0;
  BenchRow row = transport_row(fmt::format("bars-{}-{}", one.room.name, stop.name), method.name, std::abs(share - 0.95),
                               last, stop.rms > 0 ? stop.rms : stop.worst, 0.02, {}, reference.rms_error);
  if (last.refused.empty()) {
    set_note(row,
             fmt::format("{} seeds: {:.2f} % within two standard errors; rms {:.2e} (stated {:.2e}), worst {:.2e}; "
                         "{:.1f} % of points within the wish",
                         seeds, 100 * share, median_of(rms_off), median_of(rms_stated), median_of(worst_off),
                         100.0 * within_wish / std::max(count, 1)));
  }
  rows.push_back(row);
}

/// Each lamp's lux at each point, with its standard error.
struct Columns {
  Eigen::ArrayXXd lux, error_lux;
};

Columns columns_of(const TransportMatrix& matrix) {
  Columns columns{matrix.lux_per_level.array(), Eigen::ArrayXXd(matrix.receivers(), matrix.emitters())};
  for (Eigen::Index e = 0; e < matrix.emitters(); ++e)
    columns.error_lux.col(e) = matrix.standard_error_lux(Eigen::VectorXd::Unit(matrix.emitters(), e)).array();
  return columns;
}

/// Errors are relative to a point's total light. The reference is by `path`, as good as that of all lamps.
void add_column_rows(const TransportCase& one, double wanted, const BenchOptions& options,
                     std::vector<BenchRow>& rows) {
  EvaluateOptions evaluate;
  evaluate.threads = options.threads;
  evaluate.wanted_rms_error = (options.quick ? 0.5 : kReferenceError) * wanted;
  evaluate.seed = 0xC0FFEE;
  fmt::print(stderr, "{}: reference of each lamp, wanted error {:g} …\n", one.room.name, evaluate.wanted_rms_error);
  const auto reference = make_path_evaluator(one.rays)->evaluate(one.room.receivers, one.room.emitters, evaluate);
  if (!reference) {
    Measured none;
    none.refused = reference.error().detail;
    rows.push_back(transport_row("columns-" + one.room.name, "path", 0, none, wanted, std::nullopt));
    return;
  }
  const Columns exact = columns_of(*reference);
  const Eigen::ArrayXd of_lx =
      exact.lux.rowwise().sum().max(kFloorOfAll * exact.lux.sum() / static_cast<double>(exact.lux.rows()));
  evaluate.wanted_rms_error = wanted;
  for (const Method& method : methods()) {
    if (!method.reflects || !(options.method.empty() || options.method == method.name)) continue;
    Measured last;
    std::vector<double> seconds, cpu_seconds, rms_off;
    double within = 0, count = 0, farthest = 0;
    for (int seed = 1; seed <= seeds_of(options); ++seed) {
      evaluate.seed = static_cast<std::uint64_t>(seed);
      last = measure(method, one.rays, one.room.receivers, one.room.emitters, evaluate);
      if (!last.refused.empty()) break;
      seconds.push_back(last.seconds), cpu_seconds.push_back(last.cpu_seconds);
      const Columns found = columns_of(last.matrix);
      const Eigen::ArrayXXd off_lx = (found.lux - exact.lux).abs(),
                            bars_lx = (found.error_lux.square() + exact.error_lux.square()).sqrt();
      within += static_cast<double>((off_lx <= 2 * bars_lx).count()), count += static_cast<double>(off_lx.size());
      farthest = std::max(farthest, (off_lx / bars_lx.max(1e-9 * off_lx.maxCoeff())).maxCoeff());
      rms_off.push_back(std::sqrt((off_lx.colwise() / of_lx).square().mean()));
    }
    last.seconds = median_of(seconds), last.cpu_seconds = median_of(cpu_seconds);
    BenchRow row = transport_row("columns-" + one.room.name, method.name, median_of(rms_off), last, wanted, wanted, {},
                                 reference->rms_error);
    if (last.refused.empty())
      set_note(row,
               fmt::format("{} lamps; {} seeds: rms of the point's total light; {:.2f} % within two standard "
                           "errors; farthest {:.1f} of them",
                           one.room.emitters.size(), seeds_of(options), 100 * within / std::max(count, 1.0), farthest));
    rows.push_back(row);
  }
}

}  // namespace

void add_error_bar_rows_of_rooms(const BenchOptions& options, std::vector<BenchRow>& rows) {
  for (const Room& room : kRooms) {
    LitRoom lit = room.make();
    lit.name = room.name;
    const bool bars = wanted_case(options, "bars-" + lit.name),
               columns = room.columns && wanted_case(options, "columns-" + lit.name);
    if (!bars && !columns) continue;
    const TransportCase one(std::move(lit));
    if (columns) add_column_rows(one, room.wanted_rms, options, rows);
    if (!bars) continue;
    BenchOptions fine = options;
    fine.reference_error = std::max(options.reference_error, kReferenceError * room.wanted_rms);
    const Reference reference = reference_of(one, fine);
    for (const Method& method : methods())
      for (const Stop& stop : {Stop{"rms", room.wanted_rms, 0}, Stop{"worst", 0, room.wanted_worst}})
        if (method.reflects && stop.rms + stop.worst > 0 && (options.method.empty() || options.method == method.name))
          add_row_of_stop(one, reference, method, stop, options, rows);
  }
}

}  // namespace luxrig
