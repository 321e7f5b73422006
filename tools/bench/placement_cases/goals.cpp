#include "tools/bench/placement_cases/goals.h"

#include <array>

namespace luxrig {
namespace {

/// Neighbours in a list of rooms get very different colours.
const std::array<Vec3, 6> kPaintedColours = {{{1.00, 0.25, 0.20},
                                              {0.30, 0.50, 1.00},
                                              {1.00, 0.80, 0.35},
                                              {0.25, 1.00, 0.35},
                                              {1.00, 1.00, 1.00},
                                              {0.75, 0.30, 1.00}}};

}  // namespace

PlacementCase case_of_room(const std::string& name, LitRoom room) {
  PlacementCase one;
  one.name = name;
  one.lights_in_world_m = room.interior_m;
  one.scene = std::move(room.scene);
  one.receivers = std::move(room.receivers);
  return one;
}

Result<PlacementCase> known_lights_case(const std::string& name, LitRoom room, bool global,
                                        const PlacementCaseOptions& options) {
  std::vector<Emitter> lamps;
  for (const Emitter& lamp : room.emitters)
    lamps.push_back(
        {make_isotropic(lamp.intensity->flux_lm()), {Mat3::Identity(), lamp.world_from_lamp.translation_m}});
  PlacementCase one = case_of_room(name, std::move(room));
  for (const Emitter& lamp : lamps) {
    one.known_places_world_m.push_back(lamp.world_from_lamp.translation_m);
    one.known_lumens.push_back(lamp.intensity->flux_lm());
  }
  const RayScene rays(one.scene);
  const Eigen::VectorXd all = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(lamps.size()));
  EvaluateOptions evaluate;
  evaluate.run() = options;
  const auto direct = make_direct_evaluator(rays)->evaluate(one.receivers, lamps, evaluate);
  if (!direct) return tl::unexpected(direct.error());
  Eigen::VectorXd lux = direct->direct_lux(all);
  Eigen::Index kept = 0;
  for (Eigen::Index r = 0; r < lux.size(); ++r) {
    if (!(lux[r] > 0)) continue;
    lux[kept] = lux[r];
    one.receivers[static_cast<std::size_t>(kept++)] = one.receivers[static_cast<std::size_t>(r)];
  }
  one.receivers.resize(static_cast<std::size_t>(kept));
  one.goal_lux = lux.head(kept);
  if (!global) return one;
  one.global = true;
  evaluate.wanted_relative_error = options.goal_error;
  const auto total = make_path_evaluator(rays)->evaluate(one.receivers, lamps, evaluate);
  if (!total) return tl::unexpected(total.error());
  one.goal_lux = total->lux(all);
  one.goal_standard_error_lux = total->standard_error_lux(all);
  return one;
}

void ask_uniform(PlacementCase& one, double lux) {
  one.goal_lux = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(one.receivers.size()), 1, lux);
}

void ask_colours(PlacementCase& one, const std::vector<Eigen::AlignedBox3d>& regions_world_m, double lux) {
  one.goal_lux = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(one.receivers.size()), 3, lux);
  for (std::size_t r = 0; r < one.receivers.size(); ++r)
    for (std::size_t region = 0; region < regions_world_m.size(); ++region)
      if (regions_world_m[region].contains(one.receivers[r].position_world_m)) {
        one.goal_lux.row(static_cast<Eigen::Index>(r)) =
            lux * kPaintedColours[region % kPaintedColours.size()].transpose();
        break;
      }
}

}  // namespace luxrig
