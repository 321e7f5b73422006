// Tables that are absurd but occur in files: dark rows and columns, values of very different size, narrow bands.
#include "core/photometry/sphere_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace luxrig {
namespace {

using Symmetry = SphereTable::Symmetry;

std::vector<double> ascending(std::mt19937_64& random, double from, double to) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> knots{from, to};
  const int inner = static_cast<int>(random() % 5);
  // Now and then very near another angle.
  for (int i = 0; i < inner; ++i) knots.push_back(from + (to - from) * std::pow(unit(random), random() % 2 ? 1 : 8));
  std::sort(knots.begin(), knots.end());
  knots.erase(std::unique(knots.begin(), knots.end(), [](double a, double b) { return b - a < 1e-6; }), knots.end());
  knots.back() = to;
  return knots;
}

/// Values over 200 orders of magnitude, with whole rows or columns dark.
std::vector<double> hostile_values(std::mt19937_64& random, std::size_t columns, std::size_t polars) {
  std::uniform_real_distribution<double> exponent(-188, 12);
  std::uniform_real_distribution<double> peak_exponent(-6, 12);
  std::vector<double> values(columns * polars);
  const std::size_t dark_row = random() % (2 * polars), dark_column = random() % (2 * columns);
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t p = 0; p < polars; ++p) {
      const bool dark = c == dark_column || p == dark_row || random() % 3 == 0;
      values[c * polars + p] = dark ? 0 : std::pow(10.0, random() % 2 ? exponent(random) : peak_exponent(random));
    }
  }
  values[random() % values.size()] = std::pow(10.0, peak_exponent(random));
  return values;
}

struct Range {
  double from, to;
};

Range azimuths(Symmetry symmetry) {
  switch (symmetry) {
    case Symmetry::quadrant:
      return {0, 0.5 * kPi};
    case Symmetry::half_0_180:
      return {0, kPi};
    case Symmetry::half_90_270:
      return {0.5 * kPi, 1.5 * kPi};
    case Symmetry::part:
      return {-0.4 * kPi, 0.3 * kPi};
    default:
      return {0, 2 * kPi};
  }
}

TEST(SphereTable, SamplesAnyTableEvenAtTheEdgesOfTheSquare) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr Symmetry kAll[] = {Symmetry::round,       Symmetry::quadrant, Symmetry::half_0_180,
                               Symmetry::half_90_270, Symmetry::none,     Symmetry::part};
  int drawn_from = 0;
  for (int round = 0; round < 3000; ++round) {
    const Symmetry symmetry = kAll[round % 6];
    const auto polar = ascending(random, random() % 2 ? 0 : 0.3, random() % 2 ? kPi : 1.2);
    const Range range = azimuths(symmetry);
    const auto azimuth = ascending(random, range.from, range.to);
    const std::size_t columns = symmetry == Symmetry::round ? 1 : azimuth.size();
    auto values = hostile_values(random, columns, polar.size());
    const SphereTable table(symmetry, polar, azimuth, values);
    ++drawn_from;
    for (int i = 0; i < 40; ++i) {
      const double u = i < 20 ? (i % 5) / 4.0 : unit(random);
      const double v = i < 20 ? (i / 5) / 3.0 : unit(random);
      const auto [direction, value] = table.sample(u, v);
      ASSERT_NEAR(direction.norm(), 1, 1e-9) << "table " << round << " at " << u << ", " << v;
      ASSERT_GE(value, 0);
      ASSERT_LE(value, table.largest() * (1 + 1e-12));
      if (i < 20) continue;
      // They differ only by the rounding of the direction's angles, which a steep neighbour magnifies.
      ASSERT_NEAR(table.at(direction), value, 1e-6 * table.largest()) << "table " << round << " at " << u << ", " << v;
    }
  }
  EXPECT_EQ(drawn_from, 3000);
}

// A table with very different values: the share of directions drawn in the bright half equals its share of the flux.
TEST(SphereTable, SamplesTheBrightHalfByItsShareOfTheFlux) {
  const SphereTable table(Symmetry::none, {0, 0.25 * kPi, 0.5 * kPi}, {0, kPi, 2 * kPi},
                          {1e12, 1, 0, 3e-40, 0, 0, 1e12, 1, 0});
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr int kDraws = 100'000;
  int seen = 0;
  for (int i = 0; i < kDraws; ++i) seen += table.sample(unit(random), unit(random)).direction.x() > 0;
  // By azimuth the value falls linearly from 0 to π and rises again: three quarters of the flux lie where x > 0.
  EXPECT_NEAR(seen, 0.75 * kDraws, 5 * std::sqrt(kDraws * 0.75 * 0.25));
}

}  // namespace
}  // namespace luxrig
