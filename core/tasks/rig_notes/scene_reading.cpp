#include "core/tasks/rig_notes/scene_reading.h"

#include <algorithm>
#include <array>

#include "core/scene/mesh/up_axis.h"
#include "core/scene/room_bounds.h"

namespace luxrig {
namespace {

struct MeshUnit {
  const char* name;
  double metres;
};
constexpr std::array<MeshUnit, 5> kUnitsByLength = {
    {{"mm", 0.001}, {"cm", 0.01}, {"in", 0.0254}, {"ft", 0.3048}, {"m", 1}}};
constexpr std::array<UpAxis, 3> kUpAxes = {UpAxis::x, UpAxis::y, UpAxis::z};
constexpr std::array kAxisNames = {"x", "y", "z"};

/// A reading is right if it puts this share of the placed things within the scene.
constexpr double kNearlyAll = 0.9;
/// Another axis must bring at least this share more of them within.
constexpr double kPlainlyMore = 0.25;
/// Too small: most points are this many scene diagonals away from it. A foot taken for a metre gives less.
constexpr double kFarDiagonals = 8;
/// Not too small but elsewhere: placed things spread over at most this many scene diagonals.
constexpr double kSameSize = 2;
/// Outside by more than this share of the scene's diagonal, so that things on a floor do not count.
constexpr double kOutside = 0.1;
/// Too large: higher than a building, and this many times as high as the highest thing in it.
constexpr double kTowering_m = 100, kToweringTimes = 30;

Eigen::AlignedBox3d bounds_of_mesh(const Scene& scene) {
  Eigen::AlignedBox3d bounds;
  for (std::size_t t = 0; t < scene.triangles.size(); ++t)
    if (scene.object_of_triangle[t] == 0)
      for (const std::uint32_t vertex : scene.triangles[t]) bounds.extend(scene.vertex_world_m(vertex));
  return bounds;
}

class Reading {
 public:
  Reading(const Rig& rig, const Eigen::AlignedBox3d& bounds, const Eigen::AlignedBox3d& room)
      : spec_(rig.scene), bounds_(bounds), room_(room) {
    for (const PlacedFixture& fixture : placed_fixtures(rig)) all_.push_back(fixture.position_world_m);
    fixtures_ = all_.size();
    for (const PlacedThing& receiver : placed_receivers(rig)) all_.push_back(receiver.position_world_m);
  }

  std::optional<Problem> doubt(const std::string& file) const {
    auto what = elsewhere();
    if (!what) what = wrong_unit();
    if (!what) what = wrong_axis();
    if (!what) what = all_outside();
    if (!what) return std::nullopt;
    return Problem{file, spec_.in_file.line, spec_.in_file.column, what->first, what->second};
  }

 private:
  using Note = std::pair<std::string, std::string>;  // the fault, the remedy

  [[nodiscard]] const MeshFile& mesh() const { return *spec_.mesh; }
  static std::string name_of_axis(UpAxis axis) { return kAxisNames[static_cast<std::size_t>(axis)]; }

  /// The mesh's bounds if the file were read this way.
  Eigen::AlignedBox3d read_as(UpAxis up, double metres_per_unit) const { return read_as(bounds_, up, metres_per_unit); }
  Eigen::AlignedBox3d read_as(const Eigen::AlignedBox3d& as_now, UpAxis up, double metres_per_unit) const {
    const Mat3 turn = rotation_to_z_up(up) * rotation_to_z_up(mesh().up_axis).transpose();
    const double scale = metres_per_unit / mesh().metres_per_unit;
    Eigen::AlignedBox3d box(Vec3(scale * (turn * as_now.min())));
    box.extend(Vec3(scale * (turn * as_now.max())));
    return box;
  }

  /// Number of things from `begin` on that are within the bounds, or out by at most a share of their diagonal.
  std::size_t within(Eigen::AlignedBox3d box, double share, std::size_t begin = 0) const {
    const double margin_m = share * box.diagonal().norm();
    return static_cast<std::size_t>(
        std::count_if(all_.begin() + static_cast<std::ptrdiff_t>(begin), all_.end(),
                      [&](const Vec3& at) { return box.exteriorDistance(at) <= margin_m; }));
  }
  [[nodiscard]] bool nearly_all(std::size_t count, std::size_t of) const {
    return static_cast<double>(count) >= kNearlyAll * static_cast<double>(of);
  }

  /// Uses the room alone: with the wrong axis, a 20 km ground would stand on edge and contain everything.
  std::optional<Note> wrong_axis() const {
    const std::size_t now = within(room_, 0.02);
    if (all_.size() < 2 || nearly_all(now, all_.size())) return std::nullopt;
    for (const UpAxis up : kUpAxes) {
      const std::size_t then = within(read_as(room_, up, mesh().metres_per_unit), 0.02);
      const double more = static_cast<double>(then) - static_cast<double>(now);
      if (!nearly_all(then, all_.size()) || more < std::max(2.0, kPlainlyMore * static_cast<double>(all_.size())))
        continue;
      return Note{
          fmt::format("the scene's file is read with {} up, which makes it {} ({}): {} of {} fixtures, points and "
                      "luxmeters are within that; with {} up, {} of them would be",
                      name_of_axis(mesh().up_axis), size_text(room_.sizes()), extent_text(room_), now, all_.size(),
                      name_of_axis(up), then),
          fmt::format("set up_axis = \"{}\" in [scene]", name_of_axis(up))};
    }
    return std::nullopt;
  }

  /// As large as what is in it, but far from it: one of the two is in map coordinates.
  std::optional<Note> elsewhere() const {
    Eigen::AlignedBox3d things;
    for (const Vec3& at : all_) things.extend(at);
    const double diagonal_m = bounds_.diagonal().norm(), apart_m = bounds_.exteriorDistance(things);
    if (apart_m <= kFarDiagonals * diagonal_m || things.diagonal().norm() > kSameSize * diagonal_m) return std::nullopt;
    const Vec3 way_m = things.center() - bounds_.center();
    return Note{
        fmt::format("the scene ({}) is {} away from all fixtures, points and luxmeters ({})", extent_text(bounds_),
                    length_text(apart_m), extent_text(things)),
        fmt::format("give both in the same coordinates: the mesh moved by about {}, or the positions back by it",
                    position_text(way_m))};
  }

  /// Points belong in a scene or on it, wherever its lamps are. If none is, another unit may bring all in.
  std::optional<Note> all_outside() const {
    const std::size_t judged = all_.size() - fixtures_;
    if (judged == 0 || within(bounds_, kOutside, fixtures_) > 0) return std::nullopt;
    for (const UpAxis up : axes_to_try())
      for (const MeshUnit& unit : kUnitsByLength) {
        const Eigen::AlignedBox3d then = read_as(up, unit.metres);
        if (!nearly_all(within(then, 0.02), all_.size())) continue;
        return Note{fmt::format("the scene is read as {} in size, with all {} points and luxmeters outside of it",
                                size_text(bounds_.sizes()), judged),
                    mend_of(unit, up, then)};
      }
    return std::nullopt;
  }

  [[nodiscard]] std::vector<UpAxis> axes_to_try() const {
    std::vector<UpAxis> axes = {mesh().up_axis};
    for (const UpAxis up : kUpAxes)
      if (up != mesh().up_axis) axes.push_back(up);
    return axes;
  }

  [[nodiscard]] std::string mend_of(const MeshUnit& unit, UpAxis up, const Eigen::AlignedBox3d& then) const {
    return fmt::format("set unit = \"{}\"{} in [scene], which makes it {}", unit.name,
                       up == mesh().up_axis ? "" : " and up_axis = \"" + name_of_axis(up) + "\"",
                       size_text(then.sizes()));
  }

  std::optional<Note> wrong_unit() const {
    const std::size_t begin = fixtures_ < all_.size() ? fixtures_ : 0;  // without points, by the fixtures
    const std::size_t judged = all_.size() - begin;
    if (judged == 0) return std::nullopt;
    // A single object is smaller than the distance to the lamps around it.
    const double far = begin > 0 ? kFarDiagonals : 3 * kFarDiagonals;
    const bool too_small = 2 * within(bounds_, far, begin) < judged;
    double highest_m = all_.front().z();
    for (const Vec3& at : all_) highest_m = std::max(highest_m, at.z());
    const double height_m = bounds_.sizes().z(), used_m = std::max(1.0, highest_m - bounds_.min().z());
    const bool too_large = height_m > kTowering_m && height_m > kToweringTimes * used_m;
    if (!too_small && !too_large) return std::nullopt;
    Eigen::AlignedBox3d things;
    for (const Vec3& at : all_) things.extend(at);
    std::string what = fmt::format(
        "the scene is {} in size, far too {} for what is in it: fixtures, points and "
        "luxmeters are spread over {}",
        size_text(bounds_.sizes()), too_small ? "small" : "large", size_text(things.sizes()));
    // Well within, if a reading gives that; else nearby, like lamps above a bare floor.
    for (const double margin : {0.02, 0.25})
      for (const UpAxis up : axes_to_try())
        for (const MeshUnit& unit : kUnitsByLength) {
          if (too_small != (unit.metres > mesh().metres_per_unit)) continue;
          const Eigen::AlignedBox3d then = read_as(up, unit.metres);
          if (!nearly_all(within(then, margin), all_.size())) continue;
          return Note{what, mend_of(unit, up, then)};
        }
    return Note{what, "correct unit in [scene], or export the mesh in metres"};
  }

  const SceneSpec& spec_;
  const Eigen::AlignedBox3d bounds_, room_;  ///< of the whole mesh, and without a ground beyond the room
  std::vector<Vec3> all_;                    ///< fixtures, then points and luxmeters
  std::size_t fixtures_ = 0;
};

}  // namespace

std::optional<Problem> doubt_of_reading(const Rig& rig, const Scene& scene) {
  if (!rig.scene.mesh) return std::nullopt;
  const Eigen::AlignedBox3d bounds = bounds_of_mesh(scene);
  if (bounds.isEmpty() || !(bounds.diagonal().norm() > 0)) return std::nullopt;
  if (rig.fixtures.empty() && rig.points.empty() && rig.luxmeters.empty()) return std::nullopt;
  return Reading(rig, bounds, room_bounds_of(scene, placed_positions(rig), 0).built_world_m).doubt(rig.file.string());
}

}  // namespace luxrig
