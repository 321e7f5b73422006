#include "core/tasks/highlight_task.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/highlight/lights/judged_lights.h"
#include "core/highlight/seen/seen_selection.h"
#include "core/photometry/beam.h"
#include "core/scene/object_scene.h"
#include "core/tasks/seen_task.h"

namespace luxrig {
namespace {

constexpr double kBeamShare = 0.9;  // share of the flux inside the beam (thesis §6.5)
/// Of each kind, where lights are chosen by what is seen; and of these, to find how much the room reflects.
constexpr std::size_t kSeenCandidates = 200, kReflectionSamples = 6;

/// The surfaces of [mounting] for lights, or nested boxes around the object.
Result<LightDomain> domain_of(const ReliefSurroundings& around, const StudiedObject& object, const Mounting& mounting) {
  const MountingSpec& spec = around.rig.mounting;
  if (spec.surfaces.empty()) {
    // Boxes out to the extent of the mounting's box.
    NestedBoxOptions boxes;
    boxes.margin_m = boxes.step_m =
        std::max(mounting.box_world_m().diagonal().norm() / 8, object.study.surface.diagonal_m() / 4);
    return nested_box_domain(object.study.surface, boxes);
  }
  std::vector<std::uint8_t> marks(around.scene.triangles.size(), 0);
  const auto fits = [&](const std::string& name) {
    return std::any_of(spec.surfaces.begin(), spec.surfaces.end(), [&](const MountingSpec::Pattern& pattern) {
      return fnmatch(pattern.text.c_str(), name.c_str(), 0) == 0;
    });
  };
  for (std::size_t t = 0; t < marks.size(); ++t)
    marks[t] = fits(around.scene.materials[around.scene.material_of_triangle[t]].name) ||
               fits(around.scene.object_names[around.scene.object_of_triangle[t]]);
  LightDomainOptions layers;
  // On both sides: visibility and may_hang decide which of them is in the room.
  layers.layer_offsets_m = {spec.offset_min_m, -spec.offset_min_m};
  if (spec.offset_max_m > spec.offset_min_m) {
    layers.layer_offsets_m.push_back(spec.offset_max_m);
    layers.layer_offsets_m.push_back(-spec.offset_max_m);
  }
  return mesh_light_domain(around.scene, marks, object.study.surface.centroid_world_m(), layers);
}

/// Places where a light may hang: the centres of the domain's cells, snapped within box and offsets.
std::vector<Vec3> hangable_places(const LightDomain& domain, const Mounting& mounting) {
  std::vector<Vec3> places;
  for (const LightDomain::CellCentre& centre : domain.cell_centres())
    if (const auto snapped = mounting.snapped(centre.position_world_m)) places.push_back(snapped->place_world_m);
  return places;
}

template <class Fits>
PotentialLights hangable_lights(const PotentialLights& all, const Mounting& mounting, const Fits& fits) {
  PotentialLights kept;
  kept.features = all.features;
  kept.points_of_feature = all.points_of_feature;
  for (std::size_t l = 0; l < all.lights.size(); ++l) {
    const auto snapped = mounting.snapped(all.lights[l].position_world_m);
    if (!snapped || !fits(snapped->place_world_m)) continue;
    kept.lights.push_back(all.lights[l]);
    kept.lights.back().position_world_m = snapped->place_world_m;
    const auto votes = all.of(l);
    kept.votes.insert(kept.votes.end(), votes.begin(), votes.end());
    kept.begin.push_back(kept.votes.size());
  }
  return kept;
}

/// Where lights of a window would hang, as far off as the mounting's middle.
std::string middles_of(const SeenObject& seen, const StudiedObject& object, const Mounting& mounting) {
  const Vec3 middle_world_m = object.study.surface.centroid_world_m();
  const double distance_m =
      std::max((mounting.box_world_m().center() - middle_world_m).norm(), object.study.surface.diagonal_m());
  const auto there = [&](int side) {
    const Vec3 at_m = middle_world_m + distance_m * seen.window.middle(side);
    return fmt::format("{:.2f} {:.2f} {:.2f}", at_m.x(), at_m.y(), at_m.z());
  };
  return fmt::format("{} m {} {} m", there(-1), seen.window.lights() == 2 ? "and" : "or", there(1));
}

HangingHead new_head(const Rig& rig, const Luminaire& luminaire, const Vec3& place_world_m, const Vec3& direction) {
  HangingHead head;
  head.world_from_mount.translation_m = place_world_m;
  head.range = {-kPi, kPi, -kPi, kPi};  // it is hung in any direction: no joint stops it
  head.present = pan_tilt_towards(head.world_from_mount, direction, head.range, {}).value_or(Joints{});
  head.zoom = {{luminaire.intensity}};
  head.max_level = rig.limits.max_level;
  head.watts = luminaire.watts.value_or(0);
  return head;
}

/// Every n-th of so many that at most `most` are left.
template <class List, class Take>
void take_evenly(const List& list, std::size_t most, const Take& take) {
  const std::size_t count = std::min(most, list.size());
  for (std::size_t k = 0; k < count; ++k) take(list[k * list.size() / count]);
}

Vec3 middle_of_wanted(const SeenObject& seen) {
  Vec3 middle_world_m = Vec3::Zero();
  const std::vector<float>& wanted = seen.quick_asked.role.wanted;
  for (std::size_t s = 0; s < wanted.size(); ++s)
    middle_world_m += double(wanted[s]) * seen.quick->samples()[s].position_world_m;
  return middle_world_m;
}

/// Places and first aims, by the coarse picture: among those of most contrast, and places all over the domain with the
/// beam on the object's middle.
Result<std::vector<JudgedLight>> lights_by_what_is_seen(const ReliefSurroundings& around, const StudiedObject& object,
                                                        const Task& task, const JudgedLights& judge,
                                                        std::span<const Vec3> places, const SeenObject& seen,
                                                        const ComputeOptions& options) {
  const HighlightSpec& spec = task.highlight;
  const Luminaire& luminaire = around.rig.luminaires[spec.luminaire];
  const Vec3 middle_world_m = object.study.surface.centroid_world_m();
  const Vec3 aim_world_m = spec.relief.role == LightRole::background ? middle_of_wanted(seen) : middle_world_m;
  std::vector<SeenCandidate> candidates;
  const auto side_of = [&](const Vec3& place_m) {
    return seen.window.lights() == 2 ? seen.window.side_of(place_m - middle_world_m) : 0;
  };
  std::vector<HangingHead> for_reflection;
  take_evenly(judge.candidates(), kSeenCandidates, [&](const JudgedLight& one) {
    candidates.push_back({one.position_world_m, one.direction, side_of(one.position_world_m)});
  });
  take_evenly(places, kSeenCandidates, [&](const Vec3& place_m) {
    if ((aim_world_m - place_m).norm() > 0)
      candidates.push_back({place_m, (aim_world_m - place_m).normalized(), side_of(place_m)});
  });
  take_evenly(candidates, kReflectionSamples, [&](const SeenCandidate& one) {
    for_reflection.push_back(new_head(around.rig, luminaire, one.position_world_m, one.direction));
  });
  const auto reflected_lx = reflected_lx_of(around, object, for_reflection, options);
  if (!reflected_lx) return tl::unexpected(reflected_lx.error());
  SeenSelectionOptions how;
  how.run() = options.of_part();
  how.role = seen.quick_asked.role;
  for (const double one : *reflected_lx) how.reflected_lx += one / static_cast<double>(reflected_lx->size());
  const SeenSelection selection(*seen.quick, around.rays, std::move(candidates), *luminaire.intensity,
                                seen.quick_fixed_lux, how);
  const std::optional<int> number = seen.window.lights() ? seen.window.lights() : spec.lights;
  const std::vector<SeenChoice> by_number = selection.up_to(number.value_or(spec.max_lights));
  if (by_number.empty()) return refusal("no light that may hang somewhere lights what is seen of the object");
  std::vector<double> objective;
  for (const SeenChoice& choice : by_number) objective.push_back(choice.score.objective);
  if (seen.window.lights() && by_number.size() < static_cast<std::size_t>(*seen.window.lights()))
    return refusal(
        fmt::format("{}, and the mounting has no place on one of them: widen [mounting]", seen.window.words()));
  const SeenChoice& chosen = number ? by_number.back() : by_number[number_at_peak(objective)];
  std::vector<JudgedLight> lights;
  for (const std::size_t c : chosen.candidates)
    lights.push_back({selection.candidates()[c].position_world_m, selection.candidates()[c].direction, 0, {}});
  return lights;
}

}  // namespace

Result<PlacedReliefLights> find_relief_lights(const ReliefSurroundings& around, const StudiedObject& object,
                                              const Task& task, const Mounting& mounting,
                                              const ComputeOptions& options) {
  const HighlightSpec& spec = task.highlight;
  const Luminaire& luminaire = around.rig.luminaires[spec.luminaire];
  const auto refuse = [&](const Fault& fault) { return in_words(fault, fmt::format("task \"{}\"", task.name)); };
  std::optional<Stage> before(std::in_place, options.watch.without_stop(), task.name, "looking for shadow edges");
  const ReliefStudy& study = object.study;
  ShadowEdgeOptions of_edges;
  of_edges.run() = options.of_part();
  const auto edges = find_shadow_edges(study.rays, study.points, of_edges);
  if (!edges) return refuse(edges.error());

  before->say("asking where lights may hang");
  const auto domain = domain_of(around, object, mounting);
  if (!domain) return refuse(domain.error());
  const auto others = scene_without_object(around.scene, around.rig.scene.objects[spec.relief.object].name);
  if (!others) return refuse(others.error());
  const RayScene environment(*others);
  DomainVoteOptions of_votes;
  of_votes.surroundings.environment = &environment;
  of_votes.run() = options.of_part();
  const auto votes = vote_on_domain(*domain, *edges, study.points, study.features.cluster_of_point, of_votes);
  if (!votes) return refuse(votes.error());
  PotentialLightOptions of_lights;
  of_lights.beam_angle_rad = cone_of_flux_rad(*luminaire.intensity, kBeamShare);
  of_lights.run() = options.of_part();
  const auto potential = potential_lights(*votes, of_lights);
  if (!potential) return refuse(potential.error());
  std::optional<std::vector<double>> fixed;
  const auto light_that_stays = [&]() -> Result<void> {
    auto lux = staying_lux(around, object, options);
    if (!lux) return tl::unexpected(lux.error());
    fixed = std::move(*lux);
    return {};
  };
  std::optional<SeenObject> seen;
  if (spec.relief.seen) {
    if (auto known = light_that_stays(); !known) return refuse(known.error());
    auto looked_at = seen_object(around, object, spec.relief, *fixed, options);
    if (!looked_at) return refuse(looked_at.error());
    seen = std::move(*looked_at);
  }
  const Vec3 middle_world_m = study.surface.centroid_world_m();
  const auto in_window = [&](const Vec3& place_m) {
    return !seen || seen->window.open() || seen->window.has(place_m - middle_world_m);
  };
  std::vector<Vec3> places = hangable_places(*domain, mounting);
  if (places.empty())
    return refusal(
        fmt::format("task \"{}\": lights may hang at none of {} places: widen box_m or offset_m of "
                    "[mounting], or lower clearance_m",
                    task.name, domain->cell_centres().size()));

  std::erase_if(places, [&](const Vec3& place_m) { return !in_window(place_m); });
  if (places.empty())
    return refusal(fmt::format("task \"{}\": {}, and nothing may hang there: widen [mounting], for instance to {}",
                               task.name, seen->window.words(), middles_of(*seen, object, mounting)));
  before->say("judging lights");
  JudgedLightOptions of_judge;
  of_judge.surroundings.environment = &environment;
  of_judge.lift_m = 1e-4 * study.surface.diagonal_m();
  of_judge.coverage_weight = spec.relief.coverage_weight;
  of_judge.run() = options.of_part();
  const auto judge =
      JudgedLights::make(study.surface, study.rays, study.interest, study.features, places,
                         hangable_lights(*potential, mounting, in_window), luminaire.intensity, of_judge);
  if (!judge) return refuse(judge.error());
  PlacedReliefLights found;
  JudgedLightSet chosen;
  if (seen) {
    auto lights = lights_by_what_is_seen(around, object, task, *judge, places, *seen, options);
    if (!lights) return refuse(lights.error());
    chosen.lights = std::move(*lights);
  } else if (spec.lights) {
    auto lights = judge->lights(*spec.lights);
    if (!lights) return refuse(lights.error());
    chosen = std::move(*lights);
  } else {
    auto count = judge->count_lights(spec.max_lights);
    if (!count) return refuse(count.error());
    for (const JudgedLightSet& set : count->by_number) found.contrast_lx.push_back(set.score.local_contrast_lx);
    chosen = std::move(count->by_number[count->best]);
  }

  before->say("light that stays");
  if (!fixed)
    if (auto known = light_that_stays(); !known) return refuse(known.error());
  auto limits = limits_of(around, object, spec.relief, options);
  if (!limits) return refuse(limits.error());
  before.reset();

  const Stage stage(options.watch, task.name, "aiming");
  AimWishes wishes;
  wishes.limits = std::move(*limits);
  wishes.max_object_lx = spec.relief.max_lx.value_or(std::numeric_limits<double>::infinity());
  wishes.max_watts = around.max_watts;
  wishes.coverage_weight = spec.relief.coverage_weight;
  wishes.travel_weight = 0;
  std::vector<HangingHead> heads;
  for (const JudgedLight& light : chosen.lights)
    heads.push_back(new_head(around.rig, luminaire, light.position_world_m, light.direction));
  if (seen)
    if (auto added = wish_what_is_seen(around, object, *seen, heads, wishes, options); !added)
      return refuse(added.error());
  wishes.fixed_lux = std::move(*fixed);
  const AimWishes of_relief = wishes;
  const std::vector<HangingHead> hung = heads;
  const LitPlaces lit = lit_places(object, spec.relief, seen ? &*seen : nullptr, wishes);
  AimOptions aim;
  aim.run() = options.of_part();
  aim.watch.stop = stage.stop();
  const auto search =
      HeadAims::make(*lit.samples, *lit.features, around.rays, std::move(heads), std::move(wishes), aim);
  if (!search) return refuse(search.error());
  auto aimed = search->solve();
  if (!aimed) return refuse(aimed.error());
  found.score = std::move(aimed->score);
  found.tried = aimed->tried;
  if (lit.own) {
    std::vector<HeadSetting> settings;
    for (const AimedHead& one : aimed->heads) settings.push_back(one.setting);
    judge_relief(around, object, hung, settings, of_relief, aim, found.score);
  }
  if (seen) found.asked = std::move(seen->asked);
  for (std::size_t l = 0; l < aimed->heads.size(); ++l) {
    const AimedHead& head = aimed->heads[l];
    if (!(head.setting.level > 0)) {
      found.dark_gains.push_back(aimed->gain_if_lit[l]);
      continue;
    }
    found.without.push_back(std::move(aimed->without[l]));
    LightInScene light;
    light.position_world_m = chosen.lights[l].position_world_m;
    light.aim_world_m = head.aim_world_m;
    light.level = head.setting.level;
    light.levels.assign(around.rig.emitters_or_itself(spec.luminaire).size(), head.setting.level);
    found.lights.push_back(std::move(light));
  }
  return found;
}

}  // namespace luxrig
