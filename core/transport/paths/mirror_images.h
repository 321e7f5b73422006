#pragma once
/// Images of lamps in smooth plane surfaces: the second way to find the highlights that light a point.
///
/// Seen from x, a plane shows the lamp p at the foot q of the mirrored path. A glossy plane shows it around q, at
/// places y whose facets with slope m(y) would mirror p to x; for GGX, slopes have the density P22(m). To first order
///   m(y) = J (y - q),   J = k (I - s² u uᵀ),   k = (1/d1 + 1/d2) / (2 c)
/// with the distances d1, d2 from q to x and p, cosine c and sine s of the angle of incidence, and the trace u of the
/// plane of incidence. So y = q + J⁻¹ m with m drawn from P22 has the density P22(J (y - q)) |det J|. This is known for
/// every y, so it can be weighted against all other ways, and near q it is proportional to the light to be found. A
/// lamp with size shows an image as wide as itself: slopes are then drawn from a correspondingly wider P22.

#include <vector>

#include "core/transport/direct/emitter_sampler.h"

namespace luxrig {

/// Images of lamps seen from one place, by the light they may bring; or from anywhere.
struct ImageChoice {
  struct Image {
    std::uint32_t image;  ///< plane × places + place
    double up_to;         ///< cumulative probability up to this one
  };
  std::vector<Image> images;  ///< by `image`

  /// 0 for an image that is never drawn.
  [[nodiscard]] double probability(std::uint32_t image) const;
};

class MirrorImages {
 public:
  static constexpr std::uint32_t kNoPlane = ~0u;

  /// scene, lamps   must outlive it
  MirrorImages(const RayScene& scene, const EmitterSampler& lamps);

  [[nodiscard]] bool any() const { return !planes_.empty() && places_ > 0; }
  /// The plane that a triangle is part of.
  [[nodiscard]] std::uint32_t plane_of(std::uint32_t triangle) const {
    return triangle < plane_of_.size() ? plane_of_[triangle] : kNoPlane;
  }
  [[nodiscard]] std::uint32_t material_of(std::uint32_t plane) const { return planes_[plane].material; }

  /// Weighted by area and light only.
  [[nodiscard]] const ImageChoice& from_anywhere() const { return from_anywhere_; }
  /// Weighted by the mirrored illuminance without obstacles.
  [[nodiscard]] ImageChoice seen_from(const Vec3& position_world_m, const Vec3& normal_world) const;

  struct ImagePoint {
    std::uint32_t plane = kNoPlane;  ///< kNoPlane = none could be drawn
    std::size_t place_of_lamp = 0;
    Vec3 position_world_m = Vec3::Zero(), normal_world = Vec3::UnitZ();  ///< towards the viewer
    double density_per_m2 = 0;                                           ///< including the probability of the image
  };
  /// A place on a plane near the image of a lamp; the plane may have no surface there.
  [[nodiscard]] ImagePoint draw(const ImageChoice& choice, const Vec3& from_world_m, double select, double u,
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
    double alpha;                              ///< of the drawn slopes
    double way_m;
  };
  void find_planes(const RayScene& scene);
  [[nodiscard]] std::optional<Image> image(const Plane& plane, std::size_t place_of_lamp,
                                           const Vec3& from_world_m) const;
  [[nodiscard]] static double density_per_m2(const Image& image, const Vec3& position_world_m);

  const EmitterSampler& lamps_;
  std::size_t places_;
  std::vector<Plane> planes_;
  std::vector<std::uint32_t> plane_of_;  ///< by triangle
  ImageChoice from_anywhere_;
};

}  // namespace luxrig
