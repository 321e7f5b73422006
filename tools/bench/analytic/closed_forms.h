#pragma once
/// Form factors from a small plane element to finite surfaces, in closed form: a surface of uniform luminance L gives
/// the element E = π L F. (J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors: B-4, B-5, B-12,
/// B-13, B-43.)

#include <vector>

#include "core/geometry.h"

namespace luxrig {

/// Disk of radius r parallel to the element. The element is at distance h from its plane, a off its axis.
[[nodiscard]] double form_factor_of_parallel_disk(double r_m, double h_m, double a_m);

/// Disk at right angles to the element. The element is a > 0 off the disk's axis and h below its plane, and faces the
/// axis.
[[nodiscard]] double form_factor_of_perpendicular_disk(double r_m, double h_m, double a_m);

/// Rectangle of a by b parallel to the element, which is h below one of its corners.
[[nodiscard]] double form_factor_of_parallel_rectangle(double a_m, double b_m, double h_m);

/// Rectangle of a by b at right angles to the element. The element is h below one end of a side of length a and faces
/// along b, over the rectangle.
[[nodiscard]] double form_factor_of_perpendicular_rectangle(double a_m, double b_m, double h_m);

/// Sphere of radius r at distance d > r, at angle θ off the element's normal; also if the horizon cuts it.
[[nodiscard]] double form_factor_of_sphere(double r_m, double d_m, double theta_rad);

/// Nodes and weights of Gauss-Legendre quadrature on [-1, 1].
struct GaussNodes {
  std::vector<double> nodes, weights;
};
[[nodiscard]] GaussNodes gauss_rule(int count);

/// ∫∫ f over [a, b] × [c, d], with `count` nodes each way; f(x, y).
template <class F>
[[nodiscard]] double integral(const GaussNodes& rule, double a, double b, double c, double d, F&& f) {
  double sum = 0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i)
    for (std::size_t j = 0; j < rule.nodes.size(); ++j)
      sum += rule.weights[i] * rule.weights[j] *
             f((a + b) / 2 + (b - a) / 2 * rule.nodes[i], (c + d) / 2 + (d - c) / 2 * rule.nodes[j]);
  return sum * (b - a) * (d - c) / 4;
}

}  // namespace luxrig
