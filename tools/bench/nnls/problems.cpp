#include "tools/bench/nnls/problems.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <random>

namespace luxrig {
namespace {

class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : random_(seed) {}
  double operator()() { return static_cast<double>((random_() >> 11) + 1) * 0x1p-53; }

 private:
  std::mt19937_64 random_;
};

void put(NnlsBenchProblem& p, Eigen::Index row, double value) {
  p.row.push_back(static_cast<std::uint32_t>(row));
  p.value.push_back(static_cast<float>(value));
}

}  // namespace

NnlsBenchProblem random_nnls(Eigen::Index rows, Eigen::Index columns, double share) {
  NnlsBenchProblem p;
  p.name = fmt::format("random-{}x{}", rows, columns);
  p.rows = rows;
  Uniform uniform(1);
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i)
      if (uniform() <= share) put(p, i, uniform());
    p.begin.push_back(p.row.size());
  }
  p.goal.resize(rows);
  for (double& lux : p.goal) lux = uniform();
  return p;
}

NnlsBenchProblem lamps_nnls(Eigen::Index rows, Eigen::Index columns, double share) {
  NnlsBenchProblem p;
  p.name = fmt::format("lamps-{}x{}", rows, columns);
  p.rows = rows;
  Uniform uniform(2);
  Eigen::MatrixXd point(2, rows);
  for (double& at : point.reshaped()) at = uniform();
  const double reach = share / 3.14159265358979323846, height = 0.1;
  const auto lamp = [&](const auto& take) {
    const double x = uniform(), y = uniform();
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double d2 = (point(0, i) - x) * (point(0, i) - x) + (point(1, i) - y) * (point(1, i) - y);
      if (d2 <= reach) take(i, 100 * height / std::pow(d2 + height * height, 1.5));
    }
  };
  for (Eigen::Index j = 0; j < columns; ++j) {
    lamp([&](Eigen::Index i, double lux) { put(p, i, lux); });
    p.begin.push_back(p.row.size());
  }
  p.goal = Eigen::VectorXd::Zero(rows);
  for (int k = 0; k < 10; ++k) lamp([&](Eigen::Index i, double lux) { p.goal[i] += 0.03 * lux; });
  for (double& lux : p.goal) lux *= 0.95 + 0.1 * uniform();
  return p;
}

bool write_nnls(const NnlsBenchProblem& problem, const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  const auto write = [&](const void* data, std::size_t bytes) {
    out.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  };
  const std::int64_t sizes[3] = {problem.rows, problem.columns(), static_cast<std::int64_t>(problem.row.size())};
  write(sizes, sizeof sizes);
  write(problem.begin.data(), problem.begin.size() * sizeof problem.begin[0]);
  write(problem.row.data(), problem.row.size() * sizeof problem.row[0]);
  write(problem.value.data(), problem.value.size() * sizeof problem.value[0]);
  write(problem.goal.data(), static_cast<std::size_t>(problem.goal.size()) * sizeof problem.goal[0]);
  out.close();
  return static_cast<bool>(out);
}

}  // namespace luxrig
