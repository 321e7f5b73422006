#include "tools/bench/analytic/closed_forms.h"

#include <algorithm>
#include <cmath>

namespace luxrig {

double form_factor_of_parallel_disk(double r, double h, double a) {
  const double z = r * r + h * h + a * a;
  // 1 + (r² - h² - a²)/root, without the cancellation for a small disk: root² - (z - 2r²)² = 4 h² r².
  const double root = std::sqrt(z * z - 4 * a * a * r * r), rest = z - 2 * r * r;
  return rest > 0 ? 2 * h * h * r * r / (root * (root + rest)) : 0.5 * (1 - rest / root);
}

double form_factor_of_perpendicular_disk(double r, double h, double a) {
  const double z = r * r + h * h + a * a, root = std::sqrt(z * z - 4 * a * a * r * r);
  return h / (2 * a) * 4 * a * a * r * r / (root * (z + root));
}

double form_factor_of_parallel_rectangle(double a, double b, double h) {
  const double ra = std::hypot(a, h), rb = std::hypot(b, h);
  return (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / (2 * kPi);
}

double form_factor_of_perpendicular_rectangle(double a, double b, double h) {
  const double rb = std::hypot(b, h);
  return (std::atan(a / h) - h / rb * std::atan(a / rb)) / (2 * kPi);
}

double form_factor_of_sphere(double r, double d, double theta) {
  const double h = d / r, cosine = std::cos(theta), sine = std::sin(theta);
  if (h * cosine >= 1) return cosine / (h * h);
  if (h * cosine <= -1) return 0;
  const double root = std::sqrt(h * h - 1);
  return 0.5 - std::asin(std::min(1.0, root / (h * sine))) / kPi +
         (cosine * std::acos(std::clamp(-root * cosine / sine, -1.0, 1.0)) -
          root * std::sqrt(std::max(0.0, 1 - h * h * cosine * cosine))) /
             (kPi * h * h);
}

GaussNodes gauss_rule(int count) {
  GaussNodes rule;
  for (int i = 0; i < count; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      double p = 1, before = 0;
      for (int n = 1; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * p - (n - 1) * before) / n;
        before = p, p = next;
      }
      slope = count * (x * p - before) / (x * x - 1);
      const double change = p / slope;
      x -= change;
      if (std::abs(change) < 1e-15) break;
    }
    rule.nodes.push_back(x);
    rule.weights.push_back(2 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace luxrig
