#include "core/tasks/rig_notes/rig_notes.h"

#include <algorithm>
#include <cmath>

#include "core/scene/room_bounds.h"
#include "core/tasks/rig_notes/closed_objects.h"
#include "core/tasks/rig_notes/scene_reading.h"
#include "core/tasks/rig_transport.h"
#include "core/transport/direct/emitter_sampler.h"

namespace luxrig {
namespace {

/// For each kind of thing, this many single notes, then one for the rest.
constexpr std::size_t kMaxNotes = 8;
/// A fixture that sees no point is outside if it is this far out, as a share of the scene's diagonal.
constexpr double kOutShare = 0.01;
/// A fixture is far away from this many diagonals on, and at least this distance.
constexpr double kTooFarDiagonals = 2, kFar_m = 10;
/// A lamp this near to a point counts as in it.
constexpr double kInPoint_m = 0.02;
/// A surface this near before a point, which fills this share of the point's view within this reach.
constexpr double kBefore_m = 0.03, kBeforeReach_m = 0.15, kBeforeShare = 0.9;
constexpr int kLooks = 48;
/// Counts as no light: below this share of the point's goal; for a point without one, of the rig's smallest goal, limit
/// or mean.
constexpr double kNoLightOfGoal = 0.01, kNoLight = 0.001;
constexpr double kErrorOfNotes = 0.3;
constexpr std::uint64_t kMaxRays = 20'000'000;

class Notes {
 public:
  Notes(const Rig& rig, const Scene& scene, const RayScene& rays, int threads, std::stop_token stop)
      : rig_(rig),
        scene_(scene),
        rays_(rays),
        threads_(threads),
        stop_(std::move(stop)),
        bounds_(room_of(rig, scene)),
        diagonal_m_(bounds_.diagonal().norm()),
        fixtures_(placed_fixtures(rig)),
        things_(placed_receivers(rig)),
        receivers_(receivers_of(rig)) {}

  std::vector<Problem> all() {
    for (const PlacedFixture& fixture : fixtures_)
      if (auto note = of_fixture(fixture)) add(fixture, std::move(*note));
    summarise("fixtures");
    find_light();
    const ClosedObjects objects(scene_, rays_);
    for (std::size_t r = 0; r < receivers_.size(); ++r)
      if (auto note = of_receiver(r, objects)) add(things_[r], std::move(*note));
    summarise("points and luxmeters");
    for (const PlacedFixture& fixture : fixtures_)
      for (std::size_t r = 0; r < receivers_.size(); ++r)
        if (auto note = of_nearness(fixture, things_[r])) add(fixture, std::move(*note));
    summarise("lamps");
    return std::move(notes_);
  }

 private:
  struct Note {
    std::string what, mend;
  };
  struct Light {
    bool none = false;
    double lux = 0, direct_lx = 0, error_lx = 0;
  };

  void add(const PlacedThing& thing, Note note) {
    if (kept_++ < kMaxNotes) {
      notes_.push_back({rig_.file.string(), thing.in_file.line, thing.in_file.column, thing.text() + " " + note.what,
                        std::move(note.mend)});
      return;
    }
    last_ = thing.in_file;
    more_ += (more_.empty() ? "" : ", ") + thing.name;
  }

  void summarise(const char* things) {
    if (kept_ > kMaxNotes)
      notes_.push_back({rig_.file.string(), last_.line, last_.column,
                        fmt::format("{} more {} likewise: {}", kept_ - kMaxNotes, things,
                                    more_.size() > 200 ? more_.substr(0, more_.find(',', 200)) + " …" : more_),
                        "mend those above first"});
    kept_ = 0;
    more_.clear();
  }

  // Fixtures.

  std::optional<Note> of_fixture(const PlacedFixture& fixture) const {
    const double out_m = bounds_.exteriorDistance(fixture.position_world_m);
    if (out_m <= kOutShare * diagonal_m_) return std::nullopt;
    const bool far = out_m > std::max(kFar_m, kTooFarDiagonals * diagonal_m_);
    if (!far && (receivers_.empty() || sees_a_point(fixture.position_world_m))) return std::nullopt;
    return Note{fmt::format("is at {}, {} outside of the scene ({}){}", position_text(fixture.position_world_m),
                            length_text(out_m), extent_text(bounds_),
                            far ? "" : ", and no point or luxmeter can be seen from there"),
                "correct its position_m, or the scene's unit and up_axis"};
  }

  bool sees_a_point(const Vec3& from_world_m) const {
    return std::any_of(receivers_.begin(), receivers_.end(),
                       [&](const Receiver& receiver) { return faces_and_sees(receiver, from_world_m); });
  }
  bool faces_and_sees(const Receiver& receiver, const Vec3& lamp_world_m) const {
    return receiver.normal_world.dot(lamp_world_m - receiver.position_world_m) > 0 &&
           !rays_.occluded(receiver.position_world_m, receiver.normal_world, lamp_world_m);
  }

  std::optional<Note> of_nearness(const PlacedFixture& fixture, const PlacedThing& thing) const {
    const double distance_m = (fixture.position_world_m - thing.position_world_m).norm();
    if (distance_m > kInPoint_m) return std::nullopt;
    const Luminaire& luminaire = rig_.luminaires[rig_.fixtures[fixture.index].luminaire];
    return Note{fmt::format("is {} from {}{}", length_text(distance_m), thing.text(),
                            luminaire.shape.kind == LuminousShape::Kind::point && distance_m > 0
                                ? fmt::format(", which could get {:.0f} lx from it",
                                              luminaire.intensity->max_intensity_cd() / (distance_m * distance_m))
                                : ""),
                "move one of them"};
  }

  // Points and luxmeters.

  std::optional<Note> of_receiver(std::size_t r, const ClosedObjects& objects) const {
    const Receiver& receiver = receivers_[r];
    const Light& light = light_[r];
    const std::string dark = light.none ? ", and gets " + light_text(r) : "";
    if (const auto object = objects.around(receiver.position_world_m)) {
      const auto surface = rays_.nearest_surface(receiver.position_world_m, diagonal_m_);
      return Note{fmt::format("is inside of object \"{}\", {} below its surface{}", scene_.object_names[*object],
                              length_text(surface ? surface->distance_m : 0), dark),
                  "correct its position_m, or the object's place"};
    }
    if (const auto before = surface_before(receiver))
      return Note{fmt::format("faces {} {} before it: it is behind or inside of that, or looks at it{}",
                              surface_text(before->triangle), length_text(before->distance_m), dark),
                  fmt::format("move it along its normal by more than {} (from {} past {}), or turn its normal",
                              length_text(before->distance_m), position_text(receiver.position_world_m),
                              position_text(before->position_world_m))};
    const double out_m = bounds_.exteriorDistance(receiver.position_world_m);
    const bool far = out_m > std::max(5.0, diagonal_m_);
    if (far || (light.none && out_m > 0.001 * diagonal_m_))
      return Note{fmt::format("is at {}, {} outside of the scene ({}){}", position_text(receiver.position_world_m),
                              length_text(out_m), extent_text(bounds_), dark),
                  "correct its position_m, or the scene's unit and up_axis"};
    if (!light.none) return std::nullopt;
    const auto hit = rays_.nearest(receiver.position_world_m, receiver.normal_world, receiver.normal_world);
    return Note{fmt::format("gets {}: {}", light_text(r),
                            hit ? fmt::format("it looks at {}, {} away, and no lamp is in sight",
                                              surface_text(hit->triangle), length_text(hit->distance_m))
                                : "no lamp lights it"),
                "correct its position_m or normal, or aim a lamp at it"};
  }

  std::string light_text(std::size_t r) const {
    const Light& light = light_[r];
    const auto goal = r < rig_.points.size() ? rig_.points[r].goal_lx : std::nullopt;
    return fmt::format("{:.2g} lx with every lamp at full level{}", light.lux,
                       goal ? fmt::format(", its goal is {:g} lx", *goal) : "");
  }

  std::string surface_text(std::uint32_t triangle) const {
    const std::uint32_t object = scene_.object_of_triangle[triangle];
    const std::string& material = rays_.material_of(triangle).name;
    std::string text =
        object == 0 ? "a surface of the scene" : fmt::format("object \"{}\"", scene_.object_names[object]);
    if (object == 0 && !material.empty()) text += fmt::format(" (material \"{}\")", material);
    return text;
  }

  /// The surface right before a receiver, if it takes up nearly all that the receiver sees.
  std::optional<Hit> surface_before(const Receiver& receiver) const {
    const Vec3& at = receiver.position_world_m;
    const Vec3& normal = receiver.normal_world;
    const auto before = rays_.nearest(at, normal, normal);
    if (!before || before->distance_m > kBefore_m) return std::nullopt;
    const Vec3 across = normal.unitOrthogonal(), along = normal.cross(across);
    int near = 0;
    for (int i = 0; i < kLooks; ++i) {  // cosine-weighted, in a spiral
      const double sine = std::sqrt((i + 0.5) / kLooks), turn = 2.399963229728653 * i;
      const Vec3 look = sine * (std::cos(turn) * across + std::sin(turn) * along) + std::sqrt(1 - sine * sine) * normal;
      const auto hit = rays_.nearest(at, look.normalized(), normal);
      near += hit && hit->distance_m < kBeforeReach_m ? 1 : 0;
    }
    return near >= kBeforeShare * kLooks ? before : std::nullopt;
  }

  // Light.

  void find_light() {
    light_.resize(receivers_.size());
    const std::vector<Emitter> emitters = all_emitters_of(rig_);
    const bool more_to_come =
        std::any_of(rig_.tasks.begin(), rig_.tasks.end(), [](const Task& task) { return task.places_lights(); });
    if (emitters.empty() || receivers_.empty() || more_to_come) return;
    EvaluateOptions options;
    options.wanted_relative_error = kErrorOfNotes;
    options.threads = threads_;
    options.max_rays = kMaxRays;
    options.watch.stop = stop_;
    set_error_floor(rig_, options);
    const auto direct = make_direct_evaluator(rays_)->evaluate(receivers_, emitters, options);
    if (!direct) return;  // evaluate reports the fault later
    const Eigen::VectorXd direct_lx = direct->lux(Eigen::VectorXd::Ones(direct->emitters()));
    double min_lx = std::max(options.floor_lx, options.floor_of_mean * direct_lx.mean());
    if (!(min_lx > 0)) min_lx = 1;
    std::vector<double> no_light_lx;
    std::vector<Receiver> dark;
    std::vector<std::size_t> dark_index;
    for (std::size_t r = 0; r < receivers_.size(); ++r) {
      double enough_lx = kNoLight * min_lx / 0.1;
      if (r < rig_.points.size() && rig_.points[r].goal_lx && *rig_.points[r].goal_lx > 0)
        enough_lx = kNoLightOfGoal * *rig_.points[r].goal_lx;
      if (direct_lx[static_cast<Eigen::Index>(r)] >= enough_lx || in_sight_of_a_head(receivers_[r])) continue;
      dark.push_back(receivers_[r]);
      dark_index.push_back(r);
      no_light_lx.push_back(enough_lx);
    }
    if (dark.empty()) return;
    options.floor_lx = *std::min_element(no_light_lx.begin(), no_light_lx.end());
    options.floor_of_mean = 0;
    const auto all = make_path_evaluator(rays_)->evaluate(dark, emitters, options);
    if (!all) return;
    const Eigen::VectorXd levels = Eigen::VectorXd::Ones(all->emitters());
    const Eigen::VectorXd lux = all->lux(levels), error_lx = all->standard_error_lux(levels);
    for (std::size_t i = 0; i < dark.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      Light& light = light_[dark_index[i]];
      light = {lux[row] + 2 * error_lx[row] < no_light_lx[i], lux[row],
               direct_lx[static_cast<Eigen::Index>(dark_index[i])], error_lx[row]};
    }
  }

  /// A head may turn and light the place, even if it does not now.
  bool in_sight_of_a_head(const Receiver& receiver) const {
    return std::any_of(fixtures_.begin(), fixtures_.end(), [&](const PlacedFixture& fixture) {
      return rig_.fixtures[fixture.index].moves && faces_and_sees(receiver, fixture.position_world_m);
    });
  }

  const Rig& rig_;
  const Scene& scene_;
  const RayScene& rays_;
  int threads_;
  std::stop_token stop_;
  Eigen::AlignedBox3d bounds_;  ///< of the room
  double diagonal_m_;
  std::vector<PlacedFixture> fixtures_;
  std::vector<PlacedThing> things_;  ///< as receivers_
  std::vector<Receiver> receivers_;
  std::vector<Light> light_;  ///< per receiver, with every lamp at full level; computed only where it may be none
  std::vector<Problem> notes_;
  std::size_t kept_ = 0;
  FilePosition last_;
  std::string more_;
};

}  // namespace

std::vector<Problem> notes_on(const Rig& rig, const Scene& scene, const RayScene& rays, int threads,
                              std::stop_token stop) {
  if (scene.triangles.empty()) return {};
  if (auto doubt = doubt_of_reading(rig, scene)) return {std::move(*doubt)};
  return Notes(rig, scene, rays, threads, std::move(stop)).all();
}

Eigen::AlignedBox3d room_of(const Rig& rig, const Scene& scene) {
  return room_bounds_of(scene, placed_positions(rig)).with_things_world_m;
}

std::vector<Problem> lamps_in_points(const Rig& rig) {
  std::vector<Problem> problems;
  const std::vector<PlacedThing> things = placed_receivers(rig);
  for (const PlacedFixture& fixture : placed_fixtures(rig)) {
    if (rig.luminaires[rig.fixtures[fixture.index].luminaire].shape.kind != LuminousShape::Kind::point) continue;
    for (const PlacedThing& thing : things) {
      const double distance_m = (fixture.position_world_m - thing.position_world_m).norm();
      if (distance_m > smallest_distance_m(fixture.position_world_m, thing.position_world_m)) continue;
      problems.push_back({rig.file.string(), fixture.in_file.line, fixture.in_file.column,
                          fmt::format("{} lies in {} (both at {}), which would get infinitely many lux from it",
                                      fixture.text(), thing.text(), position_text(thing.position_world_m)),
                          "move one of them"});
    }
  }
  return problems;
}

}  // namespace luxrig
