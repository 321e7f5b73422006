#include "core/tasks/relief_task.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/highlight/picture/picture_contrast.h"
#include "core/output/keep_out.h"
#include "core/picture/rig_camera.h"
#include "core/rig/housing.h"
#include "core/rig/point_goals.h"
#include "core/rig/zoom.h"
#include "core/scene/object_scene.h"
#include "core/tasks/rig_transport.h"
#include "core/tasks/seen_task.h"

namespace luxrig {
namespace {

/// The object is brightest by all light where it is by direct light, or close to it. All light is computed at this many
/// of its brightest places. With daylight, they are picked from this many that the lamps make brightest.
constexpr std::size_t kCheckedPlaces = 48, kPlacesInDaylight = 4000;
/// Places all over the surface where a search keeps the object's limit, in addition to those where it judges the
/// relief.
constexpr std::size_t kLimitedPlaces = 256;
/// Stops of a zoom, in even ratios: each a third wider than the one before from 6° to 40°.
constexpr int kZoomStops = 8;
constexpr double kSameBeam = 0.02;
/// Floor of errors at places without goals (EvaluateOptions::floor_of_mean).
constexpr double kFloorOfMean = 0.1;

/// Illuminance at places by fixtures at their levels (those at 0 cost nothing), and by daylight unless left out: by all
/// light, and by the light that stays while lights are sought.
struct LuxOfPlaces {
  std::vector<double> all, staying;
};
Result<LuxOfPlaces> lux_at(const ReliefSurroundings& around, std::span<const OrientedPoint> places, const Look& look,
                           const ComputeOptions& options, bool with_daylight = true) {
  LuxOfPlaces lux{std::vector<double>(places.size(), 0), std::vector<double>(places.size(), 0)};
  std::vector<Receiver> receivers;
  for (const OrientedPoint& place : places) receivers.push_back({place.position_world_m, place.normal});
  std::vector<Emitter> lit;
  EvaluateOptions wanted;
  wanted.floor_of_mean = kFloorOfMean;
  std::vector<double> staying_levels;
  const std::vector<Emitter> fixtures = emitters_of(around.rig, look.joints);
  for (std::size_t f = 0; f < look.levels.size(); ++f) {
    if (!(look.levels[f] > 0)) continue;
    lit.push_back(fixtures[f]);
    wanted.levels.push_back(look.levels[f]);
    staying_levels.push_back(around.sought[f] ? 0 : look.levels[f]);
  }
  if (with_daylight)
    for (Emitter& sky : daylight_emitters_of(around.rig)) {
      lit.push_back(std::move(sky));
      wanted.levels.push_back(1);
      staying_levels.push_back(1);
    }
  if (places.empty() || lit.empty()) return lux;
  ComputeOptions compute = options;
  compute.watch.progress = nullptr;
  const auto transport = light_of(around.rays, receivers, lit, wanted, compute);
  if (!transport) return tl::unexpected(transport.error());
  const auto sum = [&](const std::vector<double>& at, std::vector<double>& of) {
    Eigen::Map<Eigen::VectorXd>(of.data(), static_cast<Eigen::Index>(of.size())) =
        transport->lux(Eigen::Map<const Eigen::VectorXd>(at.data(), static_cast<Eigen::Index>(at.size())));
  };
  sum(wanted.levels, lux.all);
  sum(staying_levels, lux.staying);
  return lux;
}

/// Points all over the object's surface.
std::vector<OrientedPoint> places_of(const StudiedObject& object) {
  const TargetSurface& surface = object.study.surface;
  std::vector<OrientedPoint> places;
  for (std::uint32_t i = 0; i < surface.points_m.size(); ++i)
    if (!surface.normals[i].isZero(0)) places.push_back({surface.point_world_m(i), surface.normals[i]});
  return places;
}

/// The brightest places, none within `apart_m` of a brighter one.
std::vector<OrientedPoint> brightest(std::span<const OrientedPoint> places, std::span<const double> lux,
                                     std::size_t most, double apart_m) {
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return lux[a] > lux[b]; });
  std::vector<OrientedPoint> kept;
  for (const std::size_t i : order) {
    if (kept.size() == most) break;
    const auto near = [&](const OrientedPoint& one) {
      return (one.position_world_m - places[i].position_world_m).norm() < apart_m;
    };
    if (!(apart_m > 0) || std::none_of(kept.begin(), kept.end(), near)) kept.push_back(places[i]);
  }
  return kept;
}

/// The look of the fixtures that are not sought; the sought ones are dark.
Look look_that_stays(const ReliefSurroundings& around) {
  Look look = around.look;
  for (std::size_t f = 0; f < look.levels.size(); ++f)
    if (around.sought[f]) look.levels[f] = 0;
  return look;
}

/// Distributions by luminaire and beam angle: heads of one kind share theirs.
using BeamsOfLuminaires = std::map<std::pair<const Luminaire*, double>, Intensity>;

/// Farther from a wanted colour than this, anybody sees another colour.
constexpr double kOtherColour_uv = 0.02;

/// All emitters alike, or in the colour that the task wants.
Result<EmitterMix> mix_of_head(const Rig& rig, std::size_t head, const std::optional<Vec3>& wanted_rgb) {
  const std::vector<std::size_t> housing = housing_of(rig, head);
  if (!wanted_rgb || housing.size() == 1) return EmitterMix{std::vector<double>(housing.size(), 1), 1, 0};
  std::vector<EmitterLight> emitters;
  for (const std::size_t f : housing) {
    const Luminaire& luminaire = rig.luminaires[rig.fixtures[f].luminaire];
    emitters.push_back({luminaire.lumens, luminaire.colour_rgb});
  }
  EmitterMix mix = mix_of_colour(emitters, *wanted_rgb);
  if (mix.off_uv > kOtherColour_uv)
    return refusal(fmt::format(
        "fixture \"{}\" cannot give light of this cct_k: the nearest that its emitters reach is {:.3f} off in "
        "u'v'. Ask for a colour between those of its emitters, or name other heads",
        housing_name(rig, head), mix.off_uv));
  return mix;
}

/// Its present zoom, then stops over its zoom range.
std::vector<ZoomStop> zoom_stops(const Luminaire& luminaire, const Fixture& fixture, double now_rad,
                                 BeamsOfLuminaires& known) {
  const auto stop_at = [&](double beam_rad) {
    Intensity& intensity = known[{&luminaire, beam_rad}];
    if (!intensity) intensity = intensity_at_beam(luminaire, beam_rad);
    return ZoomStop{intensity, beam_rad};
  };
  std::vector<ZoomStop> stops = {stop_at(now_rad)};
  const JointRange& range = fixture.range;
  for (int k = 0; range.zooms() && k < kZoomStops; ++k) {
    const double beam_rad =
        std::min(range.beam_min_rad * std::pow(range.beam_max_rad / range.beam_min_rad, k / (kZoomStops - 1.0)),
                 range.beam_max_rad);
    if (std::abs(beam_rad / now_rad - 1) > kSameBeam) stops.push_back(stop_at(beam_rad));
  }
  return stops;
}

/// All emitters of a housing as one light.
HangingHead hanging_head(const Rig& rig, std::size_t index, const Joints& present, const EmitterMix& mix,
                         BeamsOfLuminaires& known) {
  const Fixture& fixture = rig.fixtures[index];
  const Luminaire& luminaire = housing_luminaire(rig, index);
  HangingHead head;
  head.world_from_mount = fixture.world_from_mount;
  head.roll_rad = fixture.roll_rad;
  head.moves = fixture.moves;
  head.range = fixture.range;
  head.present = present;
  if (fixture.moves) {
    head.pan_speed_rad_s = fixture.pan_speed_rad_s;
    head.tilt_speed_rad_s = fixture.tilt_speed_rad_s;
  }
  if (fixture.range.zooms()) head.zoom_speed_rad_s = fixture.zoom_speed_rad_s;
  head.zoom = zoom_stops(luminaire, fixture, present.beam_rad, known);
  if (mix.flux_share != 1)
    for (ZoomStop& stop : head.zoom)
      stop.intensity = scaled_to_flux(stop.intensity, mix.flux_share * stop.intensity->flux_lm());
  head.max_level = rig.max_level(fixture);
  head.watts = mix.flux_share * luminaire.watts.value_or(0);
  return head;
}

/// Adds limits at eyes and cameras.
void add_limits_of_eyes(const ReliefSurroundings& around, const AimSpec& aim, std::vector<AimLimit>& limits) {
  if (!aim.max_eye_lx) return;
  for (const std::size_t eye : aim.eyes)
    limits.push_back({around.rig.points[eye].name + " (eye)",
                      {around.rig.points[eye].position_world_m, Vec3::Zero()},
                      *aim.max_eye_lx,
                      0});
  for (const PictureCamera& camera : around.rig.cameras)
    limits.push_back({camera.name + " (camera)", {camera.position_world_m, Vec3::Zero()}, *aim.max_eye_lx, 0});
}

/// Sets of heads of which one shall be lit: all, or those that a window allows.
Result<std::vector<std::vector<std::size_t>>> heads_to_try(std::span<const HangingHead> heads,
                                                           const LightWindow& window, const Vec3& middle_world_m) {
  std::vector<std::vector<std::size_t>> choices;
  std::vector<std::size_t> inside;
  double distance_m = 0;
  for (std::size_t k = 0; k < heads.size(); ++k) {
    const Vec3 towards_m = heads[k].world_from_mount.translation_m - middle_world_m;
    distance_m += towards_m.norm() / static_cast<double>(heads.size());
    if (window.open() || (towards_m.norm() > 0 && window.has(towards_m))) inside.push_back(k);
  }
  const auto side_of = [&](std::size_t k) {
    return window.side_of(heads[k].world_from_mount.translation_m - middle_world_m);
  };
  if (!window.lights()) {
    if (!inside.empty()) choices.push_back(inside);
  } else if (*window.lights() == 1) {
    for (const std::size_t k : inside) choices.push_back({k});
  } else {
    for (const std::size_t left : inside)
      for (const std::size_t right : inside)
        if (side_of(left) < 0 && side_of(right) > 0) choices.push_back({std::min(left, right), std::max(left, right)});
  }
  if (!choices.empty()) return choices;
  const auto there = [&](int side) {
    const Vec3 at_m = middle_world_m + distance_m * window.middle(side);
    return fmt::format("{:.2f} {:.2f} {:.2f}", at_m.x(), at_m.y(), at_m.z());
  };
  const auto missing = [&](int side) {
    return std::none_of(inside.begin(), inside.end(), [&](std::size_t k) { return side_of(k) == side; });
  };
  std::string where;
  if (window.lights() == 2)
    where = missing(-1) && missing(1) ? there(-1) + " and " + there(1) : there(missing(-1) ? -1 : 1);
  else
    where = there(-1) == there(1) ? there(1) : there(-1) + " or " + there(1);
  return refusal(
      fmt::format("{}, and {} of its heads hangs there: hang one at {} m, as seen from the object's middle at "
                  "{:.2f} {:.2f} {:.2f} m, or name other heads",
                  window.words(), window.lights() == 2 ? "no pair" : "none", where, middle_world_m.x(),
                  middle_world_m.y(), middle_world_m.z()));
}

}  // namespace

Result<StudiedObject> study_object(const Session& session, const ReliefSpec& relief, const ComputeOptions& options) {
  const Rig& rig = session.rig;
  const std::string& name = rig.scene.objects[relief.object].name;
  const auto object = object_scene(session.scene, name);
  if (!object) return tl::unexpected(object.error());
  ReliefStudyOptions how;
  how.scale_m = relief.scale_m.value_or(0);
  how.interest.wanted_share = relief.interest;
  how.interest.max_points = kAimPoints;
  how.run() = options.of_part();
  auto study = study_relief(*object, how);
  if (!study) return in_words(study.error(), fmt::format("object \"{}\"", name));
  if (relief.camera) {
    const PictureCamera& camera = rig.cameras[*relief.camera];
    std::vector<bool> seen;
    for (const OrientedPoint& point : study->points)
      seen.push_back(seen_place(view_of(camera), *session.rays, point).has_value());
    keep_interest(*study, seen);
    if (study->interest.empty())
      return refusal(fmt::format("object \"{}\": camera \"{}\" sees none of its recessed places", name, camera.name));
  }
  ContrastSamples samples = one_ring_samples(study->surface, study->interest);
  return StudiedObject{std::move(*study), std::move(samples)};
}

Result<std::vector<AimLimit>> limits_of(const ReliefSurroundings& around, const StudiedObject& object,
                                        const ReliefSpec& relief, const ComputeOptions& options) {
  std::vector<AimLimit> limits;
  const PointGoals asked = point_goals(around.rig.points, false);
  for (Eigen::Index i = 0; i < asked.max_lx.size(); ++i) {
    if (!asked.limits(i)) continue;
    const Point& point = around.rig.points[static_cast<std::size_t>(i)];
    limits.push_back({point.name, {point.position_world_m, point.normal_world}, asked.max_lx[i], around.point_lux[i]});
  }
  if (!relief.max_lx) return limits;
  const std::vector<OrientedPoint> all = places_of(object);
  std::vector<OrientedPoint> places;
  for (std::size_t k = 0; k < std::min(kLimitedPlaces, all.size()); ++k)
    places.push_back(all[k * all.size() / std::min(kLimitedPlaces, all.size())]);
  const auto fixed = lux_at(around, places, look_that_stays(around), options);
  if (!fixed) return tl::unexpected(fixed.error());
  for (std::size_t k = 0; k < places.size(); ++k)
    limits.push_back({around.rig.scene.objects[relief.object].name, places[k], *relief.max_lx, fixed->all[k]});
  return limits;
}

Result<std::vector<double>> staying_lux(const ReliefSurroundings& around, const StudiedObject& object,
                                        const ComputeOptions& options) {
  auto lux = lux_at(around, object.samples.points, look_that_stays(around), options);
  if (!lux) return tl::unexpected(std::move(lux.error()));
  return std::move(lux->all);
}

Result<AimedFixtures> aim_fixtures(const ReliefSurroundings& around, const StudiedObject& object, const Task& task,
                                   std::span<const double> present_levels, const ComputeOptions& options) {
  const AimSpec& spec = task.aim;
  std::optional<Stage> before(std::in_place, options.watch.without_stop(), task.name, "light that stays");
  auto fixed = staying_lux(around, object, options);
  if (!fixed) return tl::unexpected(fixed.error());
  auto limits = limits_of(around, object, spec.relief, options);
  if (!limits) return tl::unexpected(limits.error());
  before.reset();

  const Stage stage(options.watch, task.name, "aiming");
  AimWishes wishes;
  wishes.limits = std::move(*limits);
  add_limits_of_eyes(around, spec, wishes.limits);
  wishes.max_object_lx = spec.relief.max_lx.value_or(std::numeric_limits<double>::infinity());
  wishes.measure = spec.relief.relative ? AimMeasure::relative : AimMeasure::lux;
  wishes.max_watts = around.max_watts;
  wishes.min_key_to_fill = spec.key ? spec.min_key_to_fill : 0;
  wishes.max_key_to_fill = spec.max_key_to_fill.value_or(std::numeric_limits<double>::infinity());
  wishes.coverage_weight = spec.relief.coverage_weight;
  wishes.energy_weight = spec.energy_weight;
  wishes.base_weight = spec.base_weight;
  wishes.travel_weight = spec.travel_weight;
  wishes.base_lx = spec.base_lx;

  const KeepOutZones zones(around.rig);
  std::vector<HangingHead> heads;
  std::vector<HeadSetting> present;
  std::vector<EmitterMix> mixes;
  BeamsOfLuminaires known;
  for (std::size_t k = 0; k < spec.heads.size(); ++k) {
    const Joints& joints = around.look.joints[spec.heads[k]];
    if (spec.key == spec.heads[k]) wishes.key = k;
    auto mix = mix_of_head(around.rig, spec.heads[k], spec.relief.light_rgb);
    if (!mix) return in_words(mix.error(), fmt::format("task \"{}\"", task.name));
    heads.push_back(hanging_head(around.rig, spec.heads[k], joints, *mix, known));
    mixes.push_back(std::move(*mix));
    heads.back().may_light = [&zones, head = spec.heads[k]](const Joints& at) { return !zones.met(head, at); };
    present.push_back({joints, 0, present_levels[k]});
  }
  const auto refuse = [&](const Fault& fault) { return in_words(fault, fmt::format("task \"{}\"", task.name)); };
  std::optional<SeenObject> seen;
  std::vector<std::vector<std::size_t>> choices = {std::vector<std::size_t>(heads.size())};
  std::iota(choices[0].begin(), choices[0].end(), std::size_t{0});
  if (spec.relief.seen) {
    auto found = seen_object(around, object, spec.relief, *fixed, options);
    if (!found) return refuse(found.error());
    seen = std::move(*found);
    if (auto added = wish_what_is_seen(around, object, *seen, heads, wishes, options); !added)
      return refuse(added.error());
    auto in_window = heads_to_try(heads, seen->window, object.study.surface.centroid_world_m());
    if (!in_window) return refuse(in_window.error());
    choices = std::move(*in_window);
  }
  wishes.fixed_lux = std::move(*fixed);
  AimOptions aim;
  aim.run() = options.of_part();
  aim.watch.stop = stage.stop();
  const AimWishes of_relief = wishes;
  const LitPlaces places = lit_places(object, spec.relief, seen ? &*seen : nullptr, wishes);
  const auto of_heads = [&](const std::vector<std::size_t>& chosen) {
    std::vector<HangingHead> some;
    for (const std::size_t k : chosen) some.push_back(heads[k]);
    return HeadAims::make(*places.samples, *places.features, around.rays, std::move(some), wishes, aim);
  };
  std::optional<AimResult> best;
  std::optional<HeadAims> of_all;
  std::vector<std::size_t> lit;
  std::size_t tried = 0;
  Fault trouble;
  for (const std::vector<std::size_t>& chosen : choices) {
    if (best && stage.stop().stop_requested()) break;
    auto search = of_heads(chosen);
    auto found = search ? search->solve() : tl::unexpected(search.error());
    if (!found) {
      trouble = found.error();
      continue;
    }
    tried += found->tried;
    if (chosen.size() == heads.size()) of_all = std::move(*search);
    if (best && found->score.objective <= best->score.objective) continue;
    best = std::move(*found);
    lit = chosen;
  }
  if (!best) return refuse(trouble);
  AimedFixtures aimed;
  aimed.mixes = std::move(mixes);
  aimed.score = std::move(best->score);
  aimed.tried = tried;
  for (std::size_t k = 0; k < heads.size(); ++k) {
    const auto at = std::find(lit.begin(), lit.end(), k) - lit.begin();
    if (static_cast<std::size_t>(at) < lit.size()) {
      aimed.heads.push_back(best->heads[static_cast<std::size_t>(at)]);
      aimed.without.push_back(std::move(best->without[static_cast<std::size_t>(at)]));
      aimed.gain_if_lit.push_back(best->gain_if_lit[static_cast<std::size_t>(at)]);
    } else {
      aimed.heads.push_back({{heads[k].present, 0, 0}, Vec3::Zero(), true});
      aimed.without.push_back(aimed.score);
      aimed.gain_if_lit.push_back(std::numeric_limits<double>::quiet_NaN());
    }
  }
  if (!of_all) {
    std::vector<std::size_t> all(heads.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    auto search = of_heads(all);
    if (!search) return refuse(search.error());
    of_all = std::move(*search);
  }
  aimed.before = of_all->score(present);
  if (places.own) {
    std::vector<HeadSetting> settings;
    for (const AimedHead& one : aimed.heads) settings.push_back(one.setting);
    judge_relief(around, object, heads, settings, of_relief, aim, aimed.score);
    judge_relief(around, object, heads, present, of_relief, aim, aimed.before);
  }
  if (seen) aimed.asked = std::move(seen->asked);
  return aimed;
}

void judge_relief(const ReliefSurroundings& around, const StudiedObject& object, std::vector<HangingHead> heads,
                  std::span<const HeadSetting> settings, const AimWishes& wishes, const AimOptions& options,
                  AimScore& score) {
  const auto judge =
      HeadAims::make(object.samples, object.study.features, around.rays, std::move(heads), wishes, options);
  AimScore of_relief;
  of_relief.local_contrast_lx = of_relief.relative_contrast = of_relief.coverage =
      std::numeric_limits<double>::quiet_NaN();
  if (judge) of_relief = judge->score(settings);
  score.local_contrast_lx = of_relief.local_contrast_lx;
  score.relative_contrast = of_relief.relative_contrast;
  score.coverage = of_relief.coverage;
}

tl::unexpected<Fault> in_words(Fault fault, const std::string& of) {
  fault.detail = of + ": " + fault.detail;
  return tl::unexpected(std::move(fault));
}

Result<ObjectLight> light_on_object(const ReliefSurroundings& around, const StudiedObject& object, const Look& look,
                                    const ComputeOptions& options) {
  std::vector<OrientedPoint> places = places_of(object);
  ComputeOptions direct = options;
  direct.model = Model::direct;
  auto by_direct = lux_at(around, places, look, direct, false);
  if (!by_direct) return tl::unexpected(by_direct.error());
  if (around.rig.daylight) {
    places = brightest(places, by_direct->all, kPlacesInDaylight, 0);
    by_direct = lux_at(around, places, look, direct);
    if (!by_direct) return tl::unexpected(by_direct.error());
  }
  places = brightest(places, by_direct->all, kCheckedPlaces, object.study.scale_m / 2);
  auto lux = lux_at(around, places, look, options);
  if (!lux) return tl::unexpected(lux.error());
  ObjectLight light{std::move(lux->staying), std::move(lux->all)};
  for (std::size_t i = 0; i < places.size(); ++i) light.sought_lx[i] -= light.fixed_lx[i];
  return light;
}

double ObjectLight::share_within(double max_lx) const {
  double share = 1;
  for (std::size_t i = 0; i < fixed_lx.size(); ++i)
    if (fixed_lx[i] + sought_lx[i] > max_lx && sought_lx[i] > 0)
      share = std::min(share, std::max(0.0, (max_lx - fixed_lx[i]) / sought_lx[i]));
  return share;
}

double ObjectLight::brightest_lx(double share) const {
  double most = 0;
  for (std::size_t i = 0; i < fixed_lx.size(); ++i) most = std::max(most, fixed_lx[i] + share * sought_lx[i]);
  return most;
}

}  // namespace luxrig
