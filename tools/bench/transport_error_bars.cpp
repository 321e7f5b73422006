/// Are errors as stated, and is the wish kept? Many seeds in each room: how often a point's error is within two of its
/// standard errors, and what the rms over the points and the worst of them come to.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/bench/transport_case.h"

namespace luxrig {
namespace {

/// A wanted error 0: not measured by it.
struct Room {
  const char* name;
  LitRoom (*make)();
  double wanted_rms = 0.01, wanted_worst = 0.03;
};

/// The closed box, varnished all over.
LitRoom make_glossy_room() {
  LitRoom room = make_box_room();
  for (Material& material : room.scene.materials) {
    material.specular_reflectance = 0.05;
    material.roughness = 0.3;
  }
  return room;
}

/// The flat by one of its lamps: what gets through the doors is found by few paths.
LitRoom make_flat_by_one_lamp() {
  LitRoom room = make_eight_room_flat();
  room.emitters = {room.emitters[2]};
  return room;
}

constexpr Room kRooms[] = {{"box", [] { return make_box_room(); }},
                           {"glossy-box", make_glossy_room},
                           {"flat", [] { return make_eight_room_flat(); }},
                           {"gallery", [] { return make_gallery_hall(); }},
                           {"polished-gallery", [] { return make_gallery_hall(1, true); }},
                           {"atrium", [] { return make_atrium(); }},
                           {"flat-by-one-lamp", make_flat_by_one_lamp, 0.1, 0}};
/// Of the wanted rms.
constexpr double kReferenceError = 0.2;

struct Stop {
  const char* name;
  double rms, worst;  ///< wanted; one of them
};

void add_rows(const TransportCase& one, const Reference& reference, const Method& method, const Stop& stop,
              const BenchOptions& options, std::vector<BenchRow>& rows) {
  const int seeds = options.quick ? 4 : 20;
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
  BenchRow row = transport_row(fmt::format("{}-bars-{}", one.room.name, stop.name), method.name, std::abs(share - 0.95),
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

}  // namespace

void add_error_bar_rows_of_rooms(const BenchOptions& options, std::vector<BenchRow>& rows) {
  for (const Room& room : kRooms) {
    LitRoom lit = room.make();
    lit.name = room.name;
    if (!wanted_case(options, lit.name + "-bars")) continue;
    const TransportCase one(std::move(lit));
    BenchOptions fine = options;
    fine.reference_error = std::max(options.reference_error, kReferenceError * room.wanted_rms);
    const Reference reference = reference_of(one, fine);
    for (const Method& method : methods())
      for (const Stop& stop : {Stop{"rms", room.wanted_rms, 0}, Stop{"worst", 0, room.wanted_worst}})
        if (method.reflects && stop.rms + stop.worst > 0 && (options.method.empty() || options.method == method.name))
          add_rows(one, reference, method, stop, options, rows);
  }
}

}  // namespace luxrig
