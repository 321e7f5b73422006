/// New lights around an object, chosen by what is seen; beside random placements, a photographer's key and the thesis's
/// objective. A path-traced picture of each is measured by a program of its own (picture_reading.h).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/check.h"
#include "core/highlight/aim/aim_heads.h"
#include "core/highlight/lights/judged_lights.h"
#include "core/highlight/picture/object_view.h"
#include "core/highlight/seen/seen_selection.h"
#include "tools/bench/highlight/normals_read.h"
#include "tools/bench/highlight/picture_reading.h"
#include "tools/bench/highlight/rows.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {
namespace {

constexpr int kSeenRandom = 200, kSeenRandomQuick = 20;
constexpr double kSeenLumens = 1000, kSeenBeam_rad = rad_from_deg(20), kSeenField_rad = rad_from_deg(40);
/// A closed cube around the object, and the places of lights in it.
constexpr double kSeenRoom_m = 4, kSeenRoomReflectance = 0.7;
constexpr double kSeenPlaceRadii_m[] = {1.3, 1.8};
constexpr int kSeenPlacesPerRadius = 200;
constexpr double kSeenLowest_rad = rad_from_deg(-10);
/// Half the window in which the picture is measured; the object is 1 m across.
constexpr double kSeenWindow_m = 0.02;
constexpr int kSeenPicture_px = 160, kSeenPasses = 2, kSeenNormals_px = 48;
constexpr double kSeenTarget_s = 3;
/// Of the lux that one lamp can give, as HeadAims: an eye or a camera does not adapt to less.
constexpr double kSeenDarkest = 0.1;

Scene in_a_room(Scene object) {
  const Scene room = make_cube(kSeenRoom_m, kSeenRoomReflectance);
  const auto vertices = static_cast<std::uint32_t>(object.vertices_m.size());
  const auto materials = static_cast<std::uint32_t>(object.materials.size()),
             objects = static_cast<std::uint32_t>(object.object_names.size());
  object.vertices_m.insert(object.vertices_m.end(), room.vertices_m.begin(), room.vertices_m.end());
  for (std::size_t t = 0; t < room.triangles.size(); ++t) {
    const auto& v = room.triangles[t];
    object.triangles.push_back({v[0] + vertices, v[1] + vertices, v[2] + vertices});
    object.material_of_triangle.push_back(room.material_of_triangle[t] + materials);
    object.object_of_triangle.push_back(objects);
  }
  object.materials.insert(object.materials.end(), room.materials.begin(), room.materials.end());
  object.object_names.push_back("room");
  return object;
}

struct PlacedHead {
  Vec3 position_world_m, direction;
  double level = 1;
};

struct SeenCase {
  HighlightObject object;
  const BenchOptions& options;
  RayScene alone, room;
  CutAwayCamera view;
  std::shared_ptr<const SeenContrast> seen, quick;
  std::vector<OrientedPoint> form;  ///< of the object, as seen; for its normals
  std::vector<Vec3> places_world_m;
  Intensity intensity = make_spot(kSeenLumens, kSeenBeam_rad, kSeenField_rad);
  /// Of a closed room, evenly reflecting: Φ ρ / (A (1 - ρ)).
  double reflected_lx =
      kSeenLumens * kSeenRoomReflectance / (6 * kSeenRoom_m * kSeenRoom_m * (1 - kSeenRoomReflectance));

  SeenCase(const HighlightObject& original, const BenchOptions& bench)
      : object(original.name(), scaled_to_one_metre(original.scene()), bench),
        options(bench),
        alone(object.scene()),
        room(in_a_room(object.scene())) {
    std::vector<Vec3> shown_m;
    for (const Vec3f& v : object.scene().vertices_m) shown_m.push_back(v.cast<double>());
    std::vector<Sight> wanted;
    for (const OrientedPoint& point : object.study().points) wanted.push_back({point.position_world_m, point.normal});
    view = camera_that_sees(alone, shown_m, wanted, 0.9, rad_from_deg(35), kSeenPicture_px, kSeenPicture_px);
    form = view_at(kSeenNormals_px).samples;
    form.resize(view_at(kSeenNormals_px).object_samples);
    seen = contrast_at(96);
    quick = contrast_at(48);
    for (const double radius_m : kSeenPlaceRadii_m)
      for (int k = 0; k < kSeenPlacesPerRadius; ++k) {
        const double up =
                         std::sin(kSeenLowest_rad) + (1 - std::sin(kSeenLowest_rad)) * (k + 0.5) / kSeenPlacesPerRadius,
                     around_rad = kPi * (3 - std::sqrt(5.0)) * k;
        places_world_m.push_back(radius_m * Vec3(std::sqrt(1 - up * up) * std::cos(around_rad),
                                                 std::sqrt(1 - up * up) * std::sin(around_rad), up));
      }
  }
  [[nodiscard]] SeenView view_at(int across_px) const {
    SeenViewOptions how;
    how.threads = options.threads;
    how.across_px = across_px;
    auto made = see_object(room, alone, view.camera.eye_world_m, how);
    LUXRIG_CHECK(made, "{}", made.error().detail);
    return std::move(*made);
  }
  [[nodiscard]] std::shared_ptr<const SeenContrast> contrast_at(int across_px) const {
    return std::make_shared<const SeenContrast>(std::vector{view_at(across_px)}, SeenWishes{});
  }
  /// Of normals read from one picture per lamp, at the lamp's level, without the room's light [°].
  [[nodiscard]] double normals_deg(std::span<const PlacedHead> heads) const {
    std::vector<LampOnSamples> lamps;
    for (const PlacedHead& head : heads) {
      const Mat3 turn = shortest_rotation(-Vec3::UnitZ(), head.direction);
      LampOnSamples lamp;
      lamp.lux.resize(form.size());
      lux_of_aim(sight_of(room, head.position_world_m, form, options.threads), *intensity,
                 {turn, head.position_world_m}, lamp.lux);
      for (double& lux : lamp.lux) lux *= head.level;
      for (const OrientedPoint& sample : form) {
        const Vec3 to_lamp_m = head.position_world_m - sample.position_world_m;
        lamp.towards.push_back(to_lamp_m.normalized());
        lamp.facing_lx.push_back(head.level * intensity->intensity_cd(turn.transpose() * -lamp.towards.back()) /
                                 to_lamp_m.squaredNorm());
      }
      lamps.push_back(std::move(lamp));
    }
    return deg_from_rad(error_of_read_normals(form, view.camera.eye_world_m, lamps, 1));
  }

  [[nodiscard]] SeenScore score(std::span<const PlacedHead> heads) const {
    std::vector<float> sum(seen->samples().size(), 0);
    std::vector<double> lux(sum.size());
    for (const PlacedHead& head : heads) {
      const HeadSight sight = sight_of(room, head.position_world_m, seen->samples(), options.threads);
      lux_of_aim(sight, *intensity, {shortest_rotation(-Vec3::UnitZ(), head.direction), head.position_world_m}, lux);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += static_cast<float>(head.level * (lux[i] + reflected_lx));
    }
    return seen->score(sum, kSeenDarkest * intensity->max_intensity_cd() / std::pow(kSeenPlaceRadii_m[1], 2));
  }
  [[nodiscard]] PictureReading reading(std::span<const PlacedHead> heads) {
    std::vector<Emitter> emitters;
    std::vector<double> levels;
    for (const PlacedHead& head : heads) {
      emitters.push_back({intensity, {shortest_rotation(-Vec3::UnitZ(), head.direction), head.position_world_m}});
      levels.push_back(head.level);
    }
    PictureOptions how;
    how.threads = options.threads;
    how.max_passes = kSeenPasses;
    how.wanted_relative_error = 0;
    const auto picture = render_picture(room, emitters, levels, view.camera, how);
    LUXRIG_CHECK(picture, "{}", picture.error().detail);
    return read_picture(*picture, view.camera, room, alone, object.study().points, kSeenWindow_m);
  }
};

/// As the task does: places by what is seen, then aims and levels.
std::vector<PlacedHead> seen_heads(SeenCase& of, int count) {
  SeenSelectionOptions how;
  how.threads = of.options.threads;
  how.reflected_lx = of.reflected_lx;
  std::vector<SeenCandidate> candidates;
  for (const Vec3& place_m : of.places_world_m) candidates.push_back({place_m, -place_m.normalized()});
  const SeenSelection selection(*of.quick, of.room, std::move(candidates), *of.intensity, {}, how);
  const SeenChoice chosen = selection.up_to(count).back();

  std::vector<HangingHead> heads;
  for (const std::size_t c : chosen.candidates) {
    HangingHead head;
    head.world_from_mount.translation_m = of.places_world_m[c];
    head.range = {-kPi, kPi, -kPi, kPi};
    head.present = *pan_tilt_towards(head.world_from_mount, selection.candidates()[c].direction, head.range, {});
    head.zoom = {{of.intensity}};
    head.reflected_lx = of.reflected_lx;
    heads.push_back(std::move(head));
  }
  AimWishes wishes;
  wishes.measure = AimMeasure::seen;
  wishes.seen = of.seen;
  wishes.seen_quick = of.quick;
  wishes.travel_weight = 0;
  AimOptions aim;
  aim.threads = of.options.threads;
  const ReliefStudy& study = of.object.study();
  const ContrastSamples samples = one_ring_samples(study.surface, study.interest);
  const auto aims = HeadAims::make(samples, study.features, of.room, heads, wishes, aim);
  LUXRIG_CHECK(aims, "{}", aims.error().detail);
  const auto aimed = aims->solve();
  LUXRIG_CHECK(aimed, "{}", aimed.error().detail);
  std::vector<PlacedHead> placed;
  for (std::size_t k = 0; k < heads.size(); ++k)
    placed.push_back({heads[k].world_from_mount.translation_m,
                      lamp_pose(heads[k], aimed->heads[k].setting.joints).direction({0, 0, -1}),
                      aimed->heads[k].setting.level});
  return placed;
}

std::vector<PlacedHead> thesis_heads(SeenCase& of, int count) {
  const ReliefStudy& study = of.object.study();
  JudgedLightOptions how;
  how.threads = of.options.threads;
  const auto judge = JudgedLights::make(study.surface, study.rays, study.interest, study.features, of.places_world_m,
                                        PotentialLights{}, of.intensity, how);
  LUXRIG_CHECK(judge, "{}", judge.error().detail);
  const auto lights = judge->lights(count);
  LUXRIG_CHECK(lights, "{}", lights.error().detail);
  std::vector<PlacedHead> placed;
  for (const JudgedLight& light : lights->lights) placed.push_back({light.position_world_m, light.direction, 1});
  return placed;
}

/// Key from 45° beside the camera and 45° up, at the lamps' larger distance; with more lights a fill from the other side.
std::vector<PlacedHead> key_at_45_deg(const SeenCase& of, int count) {
  const Vec3 to_eye = of.view.camera.eye_world_m;
  const double azimuth_rad = std::atan2(to_eye.y(), to_eye.x());
  const auto at = [&](double beside_deg, double up_deg, double level) {
    const double a = azimuth_rad + rad_from_deg(beside_deg), e = rad_from_deg(up_deg);
    const Vec3 towards(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
    return PlacedHead{kSeenPlaceRadii_m[1] * towards, -towards, level};
  };
  std::vector<PlacedHead> heads = {at(45, 45, 1)};
  if (count > 1) heads.push_back(at(-45, 20, 0.25));
  return heads;
}

std::vector<PlacedHead> random_heads(const SeenCase& of, int count, std::mt19937_64& random) {
  std::uniform_int_distribution<std::size_t> place(0, of.places_world_m.size() - 1),
      sample(0, of.seen->samples().size() - 1);
  std::uniform_real_distribution<double> level(0.1, 1);
  std::vector<PlacedHead> heads;
  for (int k = 0; k < count; ++k) {
    const Vec3& at_m = of.places_world_m[place(random)];
    heads.push_back({at_m, (of.seen->samples()[sample(random)].position_world_m - at_m).normalized(), level(random)});
  }
  return heads;
}

double rank_among(std::span<const double> others, double mine) {
  return 1 + static_cast<double>(std::ranges::count_if(others, [&](double one) { return one > mine; }));
}

}  // namespace

void add_seen_rows(HighlightObject& object, const BenchOptions& options, std::vector<BenchRow>& rows) {
  std::optional<SeenCase> of;
  for (const int lights : {1, 2, 4, 8}) {
    const std::string name = fmt::format("seen-{}-{}", object.name(), lights);
    if (!highlight_wanted(options, name) || (options.quick && lights > 2)) continue;
    if (!of) of.emplace(object, options);
    std::mt19937_64 random(static_cast<std::uint64_t>(lights));
    std::vector<double> objective, contrast, lit, clipped,
        normals;  // normals: less their error, so that more is better
    for (int k = 0; k < (options.quick ? kSeenRandomQuick : kSeenRandom); ++k) {
      const std::vector<PlacedHead> heads = random_heads(*of, lights, random);
      const PictureReading read = of->reading(heads);
      objective.push_back(of->score(heads).objective);
      contrast.push_back(read.contrast);
      lit.push_back(read.lit);
      clipped.push_back(read.clipped);
      normals.push_back(-of->normals_deg(heads));
    }
    std::vector<HighlightRow> set;
    const auto add = [&](const char* method, const std::vector<PlacedHead>& heads, const CallSeconds& took) {
      const SeenScore score = of->score(heads);
      const PictureReading read = of->reading(heads);
      HighlightRow row{name, method};
      row.took = took;
      row.seen = SeenRow{score.objective,           read.contrast, rank_among(contrast, read.contrast), read.lit,
                         rank_among(lit, read.lit), read.clipped};
      row.seen->normals_deg = of->normals_deg(heads);
      row.seen->normals_rank = rank_among(normals, -row.seen->normals_deg);
      row.note = fmt::format("fine {:.3f}; form {:.3f}; lit {:.3f}; burnt {:.3f}; crushed {:.3f}", score.fine,
                             score.form, score.lit_share, score.burnt_share, score.crushed_share);
      set.push_back(std::move(row));
    };
    std::vector<PlacedHead> heads;
    const CallSeconds took = timed([&] { heads = seen_heads(*of, lights); });
    add("luxrig", heads, took);
    const CallSeconds thesis_took = timed([&] { heads = thesis_heads(*of, lights); });
    add("thesis", heads, thesis_took);
    add("key-45", key_at_45_deg(*of, lights), {});
    const auto add_random = [&](const char* method, const auto& value_of) {
      HighlightRow row{name, method};
      row.seen = SeenRow{};
      row.seen->objective = value_of(objective);
      row.seen->contrast = value_of(contrast);
      row.seen->lit = value_of(lit);
      row.seen->clipped = value_of(clipped);
      row.seen->normals_deg = -value_of(normals);
      row.note = fmt::format("of {} placements; each column by itself", objective.size());
      set.push_back(std::move(row));
    };
    add_random("random-best", [](const std::vector<double>& values) { return *std::ranges::max_element(values); });
    add_random("random-median", [](const std::vector<double>& values) { return median_of(values); });
    double best = 0;
    for (const HighlightRow& row : set) best = std::max(best, row.seen->objective);
    for (HighlightRow& row : set) row.error = 1 - row.seen->objective / best;
    set.front().target_error = 0;
    set.front().target_seconds = kSeenTarget_s;
    for (const HighlightRow& row : set) rows.push_back(bench_row_of(row));
  }
}

}  // namespace luxrig
