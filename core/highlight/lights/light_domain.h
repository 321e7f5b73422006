#pragma once
/// Possible places of luminaires (thesis §6.5.1): chosen surfaces with layers above them, or boxes around the target.

#include <memory>
#include <span>
#include <vector>

#include "core/highlight/shadow/direction_bins.h"
#include "core/highlight/surface/target_surface.h"
#include "core/result.h"
#include "core/scene/scene.h"

namespace luxrig {

struct LightDomainOptions {
  /// One copy of the surfaces for each, offset along their normals; negative = behind them.
  std::vector<double> layer_offsets_m = {0};
  int cell_side = 16;  ///< of DirectionBins: cells are 59° / side wide as seen from the target
};

struct NestedBoxOptions {
  int boxes = 3;        ///< each is a layer, smallest first
  double margin_m = 0;  ///< from the target's bounding box to the first; 0 = half that box's diagonal
  double step_m = 0;    ///< from each to the next; 0 = the margin
  int cell_side = 16;
};

/// A cell of the domain: the part of one group that lies, seen from the target's centre, within one of DirectionBins'
/// cells. These have equal area, unlike the thesis's tessellated icosahedron. A group is one layer of one contiguous
/// piece of the surfaces, so a rail in front of a wall is not averaged with the wall. A piece that folds back on itself
/// as seen from the centre is averaged.
struct DomainCell {
  std::uint32_t group, bin;
  auto operator<=>(const DomainCell&) const = default;
};

struct DomainHit {
  std::uint32_t ray;       ///< index of the direction
  std::uint32_t triangle;  ///< of LightDomain::triangles
  double distance_m;
};

/// Immutable and thread-safe.
class LightDomain {
 public:
  struct Triangle {
    std::array<Vec3, 3> corners_m;  ///< relative to the centre
    Vec3 normal;                    ///< unit
    std::uint32_t group;
  };

  ~LightDomain();
  LightDomain(LightDomain&&) noexcept;
  LightDomain& operator=(LightDomain&&) noexcept;

  [[nodiscard]] const Vec3& centre_world_m() const;
  [[nodiscard]] const DirectionBins& bins() const;
  [[nodiscard]] std::span<const Triangle> triangles() const;
  [[nodiscard]] std::uint32_t groups() const;
  [[nodiscard]] std::uint32_t layer_of(std::uint32_t group) const;

  /// Appends every hit along each ray, on all layers, by ray, group and distance. A ray through an edge shared by two
  /// triangles of a group hits it once. Directions need not be unit; distances are in metres in any case.
  void hits_along(const Vec3& from_world_m, std::span<const Vec3f> directions_world,
                  std::vector<DomainHit>& hits) const;

  [[nodiscard]] DomainCell cell_of(const Vec3& position_world_m, std::uint32_t group) const;

  struct CellCentre {
    DomainCell cell;
    Vec3 position_world_m;
    double area_m2;
  };
  /// All cells and their centres, by cell. A cell's surface is cut into pieces of a quarter of the cell's width, at
  /// least 2^-12 of the domain's size. The centre is that of the piece nearest to the area-weighted mean.
  [[nodiscard]] std::vector<CellCentre> cell_centres() const;

 private:
  struct State;
  explicit LightDomain(std::unique_ptr<State> state);
  static LightDomain with(const Vec3& centre_world_m, int cell_side, std::vector<Triangle> triangles,
                          std::vector<std::uint32_t> layer_of_group);
  friend Result<LightDomain> mesh_light_domain(const Scene&, std::span<const std::uint8_t>, const Vec3&,
                                               const LightDomainOptions&);
  friend Result<LightDomain> nested_box_domain(const TargetSurface&, const NestedBoxOptions&);
  std::unique_ptr<State> state_;
};

/// Surfaces of a mesh. A layer's triangles lie in planes at exactly that offset; shared corners move along the mean
/// normal, so that layers of a curved surface or a box stay closed.
/// of_triangles     one flag per triangle; empty = all
/// centre_world_m   of the target: TargetSurface::centroid_world_m
/// Refuses a domain without area, coordinates and offsets that are not finite, no layers, and a cell_side outside
/// 1…1024.
[[nodiscard]] Result<LightDomain> mesh_light_domain(const Scene& scene, std::span<const std::uint8_t> of_triangles,
                                                    const Vec3& centre_world_m, const LightDomainOptions& options);

/// For targets without a given domain. Refuses a target without area, fewer than one box, and sizes that are negative
/// or not finite.
[[nodiscard]] Result<LightDomain> nested_box_domain(const TargetSurface& target, const NestedBoxOptions& options);

}  // namespace luxrig
