#pragma once
/// Problems for `luxrig bench nnls`, also written for compare-with-scipy.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/solve/least_squares/nnls.h"

namespace luxrig {

struct NnlsBenchProblem {
  std::string name;
  Eigen::Index rows = 0;
  std::vector<std::uint64_t> begin = {0};
  std::vector<std::uint32_t> row;
  std::vector<float> value;
  Eigen::VectorXd goal;

  [[nodiscard]] Eigen::Index columns() const { return static_cast<Eigen::Index>(begin.size()) - 1; }
  [[nodiscard]] NnlsProblem problem() const {
    return {ColumnsView(rows, begin, row, std::span<const float>(value)), goal, {}, {}};
  }
};

/// Entries uniformly random in (0, 1), with the given share not zero; goals uniformly random: no column is like
/// another.
[[nodiscard]] NnlsBenchProblem random_nnls(Eigen::Index rows, Eigen::Index columns, double share);

/// Lamps uniformly random above a floor of points. Each reaches about `share` of them by the inverse square law. Goals
/// are the light of ten lamps that are not among the columns, with 5 % noise: many columns are nearly alike.
[[nodiscard]] NnlsBenchProblem lamps_nnls(Eigen::Index rows, Eigen::Index columns, double share);

/// Little-endian: rows, columns, entries (int64 each), begin (uint64), row (uint32), value (float), goal (double).
/// False if it could not be written.
[[nodiscard]] bool write_nnls(const NnlsBenchProblem& problem, const std::filesystem::path& file);

}  // namespace luxrig
