#include "core/transport/bsdf.h"

#include <algorithm>
#include <cmath>

#include "core/transport/sobol.h"

namespace luxrig {
namespace {

double smith_lambda(double cosine, double alpha) {
  const double c2 = cosine * cosine;
  return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - c2) / c2) - 1);
}

double ggx(double cos_half, double alpha) {
  const double a2 = alpha * alpha, t = cos_half * cos_half * (a2 - 1) + 1;
  return a2 / (kPi * t * t);
}

double schlick(double specular, double cosine) {
  const double m = std::clamp(1 - cosine, 0.0, 1.0);
  return specular + (1 - specular) * m * m * m * m * m;
}

/// Normal of a microfacet visible from `out`, drawn by visible area (E. Heitz, JCGT 7(4), 2018). Local frame, z up.
Vec3 visible_half(const Vec3& out, double alpha, double u, double v) {
  const Vec3 stretched = Vec3(alpha * out.x(), alpha * out.y(), out.z()).normalized();
  const double flat2 = stretched.x() * stretched.x() + stretched.y() * stretched.y();
  const Vec3 across = flat2 > 0 ? Vec3(Vec3(-stretched.y(), stretched.x(), 0) / std::sqrt(flat2)) : Vec3(Vec3::UnitX());
  const Vec3 along = stretched.cross(across);
  const double radius = std::sqrt(u), angle = 2 * kPi * v;
  const double a = radius * std::cos(angle);
  const double s = 0.5 * (1 + stretched.z());
  const double b = (1 - s) * std::sqrt(std::max(0.0, 1 - a * a)) + s * radius * std::sin(angle);
  const Vec3 half = a * across + b * along + std::sqrt(std::max(0.0, 1 - a * a - b * b)) * stretched;
  return Vec3(alpha * half.x(), alpha * half.y(), std::max(1e-9, half.z())).normalized();
}

}  // namespace

Frame::Frame(const Vec3& n) : normal(n) {
  const double sign = std::copysign(1.0, n.z());
  const double p = -1 / (sign + n.z()), q = n.x() * n.y() * p;
  tangent = {1 + sign * n.x() * n.x() * p, sign * q, -sign * n.x()};
  bitangent = {q, sign + n.y() * n.y() * p, -n.y()};
}

Eigen::Vector2d concentric_disk(double u, double v) {
  const double a = 2 * u - 1, b = 2 * v - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool wide = std::abs(a) > std::abs(b);
  const double radius = wide ? a : b;
  // Angles up to 45° from an axis: sine and cosine are short polynomials (to 1e-11, which is more than enough).
  const double angle = kPi / 4 * (wide ? b / a : a / b), x = angle * angle;
  const double sine = angle * (1 - x / 6 * (1 - x / 20 * (1 - x / 42 * (1 - x / 72 * (1 - x / 110)))));
  const double cosine = 1 - x / 2 * (1 - x / 12 * (1 - x / 30 * (1 - x / 56 * (1 - x / 90 * (1 - x / 132)))));
  return wide ? Eigen::Vector2d(radius * cosine, radius * sine) : Eigen::Vector2d(radius * sine, radius * cosine);
}

Vec3 cosine_direction(const Vec3& normal_world, double u, double v) {
  const Eigen::Vector2d d = concentric_disk(u, v);
  return Frame(normal_world).world({d.x(), d.y(), std::sqrt(std::max(0.0, 1 - d.squaredNorm()))}).normalized();
}

double Bsdf::alpha_of(const Material& material) {
  const double roughness = std::clamp(material.roughness, 0.05, 1.0);
  return roughness * roughness;
}

Bsdf::Bsdf(const Material& material) : body_rgb_(material.reflectance_rgb), specular_(material.specular_reflectance) {
  if (matt()) return;
  alpha_ = alpha_of(material);
  // Share reflected by one facet = mean over visible microfacets of F G2/G1: 1024 points give it to 1e-3.
  constexpr std::uint32_t kPoints = 1024;
  const SobolSequence points(0xc0a7);
  for (std::size_t i = 0; i <= kSteps; ++i) {
    const double root = static_cast<double>(i) / kSteps, cosine = std::max(1e-4, root * root);
    const Vec3 out(std::sqrt(1 - cosine * cosine), 0, cosine);
    double sum = 0, sum_of_all = 0;
    for (std::uint32_t k = 0; k < kPoints; ++k) {
      const auto [u, v] = points.pair(k, 0, 0);
      const Vec3 half = visible_half(out, alpha_, u, v);
      const double out_half = out.dot(half);
      const Vec3 in = 2 * out_half * half - out;
      if (in.z() <= 0) continue;
      const double lambda_out = smith_lambda(out.z(), alpha_), lambda_in = smith_lambda(in.z(), alpha_);
      const double seen = (1 + lambda_out) / (1 + lambda_out + lambda_in);
      sum += schlick(specular_, out_half) * seen;
      sum_of_all += seen;
    }
    albedo_[i] = sum / kPoints;
    missing_[i] = 1 - sum_of_all / kPoints;
  }
  mean_missing_ = mean_of(missing_);
  if (mean_missing_ > 1e-9) {
    const double mean_fresnel = specular_ + (1 - specular_) / 21;  // of Schlick's F, cosine-weighted
    several_ = mean_fresnel * mean_fresnel * (1 - mean_missing_) / (1 - mean_fresnel * mean_missing_) / mean_missing_;
  }
  for (std::size_t i = 0; i <= kSteps; ++i) albedo_[i] += several_ * mean_missing_ * missing_[i];
  const double of_body = 1 - mean_of(albedo_);
  per_body_ = of_body > 1e-9 ? 1 / (of_body * kPi) : 0;  // a coat that reflects all leaves the body nothing
}

double Bsdf::at(const Table& table, double cosine) {
  const double x = std::sqrt(std::clamp(cosine, 0.0, 1.0)) * kSteps;
  const std::size_t i = std::min(kSteps - 1, static_cast<std::size_t>(x));
  return table[i] + (x - static_cast<double>(i)) * (table[i + 1] - table[i]);
}

/// Cosine-weighted mean of the interpolated table, exactly: 4 ∫ E(t) t³ dt over each step, t the root of the cosine.
double Bsdf::mean_of(const Table& table) {
  double mean = 0;
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double h = 1.0 / kSteps, a = static_cast<double>(i) * h, slope = (table[i + 1] - table[i]) / h;
    const auto antiderivative = [&](double t) {
      return (table[i] - slope * a) * std::pow(t, 4) + 0.8 * slope * std::pow(t, 5);
    };
    mean += antiderivative(a + h) - antiderivative(a);
  }
  return mean;
}

double Bsdf::coat_albedo(double cosine) const { return matt() ? 0 : at(albedo_, cosine); }

double Bsdf::coat_share(double cosine) const {
  if (matt()) return 0;
  const double coat = at(albedo_, cosine), several = several_ * mean_missing_ * at(missing_, cosine);
  const double body = (1 - coat) * body_rgb_.maxCoeff();
  return (coat - several) / (coat + body);
}

double Bsdf::coat(double cos_in, double cos_out, double cos_half, double in_half) const {
  const double lambda = smith_lambda(cos_in, alpha_) + smith_lambda(cos_out, alpha_);
  return ggx(cos_half, alpha_) * schlick(specular_, in_half) / ((1 + lambda) * 4 * cos_in * cos_out);
}

Vec3 Bsdf::value(const Vec3& normal, const Vec3& out, const Vec3& in) const {
  const double cos_in = normal.dot(in), cos_out = normal.dot(out);
  if (!(cos_in > 0) || !(cos_out > 0)) return Vec3::Zero();
  if (matt()) return body_rgb_ / kPi;
  const Vec3 half = (in + out).normalized();
  const double body = (1 - at(albedo_, cos_in)) * (1 - at(albedo_, cos_out)) * per_body_;
  const double several = several_ * at(missing_, cos_in) * at(missing_, cos_out) / kPi;
  return body * body_rgb_ + Vec3::Constant(several + coat(cos_in, cos_out, normal.dot(half), in.dot(half)));
}

double Bsdf::density(const Vec3& normal, const Vec3& out, const Vec3& in) const {
  const double cos_in = normal.dot(in), cos_out = normal.dot(out);
  if (!(cos_in > 0) || !(cos_out > 0)) return 0;
  if (matt()) return cos_in / kPi;
  const double share = coat_share(cos_out);
  const Vec3 half = (in + out).normalized();
  // Density of the visible half vector D G1 (o·h) / cos o, by dh/di = 1 / (4 o·h).
  const double visible = ggx(normal.dot(half), alpha_) / ((1 + smith_lambda(cos_out, alpha_)) * 4 * cos_out);
  return share * visible + (1 - share) * cos_in / kPi;
}

Bsdf::Sample Bsdf::sample(const Vec3& normal, const Vec3& out, double u, double v, double lobe) const {
  Sample sample;
  if (matt()) {
    sample.in = cosine_direction(normal, u, v);
    sample.weight_rgb = body_rgb_;
    sample.density_per_sr = normal.dot(sample.in) / kPi;
    return sample;
  }
  if (lobe < coat_share(normal.dot(out))) {
    const Frame frame(normal);
    const Vec3 half = frame.world(visible_half(frame.local(out), alpha_, u, v));
    sample.in = (2 * out.dot(half) * half - out).normalized();
  } else {
    sample.in = cosine_direction(normal, u, v);
  }
  sample.density_per_sr = density(normal, out, sample.in);
  if (sample.density_per_sr > 0)
    sample.weight_rgb = value(normal, out, sample.in) * (normal.dot(sample.in) / sample.density_per_sr);
  return sample;
}

}  // namespace luxrig
