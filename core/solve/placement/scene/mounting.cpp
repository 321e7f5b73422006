#include "core/solve/placement/scene/mounting.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/solve/placement/scene/surface_lattice.h"
#include "core/text/nearest.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr double kPlacesInAir = 20'000, kPlacesOffSurfaces = 5'000;
constexpr std::size_t kPlacesPerTask = 512;

/// Places moved to a bound are there only to within rounding.
double rounding_at(const Vec3& place_m) { return 1e-12 * (1 + place_m.cwiseAbs().maxCoeff()); }

bool fits(const std::string& pattern, const std::string& name) {
  return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

/// A pattern may match names of materials and of objects.
std::vector<std::string_view> names_of(const Scene& scene) {
  std::vector<std::string_view> names;
  for (const Material& material : scene.materials) names.push_back(material.name);
  for (const std::string& object : scene.object_names) names.push_back(object);
  return names;
}

std::size_t slices(double length_m, double spacing_m) {
  return static_cast<std::size_t>(std::max(1.0, std::round(length_m / spacing_m)));
}

}  // namespace

Checked<Mounting> Mounting::make(const MountingSpec& spec, const std::filesystem::path& rig_file, const Scene& scene,
                                 const RayScene& rays) {
  Mounting mounting;
  mounting.spec_ = spec;
  mounting.rays_ = &rays;
  mounting.box_world_m_ = spec.box_world_m.value_or(rays.bounds_world_m());
  std::vector<Problem> problems;
  if (mounting.box_world_m_.isEmpty()) {
    problems.push_back({rig_file.string(), std::max(1, spec.in_file.line), std::max(1, spec.in_file.column),
                        "there is no scene, so nothing bounds where lights may hang",
                        "give [mounting] a box_m = [[x, y, z], [x, y, z]], or the rig a [scene]"});
  }
  for (const MountingSpec::Pattern& pattern : spec.surfaces) {
    const auto names = names_of(scene);
    if (std::any_of(names.begin(), names.end(), [&](std::string_view n) { return fits(pattern.text, std::string(n)); }))
      continue;
    problems.push_back({rig_file.string(), pattern.in_file.line, pattern.in_file.column,
                        fmt::format("surfaces {} fits no material or object of the scene", in_quotes(pattern.text)),
                        mend_for_unknown(pattern.text, names, "name one of the scene's")});
  }
  if (!problems.empty()) return tl::unexpected(std::move(problems));
  if (spec.surfaces.empty()) return mounting;

  const auto is_meant = [&](std::size_t t) {
    return std::any_of(spec.surfaces.begin(), spec.surfaces.end(), [&](const MountingSpec::Pattern& pattern) {
      return fits(pattern.text, scene.materials[scene.material_of_triangle[t]].name) ||
             fits(pattern.text, scene.object_names[scene.object_of_triangle[t]]);
    });
  };
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const bool meant = is_meant(t);
    mounting.is_surface_.push_back(meant ? 1 : 0);
    mounting.is_other_.push_back(meant ? 0 : 1);
    if (!meant) continue;
    const auto& corner = scene.triangles[t];
    mounting.surfaces_world_m_.push_back(
        {scene.vertex_world_m(corner[0]), scene.vertex_world_m(corner[1]), scene.vertex_world_m(corner[2])});
  }
  return mounting;
}

bool Mounting::clear_of_others(const Vec3& place_world_m) const {
  const double min_m = spec_.clearance_m - rounding_at(place_world_m);
  if (!(min_m > 0)) return true;
  const auto near = rays_->nearest_surface(place_world_m, min_m, is_other_);
  return !near || near->distance_m >= min_m;
}

bool Mounting::may_hang(const Vec3& place_world_m) const {
  if (!place_world_m.allFinite() || !box_world_m_.contains(place_world_m)) return false;
  if (!is_surface_.empty()) {
    const double rounding_m = rounding_at(place_world_m);
    const auto near = rays_->nearest_surface(place_world_m, spec_.offset_max_m + rounding_m, is_surface_);
    if (!near || near->distance_m < spec_.offset_min_m - rounding_m) return false;
  }
  return clear_of_others(place_world_m);
}

std::optional<Mounting::Snapped> Mounting::snapped(const Vec3& wanted_world_m) const {
  if (!wanted_world_m.allFinite()) return std::nullopt;
  Snapped at{wanted_world_m, Mat3::Identity()};
  // A move to the offsets may leave the box, and the other way round: a few turns converge where possible.
  for (int turn = 0; turn < 4; ++turn) {
    const Vec3 in_box_m = at.place_world_m.cwiseMax(box_world_m_.min()).cwiseMin(box_world_m_.max());
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      if (in_box_m[axis] != at.place_world_m[axis]) at.per_wanted.row(axis).setZero();
    at.place_world_m = in_box_m;
    if (may_hang(at.place_world_m)) return at;
    if (is_surface_.empty()) return std::nullopt;
    const auto near = rays_->nearest_surface(at.place_world_m, std::numeric_limits<double>::infinity(), is_surface_);
    if (!near || !(near->distance_m > 0)) return std::nullopt;
    const Vec3 out = (at.place_world_m - near->position_world_m) / near->distance_m;
    const double wanted_m = std::clamp(near->distance_m, spec_.offset_min_m, spec_.offset_max_m);
    if (wanted_m == near->distance_m) return std::nullopt;  // another surface is too near
    at.place_world_m = near->position_world_m + wanted_m * out;
    at.per_wanted = (Mat3::Identity() - out * out.transpose()) * at.per_wanted;
  }
  return std::nullopt;
}

double Mounting::places_at(double spacing_m) const {
  if (is_surface_.empty()) {
    double places = 1;
    for (const double side_m : box_world_m_.sizes()) places *= std::max(1.0, std::round(side_m / spacing_m));
    return places;
  }
  double area_m2 = 0;
  for (const Triangle& triangle : surfaces_world_m_) area_m2 += widest_shadow_m2(triangle);
  return 2 * area_m2 / (spacing_m * spacing_m) *
         std::max(1.0, std::round((spec_.offset_max_m - spec_.offset_min_m) / spacing_m));
}

double Mounting::default_spacing_m() const {
  const double wanted = is_surface_.empty() ? kPlacesInAir : kPlacesOffSurfaces;
  double low_m = 1e-9, high_m = std::max(1e-6, 2 * box_world_m_.diagonal().norm());
  for (int step = 0; step < 60; ++step) {
    const double middle_m = std::sqrt(low_m * high_m);
    (places_at(middle_m) > wanted ? low_m : high_m) = middle_m;
  }
  return high_m;
}

std::vector<Vec3> Mounting::places_in_air(double spacing_m) const {
  std::array<std::size_t, 3> count;
  Vec3 step_m;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    count[axis] = slices(box_world_m_.sizes()[a], spacing_m);
    step_m[a] = box_world_m_.sizes()[a] / static_cast<double>(count[axis]);
  }
  std::vector<Vec3> places_m;
  places_m.reserve(count[0] * count[1] * count[2]);
  for (std::size_t z = 0; z < count[2]; ++z)
    for (std::size_t y = 0; y < count[1]; ++y)
      for (std::size_t x = 0; x < count[0]; ++x)
        places_m.push_back(box_world_m_.min() +
                           step_m.cwiseProduct(Vec3(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5,
                                                    static_cast<double>(z) + 0.5)));
  return places_m;
}

std::vector<Vec3> Mounting::places_off_surfaces(double spacing_m) const {
  const double thickness_m = spec_.offset_max_m - spec_.offset_min_m;
  const std::size_t layers = slices(thickness_m, spacing_m);
  std::vector<Vec3> places_m;
  for (const Triangle& triangle : surfaces_world_m_) {
    const Vec3 normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
    for (const Vec3& on_m : lattice_on(triangle, spacing_m)) {
      for (std::size_t layer = 0; layer < layers; ++layer) {
        const double off_m =
            spec_.offset_min_m + thickness_m * (static_cast<double>(layer) + 0.5) / static_cast<double>(layers);
        places_m.push_back(on_m + off_m * normal);
        places_m.push_back(on_m - off_m * normal);
      }
    }
  }
  return places_m;
}

Result<std::vector<Vec3>> Mounting::candidates(int threads) const {
  double spacing_m = this->spacing_m();
  const double count = places_at(spacing_m);
  if (count > static_cast<double>(kMaxPlaces)) {
    return refusal(
        fmt::format("[mounting] spacing_m = {:g} makes {:.3g} places to try, more than {}: widen it, leave it "
                    "out, or make box_m smaller",
                    spacing_m, count, kMaxPlaces));
  }
  std::vector<Vec3> places_m, good_m;
  // The lattice may miss surfaces smaller than the spacing.
  for (int finer = 0; finer < 6 && good_m.empty() && places_at(spacing_m) <= static_cast<double>(kMaxPlaces);
       ++finer, spacing_m /= 2) {
    places_m = is_surface_.empty() ? places_in_air(spacing_m) : places_off_surfaces(spacing_m);
    std::vector<std::uint8_t> good(places_m.size(), 0);
    parallel_for((places_m.size() + kPlacesPerTask - 1) / kPlacesPerTask, threads, [&](std::size_t task) {
      const std::size_t end = std::min(places_m.size(), (task + 1) * kPlacesPerTask);
      for (std::size_t i = task * kPlacesPerTask; i < end; ++i) good[i] = may_hang(places_m[i]) ? 1 : 0;
    });
    for (std::size_t i = 0; i < places_m.size(); ++i)
      if (good[i]) good_m.push_back(places_m[i]);
  }
  if (!good_m.empty()) return good_m;
  return refusal(fmt::format(
      "no light may hang anywhere: all {} places tried are nearer than clearance_m = {:g} to something{}: lower "
      "[mounting] clearance_m, or allow more room",
      places_m.size(), spec_.clearance_m,
      is_surface_.empty() ? "" : ", outside of box_m or not within offset_m of the surfaces"));
}

}  // namespace luxrig
