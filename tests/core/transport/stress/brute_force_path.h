#pragma once
/// A plain path tracer as a reference for evaluators: double precision, every triangle tested, no acceleration
/// structure, no sampling scheme. It shares only the Scene and the distributions' intensities with the code under test.

#include <optional>
#include <random>

#include "core/transport/evaluator.h"

namespace luxrig {

struct BruteForceLux {
  double lux = 0, standard_error_lux = 0;
};

class BruteForcePath {
 public:
  BruteForcePath(const Scene& scene, std::span<const Emitter> emitters) : emitters_(emitters) {
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
      const auto& v = scene.triangles[t];
      const Vec3 a = scene.vertex_world_m(v[0]), ab = scene.vertex_world_m(v[1]) - a,
                 ac = scene.vertex_world_m(v[2]) - a;
      triangles_.push_back(
          {a, ab, ac, ab.cross(ac).normalized(), scene.materials[scene.material_of_triangle[t]].reflectance_rgb});
    }
  }

  BruteForceLux lux_at(const Receiver& receiver, int paths, std::uint64_t seed) const {
    std::mt19937_64 bits(seed);
    const auto chance = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
    double sum = 0, squares = 0;
    for (int i = 0; i < paths; ++i) {
      Vec3 at_m = receiver.position_world_m, normal = receiver.normal_world;
      double lux = 0;
      Vec3 weight = Vec3::Ones();  // per primary: the product of means would be wrong for red and green walls
      for (;;) {
        // Cosine-weighted. Each hit reflects with the probability of its highest reflectance among the primaries.
        const double radius = std::sqrt(chance()), turn = 2 * kPi * chance();
        const Vec3 x = normal.cross(std::abs(normal.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
        const Vec3 direction = radius * std::cos(turn) * x + radius * std::sin(turn) * normal.cross(x) +
                               std::sqrt(1 - radius * radius) * normal;
        const auto hit = nearest(at_m, direction, 1e300);
        if (!hit) break;
        const Triangle& surface = triangles_[hit->triangle];
        const double goes_on = surface.reflectance.maxCoeff();
        if (chance() >= goes_on) break;
        weight = weight.cwiseProduct(surface.reflectance) / goes_on;
        at_m += hit->distance * direction;
        normal = surface.normal.dot(direction) < 0 ? surface.normal : Vec3(-surface.normal);
        lux += weight.dot(Vec3(0.2126, 0.7152, 0.0722)) * direct_lx(at_m, normal);
      }
      sum += lux, squares += lux * lux;
    }
    const double mean = sum / paths;
    return {direct_lx(receiver.position_world_m, receiver.normal_world) + mean,
            std::sqrt(std::max(0.0, squares / paths - mean * mean) / paths)};
  }

 private:
  struct Triangle {
    Vec3 a, ab, ac, normal, reflectance;
  };
  struct Crossing {
    double distance;
    std::size_t triangle;
  };

  /// T. Möller and B. Trumbore (1997). Hits nearer than 1e-7 of the distance asked for are the surface just left.
  std::optional<Crossing> nearest(const Vec3& from_m, const Vec3& direction, double most) const {
    std::optional<Crossing> found;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      const Triangle& one = triangles_[t];
      const Vec3 p = direction.cross(one.ac);
      const double scale = 1 / one.ab.dot(p);
      const Vec3 s = from_m - one.a, q = s.cross(one.ab);
      const double u = scale * s.dot(p), v = scale * direction.dot(q), distance = scale * one.ac.dot(q);
      if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
      if (distance > 1e-6 && distance < most && (!found || distance < found->distance)) found = Crossing{distance, t};
    }
    return found;
  }

  double direct_lx(const Vec3& at_m, const Vec3& normal) const {
    double sum = 0;
    for (const Emitter& e : emitters_) {
      const Vec3 to_m = e.world_from_lamp.translation_m - at_m;
      const double distance_m = to_m.norm(), cosine = normal.dot(to_m) / distance_m;
      if (cosine <= 0 || nearest(at_m, to_m / distance_m, distance_m - 1e-6)) continue;
      sum += e.intensity->intensity_cd(e.world_from_lamp.inverse_direction(-to_m / distance_m)) * cosine /
             (distance_m * distance_m);
    }
    return sum;
  }

  std::span<const Emitter> emitters_;
  std::vector<Triangle> triangles_;
};

}  // namespace luxrig
