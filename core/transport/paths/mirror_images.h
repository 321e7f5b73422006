#pragma once
/// Where smooth plane surfaces show the lamps: the second way to find the highlights that light a point.
///
/// Seen from x, a plane shows the lamp p at the foot q of the mirrored way. A glossy plane shows it about there, at
/// places y whose facets with slope m(y) would mirror p to x; by GGX slopes have the density P22(m). To first order
///   m(y) = J (y - q),   J = k (I - s² u uᵀ),   k = (1/d1 + 1/d2) / (2 c)
/// with d1, d2 the ways from q to x and p, c and s cosine and sine of the angle of incidence, u the trace of the plane
/// of incidence. So y = q + J⁻¹ m with m drawn from P22 has the density P22(J (y - q)) |det J|: known for every y, so
/// that this way shares the work with all others, and near q in proportion to what is to be found. A lamp with size
/// shows an image as wide as its own: slopes are then drawn from so much wider a P22.

#include <vector>

#include "core/transport/direct/lamps.h"

namespace luxrig {

/// Images of lamps as seen from one place, by how much light they may bring; or from anywhere.
struct ImageChoice {
  struct Image {
    std::uint32_t image;  ///< plane × places + place
    double up_to;         ///< probability of this and of those before it
  };
  std::vector<Image> images;  ///< by `image`

  /// 0 for one that is never drawn.
  [[nodiscard]] double probability(std::uint32_t image) const;
};

class MirrorImages {
 public:
  static constexpr std::uint32_t kNoPlane = ~0u;

  /// scene, lamps   must outlive it
  MirrorImages(const RayScene& scene, const Lamps& lamps);

  [[nodiscard]] bool any() const { return !planes_.empty() && places_ > 0; }
  /// The plane that a triangle is part of.
  [[nodiscard]] std::uint32_t plane_of(std::uint32_t triangle) const {
    return triangle < plane_of_.size() ? plane_of_[triangle] : kNoPlane;
  }
  [[nodiscard]] std::uint32_t material_of(std::uint32_t plane) const { return planes_[plane].material; }

  /// By area and light alone.
  [[nodiscard]] const ImageChoice& from_anywhere() const { return from_anywhere_; }
  /// By the mirrored illuminance, were nothing in the way.
  [[nodiscard]] ImageChoice seen_from(const Vec3& position_world_m, const Vec3& normal_world) const;

  struct Place {
    std::uint32_t plane = kNoPlane;  ///< kNoPlane: none could be drawn
    std::size_t place_of_lamp = 0;
    Vec3 position_world_m = Vec3::Zero(), normal_world = Vec3::UnitZ();  ///< towards where it is seen from
    double density_per_m2 = 0;                                           ///< with the probability of the image
  };
  /// A place on a plane, about where it shows a lamp; not always one where the plane has a surface.
  [[nodiscard]] Place draw(const ImageChoice& choice, const Vec3& from_world_m, double select, double u,
                           double v) const;
  /// Density [1/m²] with which draw() gives a place of a plane together with a place of lamps.
  [[nodiscard]] double density_per_m2(const ImageChoice& choice, const Vec3& from_world_m, std::uint32_t plane,
                                      std::size_t place_of_lamp, const Vec3& position_world_m) const;

 private:
  struct Plane {
    Vec3 normal_world;  ///< unit
    double offset_m;    ///< normal · p of its places
    std::uint32_t material;
    double alpha, specular, area_m2 = 0;
    Vec3 across_world, along_world;
    Eigen::AlignedBox2d bounds_m;  ///< along these
  };
  struct Image {
    Vec3 foot_world_m, along_world, across_world, normal_world;
    double per_slope_along, per_slope_across;  ///< diagonal of J
    double alpha;                              ///< of the slopes that are drawn
    double way_m;
  };
  void find_planes(const RayScene& scene);
  [[nodiscard]] std::optional<Image> image(const Plane& plane, std::size_t place_of_lamp,
                                           const Vec3& from_world_m) const;
  [[nodiscard]] static double density_per_m2(const Image& image, const Vec3& position_world_m);

  const Lamps& lamps_;
  std::size_t places_;
  std::vector<Plane> planes_;
  std::vector<std::uint32_t> plane_of_;  ///< by triangle
  ImageChoice from_anywhere_;
};

}  // namespace luxrig
