#pragma once
/// View of the columns of a matrix: sparse in float or double, or dense. It offers only the operations that least
/// squares needs, so a matrix of 10⁸ entries is neither copied nor converted.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace luxrig {

/// The matrix must outlive the view and must not change. Every sum is in double and in a fixed order.
class ColumnsView {
 public:
  using Index = Eigen::Index;

  ColumnsView() = default;
  /// Column c has the entries from begin[c] to begin[c + 1], with rising rows (as in CandidateColumns).
  ColumnsView(Index rows, std::span<const std::uint64_t> begin, std::span<const std::uint32_t> row,
              std::span<const float> value);
  ColumnsView(Index rows, std::span<const std::uint64_t> begin, std::span<const std::uint32_t> row,
              std::span<const double> value);
  explicit ColumnsView(const Eigen::MatrixXd& dense);

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index columns() const { return columns_; }

  /// Empty, or the error: sizes that disagree, rows that do not rise or are out of range, entries that are not finite
  /// or too large to square. Reads everything once.
  [[nodiscard]] std::string complaint() const;
  static constexpr double kLargestEntry = 1e140;

  /// Σ_i a_ij vector_i
  [[nodiscard]] double dot(Index column, const double* vector) const;
  /// to += times · a_j
  void add(Index column, double times, double* to) const;
  void add(Index column, long double times, long double* to) const;
  /// to = 0 where the column has entries
  void clear(Index column, double* to) const;
  /// Non-zero entries of the column, by rising rows; replaces the contents of the vectors.
  void entries(Index column, std::vector<std::uint32_t>& rows, std::vector<double>& values) const;
  /// Σ_i weight_i a_ij²
  [[nodiscard]] double squared_norm(Index column, const double* weight) const;
  /// result_j = scale_j Σ_i a_ij vector_i for all columns: one pass over the matrix.
  void dot_all(const double* vector, const double* scale, double* result) const;

  static constexpr Index kTile = 8;
  /// For each column: result[kTile k … kTile k + 7] = Σ_i a_ij tile[kTile i … kTile i + 7]: its products with eight
  /// vectors at once, at little more than the cost of one.
  void dot_tile(std::span<const Index> columns, const double* tile, double* result) const;

 private:
  Index rows_ = 0, columns_ = 0;
  std::span<const std::uint64_t> begin_;
  std::span<const std::uint32_t> row_;
  std::span<const float> floats_;    ///< of a sparse matrix in float
  std::span<const double> doubles_;  ///< of a sparse matrix in double
  const double* dense_ = nullptr;
};

}  // namespace luxrig
