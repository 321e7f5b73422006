#pragma once
/// The cells of the thesis's volumetric cache, and how they read each other: everything that does not depend on
/// emitters. Cells hold incoming radiance as spherical harmonics.

#include <array>
#include <stop_token>
#include <vector>

#include "core/transport/sobol.h"
#include "tools/bench/cache/radiance_cache.h"
#include "tools/bench/cache/spherical_harmonics.h"
#include "tools/bench/cache/volume/voxel_walk.h"

namespace luxrig {

class DirectionCells {
 public:
  static constexpr std::int32_t kNone = -1;

  /// A cell to read at a place, with its weight. The weights at a place add up to 1, or there are none.
  struct CellShare {
    std::int32_t cell;
    float weight;
  };
  using Shares = std::array<CellShare, 8>;

  /// A ray from a cell to the surface that sends it light.
  struct Link {
    std::int32_t from;      ///< the cell read there
    Vec3f direction_world;  ///< of the ray, unit
    Vec3f normal_world;     ///< of the surface
    Vec3f reflectance_rgb;
  };
  /// Where a cell was first read from; zero normal if not known.
  struct Reader {
    Vec3 surface_m = Vec3::Zero();
    Vec3 normal = Vec3::Zero();
  };

  DirectionCells(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers,
                 const CacheSettings& settings);

  /// The eight cells around a place with trilinear weights, without cells that do not exist. With a non-zero normal,
  /// only cells with their centre on that side of the place. Returns their number.
  std::size_t shares_at(const Vec3& place_m, const Vec3& side_normal, Shares& shares) const;

  /// Marks a cell as needed from a surface with this normal. The first call decides which part of the cell is open
  /// (CacheSettings::open_places).
  void need(std::int32_t cell, const Vec3& surface_m, const Vec3& normal);

  /// Rays of all needed cells, and of the cells that they reach if `reflections` (0 = all) follow. Then, unless
  /// settings.only_needed, also of all other cells, which count as needed from then on.
  void link(const Scene& scene, const RayScene& rays, const CacheSettings& settings, int reflections,
            std::uint64_t seed, int threads, const std::stop_token& stop);

  /// True if nothing is between a place in a cell and a surface.
  [[nodiscard]] bool visible(const RayScene& rays, const CacheSettings& settings, const Vec3& from_m, const Vec3& to_m,
                             double jitter, std::uint64_t& cast) const;

  [[nodiscard]] std::size_t size() const { return voxel_.size(); }
  [[nodiscard]] bool needed(std::size_t cell) const { return needed_[cell]; }
  [[nodiscard]] const Eigen::Vector3i& voxel(std::size_t cell) const { return voxel_[cell]; }
  [[nodiscard]] double cell_m() const { return cells_.voxel_m; }
  /// A place in a cell for three numbers in 0…1, relative to the scene's origin.
  [[nodiscard]] Vec3 place_m(std::size_t cell, double u, double v, double w) const;
  [[nodiscard]] std::span<const Link> links_of(std::size_t cell) const {
    return std::span(links_).subspan(first_link_[cell], first_link_[cell + 1] - first_link_[cell]);
  }
  [[nodiscard]] std::size_t links() const { return links_.size(); }
  [[nodiscard]] std::uint64_t rays() const { return cast_; }
  [[nodiscard]] const Vec3& origin_world_m() const { return origin_world_m_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  [[nodiscard]] std::int32_t cell_at(const Eigen::Vector3i& voxel) const {
    return cells_.contains(voxel) ? cell_of_[cells_.index(voxel)] : kNone;
  }
  void link_one(const Scene& scene, const RayScene& rays, const CacheSettings& settings, std::size_t cell,
                std::uint64_t seed, std::vector<Link>& links, std::vector<Reader>& readers, std::uint64_t& cast) const;

  Vec3 origin_world_m_;
  VoxelGrid voxels_, cells_;
  BitVolume geometry_;
  DistanceField field_;
  std::vector<std::int32_t> cell_of_;  ///< of each voxel of cells_
  std::vector<Eigen::Vector3i> voxel_;
  std::vector<bool> needed_;
  bool open_places_ = false;
  std::vector<Reader> reader_;
  std::vector<Link> links_;
  std::vector<std::size_t> first_link_;
  Vec3 mean_reflectance_rgb_ = Vec3::Zero();
  std::uint64_t cast_ = 0;
};

}  // namespace luxrig
