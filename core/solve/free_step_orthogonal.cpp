#include <Eigen/QR>

#include "core/solve/free_step.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class OrthogonalStep final : public FreeStep {
 public:
  explicit OrthogonalStep(const LimitedLeastSquares& problem) : p_(problem) {
    // E = Q R once; afterwards only R and Qᵀ f are needed.
    const Eigen::HouseholderQR<MatrixXd> qr(p_.E);
    const Index n = p_.E.cols();
    const VectorXd turned = qr.householderQ().adjoint() * p_.f;
    r_ = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
    q_ = turned.head(n);
  }

  [[nodiscard]] double rate_tolerance() const override { return 1e-14; }

  [[nodiscard]] VectorXd gradient(const VectorXd& z) const override { return r_.transpose() * (r_ * z - q_); }

  /// argmin ‖gradient_F + G_WFᵀ λ‖ over the free variables.
  [[nodiscard]] VectorXd multipliers(const LimitedLeastSquaresResult& at, const VectorXd& gradient) const override {
    const std::vector<Index> free = free_variables(at.state);
    if (at.working_rows.empty() || free.empty()) return VectorXd::Zero(static_cast<Index>(at.working_rows.size()));
    const MatrixXd rows = p_.G(at.working_rows, free).transpose();
    const VectorXd part = -gradient(free);
    return rows.colPivHouseholderQr().solve(part);
  }

  VectorXd direction(LimitedLeastSquaresResult& at, const std::vector<Index>& free) override {
    const VectorXd rest = q_ - r_ * at.z;
    VectorXd whole = VectorXd::Zero(at.z.size());
    if (free.empty()) return whole;
    const MatrixXd objective = r_(Eigen::all, free);
    VectorXd part;
    if (at.working_rows.empty()) {
      part = objective.householderQr().solve(rest);
    } else {
      const MatrixXd rows = p_.G(at.working_rows, free).transpose();
      Eigen::ColPivHouseholderQR<MatrixXd> qr;
      qr.setThreshold(1e-12);
      qr.compute(rows);
      const Index rank = qr.rank();
      if (rank < rows.cols()) {  // rounding made rows dependent: those left over follow from the others
        std::vector<Index> kept;
        for (Index k = 0; k < rank; ++k)
          kept.push_back(at.working_rows[static_cast<std::size_t>(qr.colsPermutation().indices()[k])]);
        at.working_rows = std::move(kept);
      }
      const Index left = rows.rows() - rank;
      if (left == 0) return whole;
      const MatrixXd q = qr.householderQ();
      const MatrixXd null_space = q.rightCols(left);
      part = null_space * (objective * null_space).householderQr().solve(rest);
    }
    if (part.allFinite()) whole(free) = part;
    return whole;
  }

 private:
  const LimitedLeastSquares& p_;
  MatrixXd r_;
  VectorXd q_;
};

}  // namespace

std::unique_ptr<FreeStep> make_orthogonal_step(const LimitedLeastSquares& problem) {
  return std::make_unique<OrthogonalStep>(problem);
}

}  // namespace luxrig
