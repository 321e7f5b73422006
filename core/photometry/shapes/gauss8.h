#pragma once
/// Gauss–Legendre quadrature with 8 points: exact for polynomials up to degree 15.

#include <array>
#include <cstddef>

namespace luxrig {

/// ∫ f dx over [from, to].
template <class F>
double gauss8(const F& f, double from, double to) {
  constexpr std::array<double, 4> kAbscissa = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                               0.9602898564975363};
  constexpr std::array<double, 4> kShare = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                            0.1012285362903763};
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  double sum = 0;
  for (std::size_t i = 0; i < kAbscissa.size(); ++i)
    sum += kShare[i] * (f(middle - half * kAbscissa[i]) + f(middle + half * kAbscissa[i]));
  return sum * half;
}

}  // namespace luxrig
