#pragma once
/// Closed rooms with exactly known light, to measure evaluators against in tests and in `luxrig bench analytic`.

#include "core/scene/scene.h"

namespace luxrig {

/// A point on a wall, with the normal that points into the enclosure.
struct WallPoint {
  Vec3 position_m;
  Vec3 normal;
};

/// Cube [-edge/2, edge/2]³, twelve triangles, one reflectance.
[[nodiscard]] Scene make_cube(double edge_m, double reflectance);

/// Sphere about the origin: an icosahedron split `splits` times (20·4^splits triangles), vertices on the sphere.
[[nodiscard]] Scene make_icosphere(double radius_m, int splits, double reflectance);

/// Centres of a grid of per_edge² equal squares on each face of make_cube(edge_m): their mean is the midpoint rule.
[[nodiscard]] std::vector<WallPoint> cube_wall_grid(double edge_m, int per_edge);

/// Sum of the triangle areas [m²].
[[nodiscard]] double area_m2(const Scene& scene);

/// `count` points spread evenly by area over the triangles, the same on each call, each facing `inside_m`.
[[nodiscard]] std::vector<WallPoint> spread_over_walls(const Scene& scene, std::size_t count, const Vec3& inside_m);

/// Mean illuminance [lx] of the walls of a closed enclosure with one reflectance, for a source of flux_lm inside. Every
/// reflection keeps the share ρ of the flux. So Φ (1 + ρ + ρ² + …) = Φ/(1-ρ) falls on the area in total.
[[nodiscard]] double mean_wall_illuminance_lx(double flux_lm, double area_m2, double reflectance);

/// Its reflected part, Φ/A · ρ/(1-ρ): the same at every point of the wall of an integrating sphere.
[[nodiscard]] double reflected_wall_illuminance_lx(double flux_lm, double area_m2, double reflectance);

}  // namespace luxrig
