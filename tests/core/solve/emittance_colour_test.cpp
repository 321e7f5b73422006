// Goals with colour and a limit on power, compared with closed forms and with all active sets.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "core/photometry/light_colour.h"
#include "core/solve/emittance.h"
#include "tests/random.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const double kNoLimit = std::numeric_limits<double>::infinity();

/// Lights of these colours that give `lux` at the points.
EmittanceProblem coloured_problem(const MatrixXd& lux, const std::vector<Vec3>& colours) {
  EmittanceProblem p;
  p.lux_per_level = lux;
  p.rgb_per_level.assign(3, lux);
  for (Index j = 0; j < lux.cols(); ++j)
    for (Index c = 0; c < 3; ++c)
      p.rgb_per_level[static_cast<std::size_t>(c)].col(j) *= colours[static_cast<std::size_t>(j)][c];
  p.goal_rgb = MatrixXd::Ones(lux.rows(), 3);
  return p;
}

Vec3 rgb_at(const EmittanceProblem& p, Index point, const VectorXd& level) {
  Vec3 rgb = p.fixed_rgb.size() > 0 ? Vec3(p.fixed_rgb.row(point).transpose()) : Vec3::Zero();
  for (Index c = 0; c < 3; ++c) rgb[c] += p.rgb_per_level[static_cast<std::size_t>(c)].row(point).dot(level);
  return rgb;
}

const std::vector<Vec3> kRgbLeds = {within_rec709(rgb_of_xy({0.62, 0.34})).rgb,
                                    within_rec709(rgb_of_xy({0.31, 0.58})).rgb,
                                    within_rec709(rgb_of_xy({0.16, 0.08})).rgb};

// Three emitters and one point: the levels are the solution of a 3 × 3 system, and the chromaticity is met exactly.
TEST(EmittanceColour, ThreeEmittersMixAnyColourBetweenThem) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 lux(random.between(100, 400), random.between(100, 400), random.between(100, 400));
    EmittanceProblem p = coloured_problem(lux.transpose(), kRgbLeds);
    Mat3 columns;
    for (Index j = 0; j < 3; ++j) columns.col(j) = lux[j] * kRgbLeds[static_cast<std::size_t>(j)];
    const Vec3 mixed = columns * Vec3(random.between(0.05, 0.9), random.between(0.05, 0.9), random.between(0.05, 0.9));
    p.goal_lx = VectorXd::Constant(1, luminance_of_rgb(mixed));
    p.goal_rgb = (mixed / luminance_of_rgb(mixed)).transpose();
    const auto solution = solve_emittance(p);
    ASSERT_TRUE(solution) << solution.error().detail;
    EXPECT_NEAR((solution->level - columns.colPivHouseholderQr().solve(mixed)).norm(), 0, 1e-6);
    EXPECT_NEAR((xy_of_rgb(rgb_at(p, 0, solution->level)) - xy_of_rgb(mixed)).norm(), 0, 1e-7);
    EXPECT_LE(solution->normalised_error, 1e-7);
    EXPECT_LE(solution->kkt_residual, 1e-8);
    EXPECT_EQ(solution->points[0].reason, "");
  }
}

// White light and white goals: same result as without colour, for single goals and with limits.
TEST(EmittanceColour, InWhiteMatchesTheResultWithoutColour) {
  Random random(2);
  for (int trial = 0; trial < 30; ++trial) {
    const Index points = 6, lights = 4;
    MatrixXd lux(points, lights);
    for (double& v : lux.reshaped()) v = random.between(0, 100);
    EmittanceProblem grey;
    grey.lux_per_level = lux;
    grey.goal_lx.resize(points);
    for (double& v : grey.goal_lx) v = random.between(50, 200);
    grey.max_lx = VectorXd::Constant(points, 130);
    grey.fixed_lx = VectorXd::Constant(points, random.between(0, 60));
    grey.weight.resize(points);
    for (double& v : grey.weight) v = random.between(0.5, 2);
    EmittanceProblem coloured = coloured_problem(lux, std::vector<Vec3>(4, Vec3::Ones()));
    coloured.goal_lx = grey.goal_lx;
    coloured.max_lx = grey.max_lx;
    coloured.weight = grey.weight;
    coloured.fixed_lx = grey.fixed_lx;
    coloured.fixed_rgb = grey.fixed_lx * Eigen::RowVector3d::Ones();
    const auto one = solve_emittance(grey), other = solve_emittance(coloured);
    ASSERT_TRUE(one && other);
    EXPECT_NEAR((one->level - other->level).norm(), 0, 1e-8);
    EXPECT_NEAR(one->normalised_error, other->normalised_error, 1e-9);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(one->points[i].binding, other->points[i].binding);
  }
}

/// W T and W g of the colour problem, as defined in the header.
void rows_of(const EmittanceProblem& p, MatrixXd& A, VectorXd& b) {
  const Index points = p.lux_per_level.rows();
  A.resize(3 * points, p.lux_per_level.cols());
  b.resize(3 * points);
  for (Index i = 0; i < points; ++i)
    for (Index c = 0; c < 3; ++c) {
      A.row(3 * i + c) = p.rgb_per_level[static_cast<std::size_t>(c)].row(i) / std::sqrt(3.0);
      b[3 * i + c] = p.goal_lx[i] * p.goal_rgb(i, c) / std::sqrt(3.0);
    }
}

/// Least ‖A x − b‖² with each x at 0, at 1 or free, and the power limit (if any) active or not.
double best_of_all_active_sets(const MatrixXd& A, const VectorXd& b, const VectorXd& watts, double max_watts) {
  const Index n = A.cols();
  double best = b.squaredNorm();
  int sets = 1;
  for (Index j = 0; j < n; ++j) sets *= 3;
  for (int set = 0; set < sets; ++set)
    for (const bool tight : {false, true}) {
      VectorXd x = VectorXd::Zero(n);
      std::vector<Index> free;
      int rest = set;
      for (Index j = 0; j < n; ++j, rest /= 3) {
        if (rest % 3 == 1) x[j] = 1;
        if (rest % 3 == 2) free.push_back(j);
      }
      if (tight && (free.empty() || !std::isfinite(max_watts))) continue;
      const auto m = static_cast<Index>(free.size());
      if (m > 0) {
        // [AᵀA p; pᵀ 0] [x; λ] = [Aᵀr; P − p·fixed]
        const MatrixXd F = A(Eigen::all, free);
        MatrixXd K = MatrixXd::Zero(m + tight, m + tight);
        VectorXd r = VectorXd::Zero(m + tight);
        K.topLeftCorner(m, m) = F.transpose() * F;
        r.head(m) = F.transpose() * (b - A * x);
        if (tight) {
          K.topRightCorner(m, 1) = watts(free);
          K.bottomLeftCorner(1, m) = watts(free).transpose();
          r[m] = max_watts - watts.dot(x);
        }
        const VectorXd y = K.fullPivLu().solve(r);
        for (Index k = 0; k < m; ++k) x[free[static_cast<std::size_t>(k)]] = y[k];
      }
      constexpr double kSlack = 1e-9;
      if (x.minCoeff() < -kSlack || x.maxCoeff() > 1 + kSlack || watts.dot(x) > max_watts + kSlack) continue;
      best = std::min(best, (A * x - b).squaredNorm());
    }
  return best;
}

TEST(EmittanceColour, IsTheBestOfAllActiveSetsWithAndWithoutAPowerLimit) {
  Random random(3);
  int limited = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Index points = 2, lights = 5;
    MatrixXd lux(points, lights);
    for (double& v : lux.reshaped()) v = random.between(5, 100);
    std::vector<Vec3> colours;
    for (Index j = 0; j < lights; ++j)
      colours.push_back(*with_luminance_1({random.between(0, 1), random.between(0, 1), random.between(0, 1)}));
    EmittanceProblem p = coloured_problem(lux, colours);
    p.goal_lx.resize(points);
    for (double& v : p.goal_lx) v = random.between(40, 200);
    for (Index i = 0; i < points; ++i)
      p.goal_rgb.row(i) =
          with_luminance_1({random.between(0, 1), random.between(0, 1), random.between(0, 1)})->transpose();
    p.watts.resize(lights);
    for (double& v : p.watts) v = random.between(2, 20);
    p.max_watts = trial % 3 == 0 ? kNoLimit : random.between(2, 25);
    const auto solution = solve_emittance(p);
    ASSERT_TRUE(solution) << solution.error().detail;
    EXPECT_LE(solution->kkt_residual, 1e-8) << trial;
    EXPECT_LE(p.watts.dot(solution->level), p.max_watts) << trial;
    limited += p.watts.dot(solution->level) > p.max_watts * (1 - 1e-9);
    MatrixXd A;
    VectorXd b;
    rows_of(p, A, b);
    const double best = best_of_all_active_sets(A, b, p.watts, p.max_watts);
    const double got = (A * solution->level - b).squaredNorm();
    EXPECT_NEAR(got, best, 1e-7 * b.squaredNorm()) << trial;
  }
  EXPECT_GE(limited, 20) << "the limit must bind often for this to mean anything";
}

// Two lights that each light a point of their own, one at twice the power: minimise (100 a − 80)² + (100 b − 80)² with
// 10 a + 20 b ≤ 12. Lagrange: 100 (80 − 100 a) = 5 λ', 100 (80 − 100 b) = 10 λ' with 2 λ' for both: b = 2 a − 0.8,
// so 10 a + 40 a − 16 = 12: a = 0.56, b = 0.32.
TEST(EmittancePower, SharesTheLimitByLagrange) {
  EmittanceProblem p;
  p.lux_per_level = MatrixXd{{100, 0}, {0, 100}};
  p.goal_lx = VectorXd::Constant(2, 80);
  p.watts = Eigen::Vector2d(10, 20);
  p.max_watts = 12;
  p.point_name = {"left", "right"};
  const auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_NEAR(solution->level[0], 0.56, 1e-9);
  EXPECT_NEAR(solution->level[1], 0.32, 1e-9);
  EXPECT_EQ(solution->points[1].binding, Binding::power);
  EXPECT_EQ(solution->points[1].reason, "held at 32 lx by the limit of 12 W on power, goal 80 lx");
  p.max_watts = 24;  // exactly enough for the goals
  const auto enough = solve_emittance(p);
  ASSERT_TRUE(enough);
  EXPECT_NEAR(enough->level[0], 0.8, 1e-9);
  EXPECT_EQ(enough->points[0].reason, "");
  p.max_watts = 0;
  const auto none = solve_emittance(p);
  ASSERT_TRUE(none);
  EXPECT_EQ(none->level.norm(), 0);
  p.max_watts = -1;
  EXPECT_FALSE(solve_emittance(p));
  p.max_watts = 5;
  p.watts = Eigen::Vector2d(1, -1);
  EXPECT_FALSE(solve_emittance(p));
}

TEST(EmittanceColour, ReportsWhyAColourIsMissed) {
  // A warm and a cool white cannot make green light.
  EmittanceProblem p = coloured_problem(MatrixXd{{200, 200}}, {rgb_of_cct(2700), rgb_of_cct(6500)});
  p.goal_lx = VectorXd::Constant(1, 100);
  p.goal_rgb = rgb_of_xy({0.31, 0.57}).transpose();
  auto solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->points[0].binding, Binding::colour);
  EXPECT_NE(solution->points[0].reason.find("no mix of the lights that reach it comes nearer in colour"),
            std::string::npos)
      << solution->points[0].reason;
  EXPECT_NE(solution->points[0].reason.find("goal 100 lx of xy (0.310, 0.570)"), std::string::npos)
      << solution->points[0].reason;
  // Red at its highest level: the lux is right but the colour is wrong.
  p = coloured_problem(MatrixXd{{20, 200}}, {Vec3(kRgbLeds[0]), rgb_of_cct(4000)});
  p.light_name = {"par/red", "par/white"};
  p.goal_lx = VectorXd::Constant(1, 150);
  p.goal_rgb = ((50 * kRgbLeds[0] + 100 * rgb_of_cct(4000)) / 150).transpose();
  solution = solve_emittance(p);
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->points[0].binding, Binding::max_level);
  EXPECT_NE(solution->points[0].reason.find("the highest level of 'par/red'"), std::string::npos)
      << solution->points[0].reason;
}

TEST(EmittanceColour, RefusesInconsistentInput) {
  EmittanceProblem p = coloured_problem(MatrixXd{{20, 200}}, {Vec3(kRgbLeds[0]), rgb_of_cct(4000)});
  p.goal_lx = VectorXd::Constant(1, 150);
  ASSERT_TRUE(solve_emittance(p));
  const auto refused = [&](auto change) {
    EmittanceProblem changed = p;
    change(changed);
    return !solve_emittance(changed);
  };
  EXPECT_TRUE(refused([](EmittanceProblem& q) { q.rgb_per_level.pop_back(); }));
  EXPECT_TRUE(refused([](EmittanceProblem& q) { q.rgb_per_level[1].resize(2, 2); }));
  EXPECT_TRUE(refused([](EmittanceProblem& q) { q.goal_rgb(0, 1) = std::nan(""); }));
  EXPECT_TRUE(refused([](EmittanceProblem& q) { q.goal_rgb(0, 1) = -0.1; }));
  EXPECT_TRUE(refused([](EmittanceProblem& q) { q.goal_rgb.resize(0, 0); }));
  EXPECT_TRUE(refused([](EmittanceProblem& q) { q.fixed_rgb = MatrixXd::Zero(1, 2); }));
}

}  // namespace
}  // namespace luxrig
