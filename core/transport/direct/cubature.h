#pragma once
/// Adaptive integration over rectangles.
///
/// Products of Gauss rules of 3, 5 and 8 nodes per side. A piece is evaluated with 3 and 5, then with 8, then halved
/// along the side whose highest Legendre coefficients are larger, so that a kink parallel to the other side is isolated
/// cheaply. Its error is the larger of two estimates, since either may be small by chance: the difference to the next
/// lower rule (10 times that between 3 and 5 nodes), and an extrapolation of the highest coefficients h, summed without
/// sign, at their rate of fall to degree 2n, the first that a rule of n nodes misses: |f| (h/|f|)^(2n/(n-1)).

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace luxrig {

/// Gauss–Legendre on [-1, 1].
template <std::size_t N>
struct GaussRule {
  std::array<double, N> place, weight;
};
inline constexpr GaussRule<3> kGauss3 = {{-0.7745966692414834, 0, 0.7745966692414834},
                                         {0.5555555555555556, 0.8888888888888888, 0.5555555555555556}};
inline constexpr GaussRule<5> kGauss5 = {
    {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831, 0.9061798459386640},
    {0.2369268850561891, 0.4786286704993665, 0.5688888888888889, 0.4786286704993665, 0.2369268850561891}};
inline constexpr GaussRule<8> kGauss8 = {
    {-0.9602898564975363, -0.7966664774136267, -0.5255324099163290, -0.1834346424956498, 0.1834346424956498,
     0.5255324099163290, 0.7966664774136267, 0.9602898564975363},
    {0.1012285362903763, 0.2223810344533745, 0.3137066458778873, 0.3626837833783620, 0.3626837833783620,
     0.3137066458778873, 0.2223810344533745, 0.1012285362903763}};

struct CubatureResult {
  double value = 0;
  double error = 0;  ///< estimated bound of |value - integral|
  std::size_t evaluations = 0;
};

/// The rectangle [t0, t1] × [w0, w1] under one of the functions.
struct CubaturePiece {
  std::size_t function = 0;
  double t0 = 0, t1 = 1, w0 = 0, w1 = 1;
  double value = 0, error = 0;
  bool by_eight = false;  ///< evaluated with 8 nodes per side
  bool split_t = true;
};

namespace cubature {

/// w P and P / |P|², for the two highest Legendre polynomials that N nodes can distinguish, one even and one odd.
template <std::size_t N>
struct HighWeights {
  explicit HighWeights(const GaussRule<N>& rule) {
    for (std::size_t i = 0; i < N; ++i) {
      double before = 1, now = rule.place[i];  // Pₖ₋₁, Pₖ by Bonnet's recursion
      for (std::size_t k = 1; k + 2 < N; ++k) {
        const auto d = static_cast<double>(k);
        before = std::exchange(now, ((2 * d + 1) * rule.place[i] * now - d * before) / (d + 1));
      }
      const auto d = static_cast<double>(N - 2);
      lower[i] = rule.weight[i] * now * (d + 0.5);
      upper[i] = rule.weight[i] * (((2 * d + 1) * rule.place[i] * now - d * before) / (d + 1)) * (d + 1.5);
    }
  }
  std::array<double, N> lower, upper;
};

template <std::size_t N, class F>
double product_rule(const GaussRule<N>& rule, const CubaturePiece& piece, F&& f) {
  const double t = 0.5 * (piece.t0 + piece.t1), w = 0.5 * (piece.w0 + piece.w1);
  const double a = 0.5 * (piece.t1 - piece.t0), b = 0.5 * (piece.w1 - piece.w0);
  double sum = 0;
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j)
      sum += rule.weight[i] * rule.weight[j] * f(t + a * rule.place[i], w + b * rule.place[j], i, j);
  return a * b * sum;
}

/// Evaluates a piece with N nodes per side; sets value, error from the coefficients, and the side to halve.
template <std::size_t N, class F>
void look(const GaussRule<N>& rule, CubaturePiece& piece, F&& f) {
  static const HighWeights<N> high(rule);
  std::array<double, N> lower_t{}, lower_w{}, upper_t{}, upper_w{};
  double size = 0;
  piece.value = product_rule(rule, piece, [&](double t, double w, std::size_t i, std::size_t j) {
    const double value = f(piece.function, t, w);
    lower_t[j] += high.lower[i] * value;
    upper_t[j] += high.upper[i] * value;
    lower_w[i] += high.lower[j] * value;
    upper_w[i] += high.upper[j] * value;
    size += rule.weight[i] * rule.weight[j] * std::abs(value);
    return value;
  });
  size *= 0.5;  // like the sums below, over one side of length 2
  double bend_t = 0, bend_w = 0;
  for (std::size_t i = 0; i < N; ++i) {
    bend_t += rule.weight[i] * (std::abs(lower_t[i]) + std::abs(upper_t[i]));
    bend_w += rule.weight[i] * (std::abs(lower_w[i]) + std::abs(upper_w[i]));
  }
  piece.split_t = bend_t >= bend_w;
  constexpr double kPower = 2.0 * N / (N - 1);
  const double area = (piece.t1 - piece.t0) * (piece.w1 - piece.w0);
  piece.error = size > 0 ? 0.5 * area * size * std::pow(std::min(1.0, std::max(bend_t, bend_w) / size), kPower) : 0;
}

template <class F>
void look_with_five(CubaturePiece& piece, F&& f) {
  const double by_three = product_rule(
      kGauss3, piece, [&](double t, double w, std::size_t, std::size_t) { return f(piece.function, t, w); });
  look(kGauss5, piece, f);
  piece.error = std::max(piece.error, 10 * std::abs(piece.value - by_three));
  piece.by_eight = false;
}

template <class F>
void look_with_eight(CubaturePiece& piece, F&& f) {
  const double by_five = piece.value;
  look(kGauss8, piece, f);
  piece.error = std::max(piece.error, std::abs(piece.value - by_five));
  piece.by_eight = true;
}

}  // namespace cubature

/// Sum of the integrals of f(function, t, w) over `pieces`, until the estimated error is below `wanted_relative` of the
/// value or `max_evaluations` are used. `pieces` also serves as working memory.
template <class F>
CubatureResult integrate_pieces(std::vector<CubaturePiece>& pieces, double wanted_relative, std::size_t max_evaluations,
                                F&& f) {
  CubatureResult result;
  const auto less = [](const CubaturePiece& a, const CubaturePiece& b) { return a.error < b.error; };
  const auto sum = [&] {  // in full each time: differences would accumulate rounding
    result.value = result.error = 0;
    for (const CubaturePiece& piece : pieces) {
      result.value += piece.value;
      result.error += piece.error;
    }
  };
  for (CubaturePiece& piece : pieces) cubature::look_with_five(piece, f);
  result.evaluations = pieces.size() * 34;
  std::make_heap(pieces.begin(), pieces.end(), less);
  sum();
  while (!pieces.empty() && result.error > wanted_relative * std::abs(result.value) &&
         result.evaluations < max_evaluations) {
    double error_left = result.error;  // accurate enough to know when to sum again
    do {
      std::pop_heap(pieces.begin(), pieces.end(), less);
      CubaturePiece& worst = pieces.back();
      error_left -= worst.error;
      if (!worst.by_eight) {
        cubature::look_with_eight(worst, f);
        result.evaluations += 64;
        error_left += worst.error;
        std::push_heap(pieces.begin(), pieces.end(), less);
        continue;
      }
      CubaturePiece second = worst;
      (worst.split_t ? worst.t1 : worst.w1) = (worst.split_t ? second.t0 : second.w0) =
          worst.split_t ? 0.5 * (worst.t0 + worst.t1) : 0.5 * (worst.w0 + worst.w1);
      cubature::look_with_five(worst, f);
      cubature::look_with_five(second, f);
      result.evaluations += 68;
      error_left += worst.error + second.error;
      std::push_heap(pieces.begin(), pieces.end(), less);
      pieces.push_back(second);
      std::push_heap(pieces.begin(), pieces.end(), less);
    } while (error_left > wanted_relative * std::abs(result.value) && result.evaluations < max_evaluations);
    sum();
  }
  return result;
}

}  // namespace luxrig
