#pragma once
/// Parts of the radiance cache. Each can be switched, so that a table can show its gain (cache_ablation.h).

#include <cstdint>

namespace luxrig {

/// Contents of a cell.
enum class CacheContents {
  /// Incoming radiance by direction, as spherical harmonics: the thesis's volumetric cache (§3.2).
  directions,
  /// Illuminance of each side of the surfaces in the cell. Surfaces that face different ways, or that cannot see each
  /// other (both sides of a wall over one floor), are different sides, so that no light leaks from one to the other.
  sides
};

/// How a line is traced through the scene.
enum class Traversal {
  march,     ///< few stratified samples of the geometry volume, as in the thesis; misses thin walls
  walk,      ///< every voxel of the geometry volume (3-D DDA)
  distance,  ///< the same answer, in strides of a distance field
  rays       ///< the triangles themselves
};

/// The surface that a ray from one cell to another is assumed to hit there.
enum class LinkSurface {
  phantom,  ///< one that faces the ray, with the scene's mean reflectance, as in the thesis
  met       ///< the surface itself: its normal and reflectance (with Traversal::rays; else as phantom)
};

/// How a receiver reads the cache.
enum class Reconstruction {
  hemisphere,  ///< from a few cells above the point, as in the thesis
  gather       ///< from the surfaces that rays from the point hit, each read on its side
};

/// Source of the first reflection.
enum class FirstReflection {
  cache,  ///< the light-view samples stored in the cells
  exact   ///< direct light where the gather's rays hit (with Reconstruction::gather)
};

struct CacheSettings {
  CacheContents contents = CacheContents::sides;

  // Volumes -----------------------------------------------------------------------------------------------------------
  int voxels = 256;  ///< of the geometry volume along the scene's longest side; 16…1024 (memory and time with the cube)
  int reduction = 4;        ///< voxels per cell, per axis; 1…16
  bool only_needed = true;  ///< only cells that a receiver can need; false: all near surfaces

  // Light -------------------------------------------------------------------------------------------------------------
  int light_samples = 2048;  ///< first hits traced from each emitter; thesis: 50…200
  int reflections = 0;       ///< reflections followed; 0 = all

  // CacheContents::sides ----------------------------------------------------------------------------------------------
  int gather_rays = 4096;  ///< rays from each receiver
  int group_cells = 4;     ///< cells per group, per axis: later reflections are exchanged between groups
  int group_rays = 256;    ///< rays from each group
  /// The brightest sides are read by their exact form factor with shadow rays, if few gather rays would hit them.
  bool bright_sides = true;

  // CacheContents::directions -----------------------------------------------------------------------------------------
  Traversal first_visibility = Traversal::march;  ///< from a cell to a light-view sample
  int first_steps = 12;                           ///< samples of the march; thesis: 8…12
  Traversal link_traversal = Traversal::march;    ///< from a cell to the cell that it reflects light of
  int link_steps = 6;                             ///< samples of the march; thesis: 4…6
  int link_rays = 64;                             ///< rays from each cell
  LinkSurface link_surface = LinkSurface::phantom;
  /// In a cell that a wall passes through, places are taken on the side from which the cell is first read. False, as in
  /// the thesis: anywhere in the cell, so that the space behind the wall dims the cell or leaks light into it.
  bool open_places = false;
  int luminance_order = 3;    ///< of the harmonics, 1…3
  int chrominance_order = 2;  ///< of the harmonics of Co and Cg, 1…luminance_order
  bool ycocg = true;          ///< colour as luminance and chrominance; false: as RGB, all of luminance_order
  Reconstruction reconstruction = Reconstruction::hemisphere;
  int hemisphere_samples = 8;  ///< places above the point
  FirstReflection first_reflection = FirstReflection::cache;

  /// The thesis's method with its figures: 128³ voxels, cells of 4³, 200 light-view samples, marches of 12 and 6
  /// samples.
  [[nodiscard]] static CacheSettings of_thesis() {
    CacheSettings settings;
    settings.contents = CacheContents::directions;
    settings.voxels = 128;
    settings.light_samples = 200;
    return settings;
  }
};

}  // namespace luxrig
