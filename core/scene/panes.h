#pragma once
/// Panes of glass: thin sheets that light passes straight through, less what they reflect and absorb. They are no
/// obstacles and have no surface that a ray could hit; what goes through them is weighed by transmittance().
///
/// A pane is two surfaces of refractive index n (E. Hecht, Optics, §4.6; unpolarised) and what lies between absorbs.
/// With r the reflectance of one surface at this angle and polarisation and a the share that one passage leaves,
///   T = (1 - r)² a / (1 - r² a²),   a(θ) = a(0)^(1 / cosθ'),   sinθ' = sinθ / n
/// averaged over both polarisations. From the transmittance at normal incidence: n = 1.52 (float glass), and a(0) as
/// follows; where that would have to be above 1 (more than 0.918: coated against reflection), a = 1 and n is lower.
/// What panes reflect is lost: up to 1 - T of what meets them, where it would fall on something.

#include <array>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// A triangle of a pane.
struct Pane {
  std::array<Vec3, 3> corners_world_m;
  double transmittance = 0.91;  ///< luminous, at normal incidence, above 0 and at most 1
  std::uint32_t object = 0;     ///< triangles of one object that are met in one place count once
};

/// Of one pane. at_normal: above 0, at most 1; cosine: of the angle of incidence, either sign.
[[nodiscard]] double pane_transmittance(double at_normal, double cosine);

class Panes {
 public:
  Panes() = default;
  explicit Panes(std::span<const Pane> panes);

  [[nodiscard]] bool empty() const { return objects_.empty(); }
  /// Share of the light that gets from one place to the other through the panes in between, 0…1.
  /// near_m   panes nearer than that to either end do not count: what is measured stands on or under them
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
