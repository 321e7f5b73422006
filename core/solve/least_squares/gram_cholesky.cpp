#include "core/solve/least_squares/gram_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns whose squared distance from the span of the others is below this are not factored again through L Lᵀ: they
/// would lose their digits. Rotations keep them.
constexpr double kMinPivotToFactor = 1e-4;

/// Rotates two columns of L into one another, moving the first up a row.
[[gnu::always_inline]] inline void rotated(double* first, double* second, double c, double s, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const double a = first[i + 1], b = second[i + 1];
    first[i] = c * a + s * b;
    second[i + 1] = c * b - s * a;
  }
}
void rotate_plain(double* first, double* second, double c, double s, std::size_t count) {
  rotated(first, second, c, s, count);
}
#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] void rotate_avx2(double* __restrict first, double* __restrict second, double c, double s,
                                             std::size_t count) {
  rotated(first, second, c, s, count);
}
#endif
void rotate(double* first, double* second, double c, double s, std::size_t count) {
#if defined(__x86_64__)
  static const bool wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (wide) return rotate_avx2(first, second, c, s, count);
#endif
  rotate_plain(first, second, c, s, count);
}

}  // namespace

void GramCholesky::reserve(Index size) {
  if (size <= l_.rows()) return;
  // Not a multiple of 512 bytes: columns that far apart would push one another out of the cache.
  Index wanted = std::max<Index>(size + size / 2, 12);
  if (wanted % 64 == 0) wanted += 8;
  MatrixXd larger(wanted, wanted);
  larger.topLeftCorner(size_, size_) = l_.topLeftCorner(size_, size_);
  l_.swap(larger);
}

std::vector<char> GramCholesky::append(MatrixXd& cross, MatrixXd& own, double min_pivot) {
  const Index p = size_, k = own.cols();
  std::vector<char> taken(static_cast<std::size_t>(k), 0);
  if (p > 0) {
    l_.topLeftCorner(p, p).triangularView<Eigen::Lower>().solveInPlace(cross);
    own.selfadjointView<Eigen::Lower>().rankUpdate(cross.transpose(), -1);
  }
  std::vector<Index> order;
  for (Index c = 0; c < k; ++c) {
    if (!(own(c, c) >= min_pivot)) continue;
    taken[static_cast<std::size_t>(c)] = 1;
    order.push_back(c);
    const Index below = k - c - 1;
    const double pivot = std::sqrt(own(c, c));
    own(c, c) = pivot;
    own.col(c).tail(below) /= pivot;
    for (Index j = c + 1; j < k; ++j) own.col(j).tail(k - j) -= own(j, c) * own.col(c).tail(k - j);
  }
  const auto more = static_cast<Index>(order.size());
  reserve(p + more);
  for (Index a = 0; a < more; ++a) {
    const Index from = order[static_cast<std::size_t>(a)];
    l_.row(p + a).head(p) = cross.col(from).transpose();
    for (Index b = 0; b <= a; ++b) l_(p + a, p + b) = own(from, order[static_cast<std::size_t>(b)]);
  }
  size_ += more;
  return taken;
}

void GramCholesky::append_row(const VectorXd& row, double pivot) {
  reserve(size_ + 1);
  l_.row(size_).head(size_) = row.transpose();
  l_(size_, size_) = pivot;
  ++size_;
}

void GramCholesky::remove(std::span<const Index> places) {
  if (places.empty()) return;
  const Index after = size_ - places.front();
  // Rotations pass once through the rest for each column; a new factorisation costs a third of a cube, but in blocks.
  if (after > 32 && 7 * static_cast<Index>(places.size()) > after && remove_by_factoring(places)) return;
  for (std::size_t k = places.size(); k-- > 0;) remove_by_rotation(places[k]);
}

void GramCholesky::remove_by_rotation(Index place) {
  for (Index k = 0; k < place; ++k) {
    double* column = &l_(0, k);
    std::copy(column + place + 1, column + size_, column + place);
  }
  for (Index k = place; k + 1 < size_; ++k) {
    const double a = l_(k + 1, k), b = l_(k + 1, k + 1);
    const double length = std::sqrt(a * a + b * b);
    if (length == 0) continue;
    rotate(&l_(k, k), &l_(k, k + 1), a / length, b / length, static_cast<std::size_t>(size_ - 1 - k));
  }
  --size_;
}

bool GramCholesky::remove_by_factoring(std::span<const Index> places) {
  const Index first = places.front(), behind = size_ - first;
  std::vector<Index> kept;
  std::size_t next = 0;
  for (Index row = first; row < size_; ++row) {
    if (next < places.size() && places[next] == row) {
      ++next;
      continue;
    }
    if (l_(row, row) * l_(row, row) < kMinPivotToFactor) return false;
    kept.push_back(row);
  }
  const auto left = static_cast<Index>(kept.size());
  MatrixXd rows(left, behind);
  for (Index c = 0; c < behind; ++c)
    for (Index a = 0; a < left; ++a) {
      const Index row = kept[static_cast<std::size_t>(a)];
      rows(a, c) = row >= first + c ? l_(row, first + c) : 0;
    }
  MatrixXd gram = MatrixXd::Zero(left, left);
  gram.selfadjointView<Eigen::Lower>().rankUpdate(rows);
  const Eigen::LLT<Eigen::Ref<MatrixXd>, Eigen::Lower> factor(gram);
  if (factor.info() != Eigen::Success) return false;
  for (Index k = 0; k < first; ++k)
    for (Index a = 0; a < left; ++a) l_(first + a, k) = l_(kept[static_cast<std::size_t>(a)], k);
  l_.block(first, first, left, left).triangularView<Eigen::Lower>() = gram;
  size_ = first + left;
  return true;
}

void GramCholesky::forward(VectorXd& vector) const {
  l_.topLeftCorner(size_, size_).triangularView<Eigen::Lower>().solveInPlace(vector);
}
void GramCholesky::backward(VectorXd& vector) const {
  l_.topLeftCorner(size_, size_).triangularView<Eigen::Lower>().transpose().solveInPlace(vector);
}

}  // namespace luxrig
