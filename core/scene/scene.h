#pragma once
/// Geometry that light hits: triangles with diffuse reflectance, in frame world.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/scene/panes.h"

namespace luxrig {

/// No paint is whiter, and a closed room of it would hardly absorb.
inline constexpr double kMaxReflectance = 0.95;

struct Material {
  std::string name;
  Vec3 reflectance_rgb = Vec3::Constant(0.5);  ///< diffuse, linear Rec. 709, each 0…0.95
  /// Gloss: a GGX microfacet coat over the diffuse body, which receives the light that the coat lets through.
  /// Reflectance at normal incidence, 0…0.95 (0: matt; varnish and polished floors 0.04; metals more), and the
  /// roughness α = roughness², 0.05…1.
  double specular_reflectance = 0;
  double roughness = 0.3;
  bool coloured = false;    ///< reflectance_rgb is from the mesh file or the rig, not assumed
  bool too_bright = false;  ///< the mesh file stated more than 0.95; taken as 0.95

  /// Luminous reflectance: the Rec. 709 luminance of reflectance_rgb.
  [[nodiscard]] double luminous_reflectance() const {
    return 0.2126 * reflectance_rgb.x() + 0.7152 * reflectance_rgb.y() + 0.0722 * reflectance_rgb.z();
  }
};

/// Counts of geometry dropped while loading.
struct Cleaning {
  std::size_t non_finite_vertices = 0;   ///< NaN or infinite; triangles that use them are dropped
  std::size_t bad_indices = 0;           ///< triangles with an index past the vertices
  std::size_t degenerate_triangles = 0;  ///< no area, within rounding
  [[nodiscard]] std::size_t total() const { return non_finite_vertices + bad_indices + degenerate_triangles; }
};

/// All triangles of a venue, two-sided. Vertices are relative to origin_world_m, so that float keeps them to a few
/// micrometres whatever the map coordinates.
struct Scene {
  Vec3 origin_world_m = Vec3::Zero();
  std::vector<Vec3f> vertices_m;                        ///< relative to origin_world_m
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into vertices_m
  std::vector<std::uint32_t> material_of_triangle;
  std::vector<std::uint32_t> object_of_triangle;  ///< index into object_names
  std::vector<Material> materials;
  std::vector<std::string> object_names;  ///< "scene", then the rig's objects in order
  std::vector<Pane> panes;                ///< glass, kept apart from the triangles, which stop light
  Cleaning cleaning;
  std::vector<std::string> warnings;

  [[nodiscard]] Vec3 vertex_world_m(std::uint32_t index) const {
    return origin_world_m + vertices_m[index].cast<double>();
  }
};

}  // namespace luxrig
