/// One luminaire of the gallery's twelve moves: the cost of computing its light at all receivers again. The others'
/// columns stay, since illuminance is linear in them.

#include "tools/bench/transport/moved.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "tools/bench/rooms/room_plan.h"

namespace luxrig {
namespace {

constexpr std::size_t kMoved = 4;

}  // namespace

Reference column_reference(TransportCase& one, std::size_t number, const Emitter& lamp, const BenchOptions& options) {
  BenchOptions fine = options;
  fine.quick = false;
  fine.reference_error = options.quick ? 0.02 : std::max(options.reference_error, 0.008);
  ReferenceLevels of;
  of.wanted.assign(one.room.emitters.size(), 0.0);
  of.steering.assign(one.room.emitters.size(), 0.02);
  of.wanted[number] = of.steering[number] = 1;
  of.floor = kFloorOfColumn;
  const Emitter before = std::exchange(one.room.emitters[number], lamp);
  Reference reference = reference_of(one, fine, of);
  one.room.emitters[number] = before;
  return reference;
}

double error_of_moved(const Eigen::VectorXd& lux, const Eigen::VectorXd& exact_lx, const Eigen::VectorXd& total_lx) {
  const Eigen::ArrayXd scale = total_lx.array().max(0.01 * total_lx.mean());
  return std::sqrt(((lux - exact_lx).array() / scale).square().mean());
}

void add_moved_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  const bool lamps_wanted = wanted_case(options, "moved-lamp-of-12");
  if (!lamps_wanted && !wanted_case(options, "moved-receiver") && !wanted_case(options, "moved-object-direct")) return;
  TransportCase one(make_gallery_hall());
  std::vector<Emitter> moved = {one.room.emitters[kMoved]};
  const Vec3 at_m = moved[0].world_from_lamp.translation_m + Vec3(0.4, 0, 0);
  moved[0].world_from_lamp = aimed(at_m, at_m + Vec3(0.2, at_m.y() < 6 ? -1.8 : 1.8, -2.6));

  if (!lamps_wanted) {
    add_incremental_rows(one, {moved[0], {}, {}, {}, 0}, options, rows);
    return;
  }
  const Reference reference = column_reference(one, kMoved, moved[0], options);
  const auto direct = make_direct_evaluator(one.rays)->evaluate(one.room.receivers, moved, {});
  // The receivers' total light is only a scale: any evaluator will do.
  std::vector<Emitter> all_lamps = one.room.emitters;
  all_lamps[kMoved] = moved[0];
  EvaluateOptions coarse;
  coarse.wanted_relative_error = 0.05;
  coarse.threads = options.threads;
  const auto all = make_gather_evaluator(one.rays)->evaluate(one.room.receivers, all_lamps, coarse);
  if (!reference.refused.empty() || !direct || !all) {
    Measured none;
    none.refused = !reference.refused.empty() ? reference.refused : (direct ? all : direct).error().detail;
    rows.push_back(transport_row("moved-lamp-of-12", "path", 0, none, std::nullopt, std::nullopt));
    return;
  }
  const Eigen::VectorXd lamp = Eigen::VectorXd::Ones(1), &exact_lx = reference.lux,
                        direct_lx = direct->direct_lux(lamp),
                        total_lx = all->lux(Eigen::VectorXd::Ones(all->emitters()));
  add_incremental_rows(one, {moved[0], exact_lx, direct_lx, total_lx, reference.rms_error}, options, rows);
  for (const Method& method : methods()) {
    // The evaluator may keep everything that it learns about the scene from the lamps at their old places.
    const auto evaluator = method.make(one.rays);
    EvaluateOptions before;
    before.wanted_relative_error = kMovedError;
    before.threads = options.threads;
    before.max_rays = options.quick ? 5'000'000 : 50'000'000;
    (void)evaluator->evaluate(one.room.receivers, one.room.emitters, before);
    std::optional<BenchRow> best;
    for (const double wanted : {0.5, 0.2, 0.1, 0.05, 0.02}) {
      EvaluateOptions after = before;
      after.wanted_relative_error = wanted;
      std::vector<CallSeconds> took;
      Measured run;
      for (int i = 0; i < 3; ++i) {
        Result<TransportMatrix> result = TransportMatrix{};
        took.push_back(timed([&] { result = evaluator->evaluate(one.room.receivers, moved, after); }));
        if (!result) run.refused = result.error().detail;
        if (result) run.matrix = std::move(*result);
      }
      run.seconds = median_of(took).wall;
      run.cpu_seconds = median_of(took).cpu;
      const bool found = run.refused.empty();
      const Eigen::VectorXd against = method.reflects ? exact_lx : direct_lx;
      const double error = found ? error_of_moved(run.matrix.lux(lamp), against, total_lx) : 0;
      BenchRow row = transport_row(method.reflects ? "moved-lamp-of-12" : "moved-lamp-of-12-direct", method.name, error,
                                   run, method.reflects ? std::optional(wanted) : std::nullopt, kMovedError);
      if (found) row.target_seconds = method.reflects ? kMovedSeconds : kMovedDirectSeconds;
      if (!best || error < best->error) best = row;
      if (!found || !method.reflects || error <= kMovedError) break;
    }
    rows.push_back(*best);
  }
}

}  // namespace luxrig
