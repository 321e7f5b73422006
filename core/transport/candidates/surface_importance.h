#pragma once
/// How many lux at each receiver a lumen brings, by where on the surfaces it falls: the adjoint of reflected light,
/// once for all emitters.
///
/// With W(r, y) [lx/lm] the illuminance at receiver r, by any number of diffuse reflections, per lumen that falls on
/// the surface at y and is not absorbed there (ρ left out),
///   W(r, y) = cosθr cosθy V / (π d²) + mean over cosine-weighted directions at y of ρ(z) W(r, z),   z = what they hit,
///   E_reflected(r) = ∫ ρ(y) W(r, y) dΦ(y),   Φ = flux that comes straight from the emitter.
/// W is solved on cells (surface_cells.h): the first term at a cell's place with a visibility ray per receiver, the
/// second with a fixed set of rays per cell, iterated to convergence. Emitters then cast rays and look up W where these
/// hit; so the bright spot that a lamp makes on a ceiling close by is sampled where it is.
///
/// One field is one independent estimate: its grid, places and rays are random. Errors come from several (replicates):
/// their spread holds the error of cells being flat, of visibility asked at one place per cell, and of all rays.

#include <span>
#include <vector>

#include "core/stop.h"
#include "core/transport/candidates/candidate_transport.h"
#include "core/transport/candidates/surface_cells.h"
#include "core/transport/candidates/visible_points.h"

namespace luxrig {

struct ImportanceSettings {
  double cell_m = 0.25;
  std::uint32_t rays_per_cell = 32;
  std::uint32_t most_cells = 200'000;
  std::uint64_t seed = 1;  ///< of this field
};

class SurfaceImportance {
 public:
  /// also_from_world_m   places from which light will come: what they see gets cells too
  SurfaceImportance(const Scene& scene, const VisibilityScene& visibility, std::span<const Receiver> receivers,
                    std::span<const Vec3> also_from_world_m, const ImportanceSettings& settings,
                    const CandidateSkips& skips, const std::stop_token& stop);

  /// Number of floats in row(): receivers, rounded up to a multiple of 8.
  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] std::span<const float> row(std::uint32_t cell) const {
    return {lux_per_lumen_.data() + cell * stride_, stride_};
  }
  /// W of the cell is above 0 for a receiver.
  [[nodiscard]] bool live(std::uint32_t cell) const { return live_[cell] != 0; }
  [[nodiscard]] const SurfaceCells& surfaces() const { return surfaces_; }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }
  [[nodiscard]] std::uint32_t sweeps() const { return sweeps_; }
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Bounce {
    std::uint32_t cell;  ///< SurfaceCells::kNone: nothing was hit
    float share;         ///< ρ / rays per cell
  };

  void discover(std::span<const Vec3> also_from_world_m);
  void trace_bounces(std::uint32_t cell);
  void see_receivers(const VisibilityScene& visibility, const CandidateSkips& skips);
  [[nodiscard]] double kernel(const Receiver& receiver, const SurfaceCells::Cell& cell) const;
  void solve();

  const RayScene& scene_;
  std::span<const Receiver> receivers_;
  ImportanceSettings settings_;
  std::stop_token stop_;
  SurfaceCells surfaces_;
  std::size_t stride_;
  std::vector<Bounce> bounces_;        ///< rays_per_cell for each cell
  std::vector<float> seen_per_lumen_;  ///< first term of W, cells × stride
  std::vector<float> lux_per_lumen_;   ///< W, cells × stride
  std::vector<std::uint8_t> live_;
  std::uint64_t rays_ = 0;
  std::uint32_t sweeps_ = 0;
};

/// Reflectance that counts here: diffuse, and gloss as further diffuse reflectance. A Fresnel coat of F0 reflects
/// F0 + (1 - F0)/21 of diffuse light (Schlick's approximation, averaged over the hemisphere); the body gets the rest.
[[nodiscard]] double diffuse_reflectance(const Material& material);

}  // namespace luxrig
