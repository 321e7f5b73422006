#pragma once
/// Reflection of a surface: a diffuse body under a rough glossy coat.
///
/// f(i, o) = ρ/π (1 - Es(i)) (1 - Es(o)) / (1 - Ēs)  +  D(h) F(i·h) G(i, o) / (4 cos i cos o)
///           +  Fm/π (1 - E1(i)) (1 - E1(o)) / (1 - Ē1)
///
/// The coat: GGX distribution D, height-correlated Smith G (B. Walter et al. 2007; E. Heitz 2014), F by Schlick from
/// the reflectance at normal incidence, equal for all colours. The last term is light that meets several facets of a
/// rough coat before it leaves (C. Kulla, A. Conty 2017): E1(o) is the share that one facet would reflect if each
/// reflected all, Ē1 its cosine-weighted mean, Fm = F̄² Ē1 / (1 - F̄ (1 - Ē1)) with the mean F̄ of F. So a rough metal
/// is as bright as a smooth one. Es(o) is the share of light from o that the coat reflects, by one or several facets,
/// Ēs its mean; the body gets the rest (C. Kelemen, L. Szirmay-Kalos 2001). So f is reciprocal, and the total
/// reflectance for o is Es(o) + ρ (1 - Es(o)), below 1 for ρ < 1.

#include <array>

#include "core/scene/scene.h"

namespace luxrig {

class Bsdf {
 public:
  explicit Bsdf(const Material& material);

  /// Of GGX; at least 0.05.
  [[nodiscard]] static double alpha_of(const Material& material);

  /// Without gloss f is ρ/π in all directions, and sampling is by the cosine.
  [[nodiscard]] bool matt() const { return specular_ <= 0; }
  [[nodiscard]] bool black() const { return matt() && !(body_rgb_.maxCoeff() > 0); }
  [[nodiscard]] const Vec3& body_rgb() const { return body_rgb_; }

  /// f [1/sr] by linear Rec. 709 primary. Both directions are unit and point away from the surface; f is zero unless
  /// both are on the side of `normal`.
  [[nodiscard]] Vec3 value(const Vec3& normal, const Vec3& out, const Vec3& in) const;

  /// Density [1/sr] with which sample() draws `in` when light leaves towards `out`.
  [[nodiscard]] double density(const Vec3& normal, const Vec3& out, const Vec3& in) const;

  struct Sample {
    Vec3 in = Vec3::UnitZ();
    Vec3 weight_rgb = Vec3::Zero();  ///< f cosθ / density; zero if nothing could be drawn
    double density_per_sr = 0;
  };
  /// Incoming direction of light that leaves towards `out`.
  /// lobe   0…1, chooses between body and coat; not used when matt
  [[nodiscard]] Sample sample(const Vec3& normal, const Vec3& out, double u, double v, double lobe) const;

  /// Es(cosθ), and the share of samples that go to the coat's facets there.
  [[nodiscard]] double coat_albedo(double cosine) const;
  [[nodiscard]] double coat_share(double cosine) const;

 private:
  static constexpr std::size_t kSteps = 64;
  using Table = std::array<double, kSteps + 1>;  ///< even steps over the root of the cosine: finer at grazing angles
  [[nodiscard]] static double at(const Table& table, double cosine);
  [[nodiscard]] static double mean_of(const Table& table);
  [[nodiscard]] double coat(double cos_in, double cos_out, double cos_half, double in_half) const;

  Vec3 body_rgb_;
  double specular_ = 0, alpha_ = 1;
  double per_body_ = 0;                    ///< 1 / (π (1 - Ēs))
  double mean_missing_ = 0, several_ = 0;  ///< 1 - Ē1, and Fm / (1 - Ē1)
  Table albedo_{};                         ///< Es
  Table missing_{};                        ///< 1 - E1
};

/// Tangents of a unit normal, without a branch (T. Duff et al., JCGT 6(1), 2017).
struct Frame {
  Vec3 tangent, bitangent, normal;
  explicit Frame(const Vec3& n);
  [[nodiscard]] Vec3 world(const Vec3& local) const {
    return local.x() * tangent + local.y() * bitangent + local.z() * normal;
  }
  [[nodiscard]] Vec3 local(const Vec3& world) const {
    return {tangent.dot(world), bitangent.dot(world), normal.dot(world)};
  }
};

/// Maps the unit square to the unit disk (concentric map of P. Shirley and K. Chiu, 1997, which preserves strata).
[[nodiscard]] Eigen::Vector2d concentric_disk(double u, double v);

/// Direction in the hemisphere about `normal_world`, with density cosθ/π.
[[nodiscard]] Vec3 cosine_direction(const Vec3& normal_world, double u, double v);

}  // namespace luxrig
