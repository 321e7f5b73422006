#include "core/transport/replicate_error.h"

#include <cmath>

namespace luxrig {

double student_t_975(double degrees_of_freedom) {
  const double z = 1.959963984540054, v = degrees_of_freedom;
  const double z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4 * v) + (5 * z5 + 16 * z3 + 3 * z) / (96 * v * v) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * v * v * v);
}

double standard_error_of_mean(std::span<const double> estimates) {
  const auto n = static_cast<double>(estimates.size());
  double mean = 0;
  for (const double e : estimates) mean += e / n;
  double squares = 0;
  for (const double e : estimates) squares += (e - mean) * (e - mean);
  return std::sqrt(squares / (n * (n - 1))) * student_t_975(n - 1) / 1.959963984540054;
}

}  // namespace luxrig
