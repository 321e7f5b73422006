#pragma once
/// Panes of glass: thin sheets that light passes straight through, minus what they reflect and absorb. They are not
/// obstacles, and no ray can hit them. Light through them is weighted by transmittance().
///
/// A pane is two surfaces of refractive index n (E. Hecht, Optics, §4.6; unpolarised) with an absorber between. With r
/// the reflectance of one surface at this angle and polarisation, and a the share left after one passage,
///   T = (1 - r)² a / (1 - r² a²),   a(θ) = a(0)^(1 / cosθ'),   sinθ' = sinθ / n
/// averaged over both polarisations. n and a(0) come from the transmittance at normal incidence: n = 1.52 (float
/// glass), and a(0) solves the formula. If a(0) would exceed 1 (transmittance over 0.918: antireflective coating),
/// a = 1 and n is lower. Light reflected by panes is lost: up to 1 - T of the light that meets them.

#include <array>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// A triangle of a pane.
struct Pane {
  std::array<Vec3, 3> corners_world_m;
  double transmittance = 0.91;  ///< luminous, at normal incidence, above 0 and at most 1
  std::uint32_t object = 0;     ///< triangles of one object that are crossed at one place count once
};

/// Transmittance of one pane. at_normal: above 0, at most 1. cosine: of the angle of incidence, either sign.
[[nodiscard]] double pane_transmittance(double at_normal, double cosine);

class Panes {
 public:
  Panes() = default;
  explicit Panes(std::span<const Pane> panes);

  [[nodiscard]] bool empty() const { return objects_.empty(); }
  /// Share of light between two places that passes the panes between them, 0…1. near_m: panes nearer than this to
  /// either end do not count, since the measured place is on or under them.
  [[nodiscard]] double transmittance(const Vec3& from_world_m, const Vec3& to_world_m, double near_m) const;

 private:
  struct Triangle {
    std::array<Vec3, 3> corners_m;
    Vec3 normal;
    double transmittance;
  };
  struct Object {
    Eigen::AlignedBox3d box_world_m;
    std::vector<Triangle> triangles;
  };
  std::vector<Object> objects_;
};

}  // namespace luxrig
