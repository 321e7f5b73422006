#pragma once
/// Lux at each receiver per lumen on each place of the surfaces: the adjoint of reflected light, computed once for all
/// emitters.
///
/// W(r, y) [lx/lm] is the illuminance at receiver r, by any number of diffuse reflections, per lumen that falls on the
/// surface at y and is not absorbed there (ρ left out):
///   W(r, y) = cosθr cosθy V / (π d²) + mean over cosine-weighted directions at y of ρ(z) W(r, z),   z = what they hit,
///   E_reflected(r) = ∫ ρ(y) W(r, y) dΦ(y),   Φ = flux that comes straight from the emitter.
/// The first term is kept for each of a cell's places (surface_cells.h), with one visibility ray per receiver; it
/// applies to the surface nearest to that place. The second term is smooth: it is kept on patches, the cells of a
/// coarser grid, and solved by iteration with rays cast once from every cell. Emitters then cast rays and look up W at
/// their hits, so the bright spot of a lamp on a ceiling close by is sampled where it is.
///
/// One field is one independent estimate: its grid, places and rays are random. The spread of several (replicates)
/// gives the error: it includes the flatness of cells, visibility tested at one place, and all rays.

#include <array>
#include <span>
#include <vector>

#include "core/run.h"
#include "core/transport/candidates/candidate_transport.h"
#include "core/transport/candidates/reflected/surface_cells.h"
#include "core/transport/candidates/reflected/weighted_rows.h"
#include "core/transport/candidates/visible_points.h"

namespace luxrig {

struct ImportanceSettings {
  double cell_m = 0.25;
  /// Cosine-weighted rays that find cells and directions. Then the same number again, plus guided_rays_per_cell in the
  /// directions where the first found much, gathers light.
  std::uint32_t rays_per_cell = 16;
  std::uint32_t guided_rays_per_cell = 32;
  std::uint32_t max_cells = 200'000;
  std::uint64_t seed = 1;   ///< of this field
  bool keep_links = false;  ///< needed by update_receiver()
};

class SurfaceImportance {
 public:
  /// also_from_world_m   further places that light will come from: cells are also made where these see surfaces
  SurfaceImportance(const Scene& scene, const VisibilityScene& visibility, std::span<const Receiver> receivers,
                    std::span<const Vec3> also_from_world_m, const ImportanceSettings& settings,
                    const CandidateSkips& skips, const std::stop_token& stop);

  /// Recomputes both terms of a receiver that has moved (the span given to the constructor now has its new data). Cells
  /// stay unchanged.
  void update_receiver(const VisibilityScene& visibility, std::size_t receiver, const CandidateSkips& skips);

  /// Number of receivers, rounded up to a multiple of kRowUnit: the length of the rows below.
  [[nodiscard]] std::size_t stride() const { return stride_; }
  /// W [lx/lm], a row of stride() for each place of each cell.
  [[nodiscard]] const float* rows() const { return settings_.keep_links ? both_.data() : first_.data(); }
  /// Row of W for a place on a surface, or kNoRow if no light gets from there to a receiver. Adds the rays cast.
  [[nodiscard]] std::uint32_t row_at(const Vec3& position_world_m, const Vec3& normal_world, std::uint64_t& rays) const;
  static constexpr std::uint32_t kNoRow = ~0u;
  [[nodiscard]] const SurfaceCells& surfaces() const { return surfaces_; }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  /// A ray that leaves a cell.
  struct Bounce {
    std::array<float, 3> direction_world;
    std::uint32_t row;  ///< of the hit; kNoRow = none
    float reflectance;  ///< of the hit
    float weight;       ///< in the mean over cosine-weighted directions, including the reflectance
  };

  void discover(std::span<const Vec3> also_from_world_m);
  void trace_bounces(std::uint32_t cell);
  [[nodiscard]] Bounce trace(const SurfaceCells::CellPoint& from, const Vec3& direction, bool may_make_cells);
  void make_patches(const Scene& scene);
  void gather_bounces();
  void see_receiver(const VisibilityScene& visibility, const PointTree& tree, std::span<const Vec3> places_m,
                    std::size_t receiver, const CandidateSkips& skips);
  void see_receivers(const VisibilityScene& visibility, const CandidateSkips& skips);
  [[nodiscard]] std::vector<Vec3> places_m() const;  ///< of all rows
  [[nodiscard]] std::size_t rows_count() const { return surfaces_.cells().size() * kPlaces; }
  [[nodiscard]] std::uint32_t nearest_row(std::uint32_t cell, const Vec3& position_world_m) const;
  void link_patches();
  [[nodiscard]] double kernel(const Receiver& receiver, const SurfaceCells::CellPoint& place) const;
  void solve(double converged);
  void solve_strip(std::size_t from, std::size_t width, double converged);
  void add_terms();

  static constexpr Bounce kNothing{{0, 0, 1}, kNoRow, 0, 0};
  static constexpr auto kPlaces = static_cast<std::uint32_t>(SurfaceCells::kPlaces);

  const RayScene& scene_;
  std::span<const Receiver> receivers_;
  ImportanceSettings settings_;
  std::stop_token stop_;
  SurfaceCells surfaces_;
  std::size_t stride_;
  std::vector<Bounce> bounces_;  ///< the same number for each cell
  std::vector<std::uint32_t> patch_of_cell_;
  std::uint32_t patches_ = 0;
  std::vector<std::vector<WeightedRow>> from_rows_, from_patches_;  ///< per patch: hits of its rays, with weights
  std::vector<float> first_;  ///< first term of W, rows × stride; the second is added at the end, unless links are kept
  std::vector<float> further_;      ///< second term, patches × stride
  std::vector<float> both_;         ///< their sum, if links are kept: rows × stride
  std::vector<std::uint8_t> live_;  ///< per row: W is above 0 for a receiver
  std::uint64_t rays_ = 0;
};

/// Effective diffuse reflectance: gloss counts as extra diffuse reflectance. A Fresnel coat of F0 reflects F0 + (1 -
/// F0)/21 of diffuse light (Schlick's approximation, averaged over the hemisphere); the body gets the rest.
[[nodiscard]] double diffuse_reflectance(const Material& material);

}  // namespace luxrig
