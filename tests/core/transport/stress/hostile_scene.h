#pragma once
/// Random scenes with every defect of real meshes: slivers, needles, duplicate and intersecting triangles, stacks of
/// coplanar ones, every face twice, 20 km faces through millimetre scenes, lamps on surfaces, receivers on edges and
/// vertices. Sizes run from micrometres to a thousand kilometres, also far from the origin.

#include <random>
#include <utility>

#include "core/photometry/sky/sky.h"
#include "core/transport/evaluator.h"

namespace luxrig {

struct HostileScene {
  Scene scene;
  std::vector<Receiver> receivers;
  std::vector<Emitter> emitters;
  /// A lamp is too near a receiver for the size of their coordinates: an evaluator may refuse it.
  bool may_be_refused = false;
  /// A lamp has size, or there is a sky. Direct light is then sampled if something is in the way.
  bool sized = false;
};

class HostileScenes {
 public:
  explicit HostileScenes(std::uint64_t seed) : bits_(seed) {}

  HostileScene next() {
    HostileScene made;
    size_m_ = std::pow(10, between(-3, 6));
    made.scene.origin_world_m = below(3) == 0 ? Vec3(any() * std::pow(10, between(0, 7))) : Vec3::Zero();
    const bool glossy = below(8) == 0;
    for (int m = 0; m < 3; ++m) {
      Material material;
      material.name = "material";
      material.reflectance_rgb = Vec3(between(0, 0.95), between(0, 0.95), between(0, 0.95));
      if (below(4) == 0) material.reflectance_rgb = Vec3::Constant(below(2) ? 0.95 : 0.0);
      if (glossy || below(4) == 0)
        material.specular_reflectance = between(0, 0.95), material.roughness = between(0.0, 1);
      made.scene.materials.push_back(material);
    }
    made.scene.object_names = {"scene"};
    if (below(3) == 0) box(made.scene, Vec3::Constant(-1.2), Vec3::Constant(1.2));
    const int parts = 1 + below(6);
    for (int p = 0; p < parts; ++p) part(made.scene);
    made.scene.object_of_triangle.assign(made.scene.triangles.size(), 0);
    for (std::size_t t = 0; t < made.scene.triangles.size(); ++t)
      made.scene.material_of_triangle.push_back(static_cast<std::uint32_t>(below(3)));
    // Sometimes enough receivers to share paths; more often if all are glossy.
    const int receivers = below(glossy ? 3 : 12) == 0 ? 24 + below(12) : 1 + below(4), emitters = 1 + below(3);
    for (int i = 0; i < receivers; ++i) made.receivers.push_back({place(made.scene), normal(made.scene)});
    for (int i = 0; i < emitters; ++i) made.emitters.push_back(lamp(made.scene));
    if (below(4) == 0) give_size(made);
    for (const Receiver& r : made.receivers)
      for (const Emitter& e : made.emitters) {
        const double distance_m = (r.position_world_m - e.world_from_lamp.translation_m).norm();
        const double largest_m = std::max(r.position_world_m.cwiseAbs().maxCoeff(), distance_m);
        made.may_be_refused |= distance_m <= 1e-8 * largest_m + e.shape.size_m.norm();
      }
    if (below(4) == 0) huge_faces(made.scene);
    if (below(4) == 0) double_faces(made.scene);
    return made;
  }

  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits_() >> 11) * 0x1p-53);
  }
  int below(int count) { return static_cast<int>(bits_() % static_cast<std::uint64_t>(count)); }

 private:
  Vec3 any() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
  Vec3 unit() {
    for (;;) {
      const Vec3 v = any();
      if (v.norm() > 0.05 && v.norm() < 1) return v.normalized();
    }
  }

  void triangle(Scene& scene, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
    for (const Vec3& v : {a, b, c}) scene.vertices_m.push_back((size_m_ * v).cast<float>());
    scene.triangles.push_back({first, first + 1, first + 2});
  }

  /// Not cut, and therefore coarse in float: build_scene() cuts them.
  void huge_faces(Scene& scene) {
    const double size_m = std::exchange(size_m_, 1e4);
    const std::size_t before = scene.triangles.size();
    const Vec3 lift = size_m / size_m_ * any(), u = unit(), v = u.cross(unit()).normalized();
    triangle(scene, lift - u - v, lift + u - v, lift + v);
    triangle(scene, lift - u - v, lift + v, lift - u + v);
    size_m_ = size_m;
    scene.object_of_triangle.resize(scene.triangles.size(), 0);
    while (scene.material_of_triangle.size() < scene.triangles.size())
      scene.material_of_triangle.push_back(scene.material_of_triangle[before / 2]);
  }

  static void double_faces(Scene& scene) {
    const auto twice = [](auto& list) {
      const auto once = list;
      list.insert(list.end(), once.begin(), once.end());
    };
    twice(scene.triangles);
    twice(scene.material_of_triangle);
    twice(scene.object_of_triangle);
  }

  void box(Scene& scene, const Vec3& low, const Vec3& high) {
    constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    const auto corner = [&](int i) {
      return Vec3(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
    };
    for (const auto& f : kFaces) {
      triangle(scene, corner(f[0]), corner(f[1]), corner(f[2]));
      triangle(scene, corner(f[0]), corner(f[2]), corner(f[3]));
    }
  }

  void part(Scene& scene) {
    const Vec3 a = any(), u = unit(), v = u.cross(unit()).normalized();
    switch (below(7)) {
      case 0:  // ordinary
        return triangle(scene, a, a + u, a + v);
      case 1:  // sliver: three corners almost on a line
        return triangle(scene, a, a + u, a + 0.5 * u + std::pow(10, between(-7, -2)) * v);
      case 2:  // needle
        return triangle(scene, a, a + 2 * u, a + std::pow(10, between(-7, -2)) * v);
      case 3:  // the same twice, once reversed
        triangle(scene, a, a + u, a + v);
        triangle(scene, a, a + u, a + v);
        return triangle(scene, a, a + v, a + u);
      case 4:  // stack: planes a tiny gap apart, or none
        for (int i = 0; i < 4; ++i) {
          const Vec3 lift = u.cross(v) * (i * (below(2) ? std::pow(10, between(-8, -3)) : 0.0));
          triangle(scene, a + lift, a + u + lift, a + v + lift);
        }
        return;
      case 5:  // two that cut each other
        triangle(scene, a, a + u, a + v);
        return triangle(scene, a + 0.3 * (u + v) - 0.5 * u.cross(v), a + 0.3 * (u + v) + 0.5 * u.cross(v), a + 0.7 * u);
      default:  // a plate parallel to the axes, like a floor
        return box(scene, Vec3(a.x(), a.y(), -1.2), Vec3(a.x() + 0.5, a.y() + 0.4, -1.2 + (below(2) ? 0.1 : 1e-6)));
    }
  }

  const std::array<std::uint32_t, 3>& any_triangle(const Scene& scene) {
    return scene.triangles[static_cast<std::size_t>(below(static_cast<int>(scene.triangles.size())))];
  }

  /// On a vertex, an edge, a face, or anywhere.
  Vec3 place(const Scene& scene) {
    const auto& t = any_triangle(scene);
    const Vec3 a = scene.vertex_world_m(t[0]), b = scene.vertex_world_m(t[1]), c = scene.vertex_world_m(t[2]);
    switch (below(4)) {
      case 0:
        return a;
      case 1:
        return a + between(0, 1) * (b - a);
      case 2: {
        double u = between(0, 1), v = between(0, 1);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        return a + u * (b - a) + v * (c - a);
      }
      default:
        return scene.origin_world_m + 1.1 * size_m_ * any();
    }
  }

  /// A face's own normal on either side, an axis, or random.
  Vec3 normal(const Scene& scene) {
    const auto& t = any_triangle(scene);
    const Vec3 a = scene.vertex_world_m(t[0]),
               across = (scene.vertex_world_m(t[1]) - a).cross(scene.vertex_world_m(t[2]) - a);
    const int kind = below(3);
    if (kind == 0 && across.norm() > 0) return (below(2) ? 1.0 : -1.0) * across.normalized();
    if (kind == 1) return Vec3::Unit(below(3)) * (below(2) ? 1.0 : -1.0);
    return unit();
  }

  Emitter lamp(const Scene& scene) {
    Emitter made;
    const double flux_lm = std::pow(10, between(-3, 6));
    switch (below(4)) {
      case 0:
        made.intensity = make_isotropic(flux_lm);
        break;
      case 1:
        made.intensity = make_lambertian(flux_lm);
        break;
      case 2:
        made.intensity = make_cosine_power(flux_lm, between(0.5, 200));
        break;
      default: {
        const double beam_rad = between(0.02, 1.2);
        made.intensity = make_spot(flux_lm, beam_rad, beam_rad * between(1.05, 2.4));
      }
    }
    const Vec3 z = unit(), x = z.cross(z.x() < 0.7 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
    made.world_from_lamp.rotation << x, z.cross(x), z;
    made.world_from_lamp.translation_m = place(scene);
    const Vec3 weight(between(0, 1), between(0, 1), between(0, 1));
    made.colour_rgb = weight / (0.2126 * weight.x() + 0.7152 * weight.y() + 0.0722 * weight.z());
    return made;
  }

  /// A luminous surface, possibly of zero width, or a sky.
  void give_size(HostileScene& made) {
    made.sized = true;
    Emitter& lamp = made.emitters.front();
    const auto edge_m = [&] { return size_m_ * std::pow(10, between(-6, 0.5)); };
    using Kind = LuminousShape::Kind;
    constexpr Kind kKinds[] = {Kind::rectangle, Kind::disk, Kind::sphere, Kind::cylinder};
    if (below(4)) {
      lamp.shape = {kKinds[below(4)], {edge_m(), edge_m(), edge_m()}};
    } else if (below(2)) {
      lamp.sky =
          make_general_sky(1 + below(15), Vec3(0.3, between(-1, 1), 0.5).normalized(), std::pow(10, between(0, 5)));
    } else {
      lamp.sky = make_sun(Vec3(0.3, between(-1, 1), between(0.05, 1)).normalized(), 1e5);
    }
  }

  std::mt19937_64 bits_;
  double size_m_ = 1;
};

}  // namespace luxrig
