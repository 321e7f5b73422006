// Objects that photographers and museums light: a head, a helmet, an inscription.
#include <algorithm>
#include <cmath>

#include "tools/bench/rooms/level_set.h"
#include "tools/bench/rooms/relief_targets.h"

namespace luxrig {
namespace {

/// Negative inside; its slope is at most 1.
double ellipsoid_m(const Vec3& p_m, const Vec3& middle_m, const Vec3& radii_m) {
  return ((p_m - middle_m).cwiseQuotient(radii_m).norm() - 1) * radii_m.minCoeff();
}

struct HeadPart {
  Vec3 a, b;
  double radius, blend;
};

/// Of a face towards -Y, in metres; eyes at z = 8 mm. |x| is used, so both halves are alike.
double head_m(const Vec3& p) {
  static const std::array<HeadPart, 12> parts = {{
      {{0, 0.02, -0.10}, {0, 0.03, -0.19}, 0.050, 0.015},                // neck
      {{0, -0.083, 0.028}, {0.035, -0.080, 0.030}, 0.012, 0.015},        // brow
      {{0.048, -0.064, -0.014}, {0.052, -0.050, -0.012}, 0.022, 0.020},  // cheekbone
      {{0, -0.088, 0.018}, {0, -0.105, -0.024}, 0.008, 0.008},           // nose
      {{0, -0.106, -0.027}, {0, -0.105, -0.026}, 0.0120, 0.004},         // its tip
      {{0.011, -0.096, -0.030}, {0.009, -0.098, -0.030}, 0.008, 0.004},  // its wings
      {{0, -0.092, -0.057}, {0.018, -0.084, -0.060}, 0.0065, 0.004},     // upper lip
      {{0, -0.091, -0.068}, {0.015, -0.085, -0.067}, 0.0070, 0.004},     // lower lip
      {{0, -0.080, -0.098}, {0.006, -0.080, -0.098}, 0.017, 0.020},      // chin
      {{0.031, -0.072, 0.008}, {0.031, -0.072, 0.008}, 0.0125, 0.002},   // eye
      {{0.078, 0.012, 0.022}, {0.078, 0.008, -0.022}, 0.011, 0.006},     // ear
      {{0.02, -0.062, -0.063}, {0.040, -0.04, -0.06}, 0.024, 0.025},     // cheek
  }};
  const Vec3 half(std::abs(p.x()), p.y(), p.z());
  double head = blended_least_m(ellipsoid_m(p, {0, 0.010, 0.030}, {0.076, 0.098, 0.100}),
                                ellipsoid_m(p, {0, -0.022, -0.055}, {0.058, 0.064, 0.072}), 0.03);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const HeadPart& part = parts[k];
    // Sockets before the eyes are put in.
    if (k == 9) head = std::max(head, -(ellipsoid_m(half, {0.031, -0.098, 0.008}, {0.021, 0.022, 0.014})));
    head = blended_least_m(head, distance_to_segment_m(half, part.a, part.b) - part.radius, part.blend);
  }
  return std::max(head, -0.175 - p.z());
}

/// A closed helmet of plate with slits for the eyes and for breath, and a crest.
double helmet_m(const Vec3& p) {
  constexpr double kPlate_m = 0.012;
  const double outside = ellipsoid_m(p, Vec3::Zero(), {0.105, 0.135, 0.150});
  const double inside = ellipsoid_m(p, Vec3::Zero(), Vec3(0.105, 0.135, 0.150) - Vec3::Constant(kPlate_m));
  double plate = std::max({outside, -inside, -0.115 - p.z()});
  const Vec3 half(std::abs(p.x()), p.y(), p.z());
  const double eye = distance_to_segment_m(half, {0.022, -0.13, 0.012}, {0.062, -0.10, 0.020}) - 0.013;
  const double breath = distance_to_segment_m(half, {0, -0.14, -0.03}, {0, -0.11, -0.13}) - 0.009;
  plate = std::max(plate, -std::min(eye, p.y() < 0 ? breath : 1.0));
  // The nasal and a ridge over the brow stand out.
  plate = blended_least_m(plate, distance_to_segment_m(p, {0, -0.134, 0.030}, {0, -0.138, -0.020}) - 0.007, 0.004);
  plate =
      blended_least_m(plate, distance_to_segment_m(half, {0, -0.126, 0.055}, {0.080, -0.082, 0.050}) - 0.007, 0.006);
  const double around = std::hypot(p.y(), p.z() * 0.93);
  const double crest = std::max({std::abs(p.x()) - 0.010, around - 0.185, 0.120 - around, -0.02 - p.z()});
  return blended_least_m(plate, crest, 0.004);
}

/// Strokes of capitals with V-shaped grooves, as stonecutters make them.
double inscription_m(const Vec3& p) {
  constexpr double kWidth_m = 0.36, kHeight_m = 0.16, kThick_m = 0.03, kDepth_m = 0.005;
  using Stroke = std::array<double, 4>;
  static const std::array<Stroke, 12> strokes = {{{0.00, 0.00, 0.00, 0.09},  // L
                                                  {0.00, 0.00, 0.05, 0.00},
                                                  {0.07, 0.09, 0.10, 0.00},  // V
                                                  {0.10, 0.00, 0.13, 0.09},
                                                  {0.15, 0.00, 0.21, 0.09},  // X
                                                  {0.15, 0.09, 0.21, 0.00},
                                                  {0.24, 0.00, 0.24, 0.09},  // E
                                                  {0.24, 0.00, 0.28, 0.00},
                                                  {0.24, 0.045, 0.27, 0.045},
                                                  {0.24, 0.09, 0.28, 0.09},
                                                  {0.00, -0.02, 0.28, -0.02},  // a rule below
                                                  {0.00, 0.11, 0.28, 0.11}}};
  double to_stroke_m = 1;
  const Vec3 on_face(p.x(), 0, p.z());
  for (const auto& [ax, az, bx, bz] : strokes)
    to_stroke_m =
        std::min(to_stroke_m, distance_to_segment_m(on_face, {ax - 0.14, 0, az - 0.045}, {bx - 0.14, 0, bz - 0.045}));
  const double groove_m = std::max(0.0, kDepth_m - to_stroke_m);
  const double front_m = -p.y() - kThick_m / 2 + groove_m;
  const double sides_m =
      std::max({std::abs(p.x()) - kWidth_m / 2, std::abs(p.z()) - kHeight_m / 2, p.y() - kThick_m / 2});
  return std::max(front_m / std::sqrt(2.0), sides_m);
}

Scene stone_of(const char* name, const Eigen::AlignedBox3d& box_m, double cell_m,
               const std::function<double(const Vec3&)>& distance_m) {
  ClosedMesh mesh = mesh_level_set(box_m, cell_m, distance_m);
  Scene scene;
  for (const Vec3& v : mesh.vertices_m) scene.vertices_m.push_back(v.cast<float>());
  scene.triangles = std::move(mesh.triangles);
  scene.materials = {Material{}};
  scene.materials.front().name = "stone";
  scene.object_names = {name};
  scene.material_of_triangle.assign(scene.triangles.size(), 0);
  scene.object_of_triangle.assign(scene.triangles.size(), 0);
  return scene;
}

}  // namespace

Scene make_head(double cell_m) {
  return stone_of("head", {Vec3(-0.11, -0.15, -0.19), Vec3(0.11, 0.13, 0.15)}, cell_m, head_m);
}

Scene make_helmet(double cell_m) {
  return stone_of("helmet", {Vec3(-0.13, -0.2, -0.14), Vec3(0.13, 0.2, 0.21)}, cell_m, helmet_m);
}

Scene make_inscription(double cell_m) {
  return stone_of("inscription", {Vec3(-0.19, -0.03, -0.09), Vec3(0.19, 0.03, 0.09)}, cell_m, inscription_m);
}

}  // namespace luxrig
