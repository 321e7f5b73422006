#pragma once
/// What the radiance cache does and leaves out. Each part can be switched, so that a table can show what it buys
/// (cache_ablation.h).

#include <cstdint>

namespace luxrig {

/// What a cell of the cache holds.
enum class CacheContents {
  /// Incoming radiance by direction, as spherical harmonics: the thesis's volumetric cache (§3.2).
  directions,
  /// Illuminance of each side of the surfaces in the cell. Surfaces that look different ways, or that cannot see each
  /// other (a floor on both sides of a wall), are different sides, so that nothing leaks from one to the other.
  sides
};

/// How a line is followed through the scene.
enum class Traversal {
  march,     ///< few stratified looks into the geometry volume, as the thesis; misses thin walls
  walk,      ///< every voxel of the geometry volume (3-D DDA)
  distance,  ///< the same answer by strides of a distance field
  rays       ///< the triangles themselves
};

/// Which surface a ray from a cell to another is taken to meet there.
enum class LinkSurface {
  phantom,  ///< one that faces the ray, of the scene's mean reflectance, as the thesis
  met       ///< the one that is met: its normal and reflectance (with Traversal::rays; else as phantom)
};

/// How a receiver reads the cache.
enum class Reconstruction {
  hemisphere,  ///< from a few cells above the point, as the thesis
  gather       ///< from the surfaces that rays from the point meet, each read on its side
};

/// Where the first reflection comes from.
enum class FirstReflection {
  cache,  ///< the light-view samples stored in the cells
  exact   ///< direct light at the places that the gather's rays meet (with Reconstruction::gather)
};

struct CacheSettings {
  CacheContents contents = CacheContents::sides;

  // Volumes -----------------------------------------------------------------------------------------------------------
  int voxels = 256;  ///< of the geometry volume along the scene's longest side; 16…1024 (memory and time with the cube)
  int reduction = 4;        ///< voxels to a cell, per axis; 1…16
  bool only_needed = true;  ///< cells only where a receiver can need them; false: everywhere near surfaces

  // Light -------------------------------------------------------------------------------------------------------------
  int light_samples = 2048;  ///< first hits traced from each emitter; the thesis: 50…200
  int reflections = 0;       ///< reflections followed; 0 = all

  // CacheContents::sides ----------------------------------------------------------------------------------------------
  int gather_rays = 4096;  ///< rays from each receiver
  int group_cells = 4;     ///< cells to a group, per axis: later reflections are exchanged between groups
  int group_rays = 256;    ///< rays from each group
  /// The brightest sides are read by their exact form factor with shadow rays, where few gather rays would meet them.
  bool bright_sides = true;

  // CacheContents::directions -----------------------------------------------------------------------------------------
  Traversal first_visibility = Traversal::march;  ///< from a cell to a light-view sample
  int first_steps = 12;                           ///< looks of the march; the thesis: 8…12
  Traversal link_traversal = Traversal::march;    ///< from a cell to the cell whose light it reflects
  int link_steps = 6;                             ///< looks of the march; the thesis: 4…6
  int link_rays = 64;                             ///< rays from each cell
  LinkSurface link_surface = LinkSurface::phantom;
  /// Places in a cell that a wall goes through are taken on the side from which the cell is first read; false, as the
  /// thesis: anywhere in it, so that what lies behind the wall dims the cell or leaks into it.
  bool open_places = false;
  int luminance_order = 3;    ///< of the harmonics, 1…3
  int chrominance_order = 2;  ///< of the harmonics of Co and Cg, 1…luminance_order
  bool ycocg = true;          ///< colour as luminance and chrominance; false: as RGB, all of luminance_order
  Reconstruction reconstruction = Reconstruction::hemisphere;
  int hemisphere_samples = 8;  ///< places above the point
  FirstReflection first_reflection = FirstReflection::cache;

  /// The thesis's method with its figures: 128³ voxels, cells of 4³, 200 light-view samples, marches of 12 and 6 looks.
  [[nodiscard]] static CacheSettings of_thesis() {
    CacheSettings settings;
    settings.contents = CacheContents::directions;
    settings.voxels = 128;
    settings.light_samples = 200;
    return settings;
  }
};

}  // namespace luxrig
