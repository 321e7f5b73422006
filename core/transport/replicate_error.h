#pragma once
/// The error of a mean of few independent estimates.

#include <span>

namespace luxrig {

/// Standard error of the mean of n ≥ 2 independent estimates, widened for small n: the spread of 16 numbers is itself
/// uncertain by 18 %, so ±1.96 plain standard errors cover less than 95 %. The plain error is multiplied by t(0.975,
/// n-1) / 1.96 (Student; 1.09 for n = 16), so that ±1.96 of the returned errors cover 95 % of normal estimates.
[[nodiscard]] double standard_error_of_mean(std::span<const double> estimates);

/// Quantile of Student's t distribution at 0.975 for ν ≥ 3 degrees of freedom, to 1 % (Cornish–Fisher expansion,
/// Abramowitz and Stegun 26.7.5).
[[nodiscard]] double student_t_975(double degrees_of_freedom);

}  // namespace luxrig
