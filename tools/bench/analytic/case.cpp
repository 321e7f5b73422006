#include "tools/bench/analytic/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
AnalyticError error_of(const AnalyticCase& one, const TransportMatrix& matrix) {
  const Eigen::VectorXd levels = Eigen::VectorXd::Ones(matrix.emitters());
  const Eigen::VectorXd direct_lx = matrix.direct_lux(levels), all_lx = matrix.lux(levels);
  const double brightest_lx = *std::max_element(one.exact_lx.begin(), one.exact_lx.end());
  AnalyticError errors;
  for (Eigen::Index r = 0; r < matrix.receivers(); ++r) {
    const double exact_lx = one.exact_lx[static_cast<std::size_t>(r)];
    const double lux = one.part == AnalyticCase::Part::total    ? all_lx[r]
                       : one.part == AnalyticCase::Part::direct ? direct_lx[r]
                                                                : all_lx[r] - direct_lx[r];
    const double error = std::abs(lux - exact_lx) / std::max(exact_lx, 1e-3 * brightest_lx);
    if (std::isnan(error)) return {error, error};
    errors.worst = std::max(errors.worst, error);
    errors.rms += error * error;
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(std::max<Eigen::Index>(1, matrix.receivers())));
  return errors;
}

AnalyticCase with_receivers(AnalyticCase one, std::size_t most) {
  const std::size_t all = one.receivers.size();
  if (all <= most) return one;
  for (std::size_t k = 0; k < most; ++k) {
    const std::size_t from = (2 * k + 1) * all / (2 * most);
    one.receivers[k] = one.receivers[from];
    one.exact_lx[k] = one.exact_lx[from];
  }
  one.receivers.resize(most);
  one.exact_lx.resize(most);
  return one;
}

void measure_case(const AnalyticCase& one, const BenchOptions& options, std::vector<BenchRow>& rows) {
  const RayScene rays(one.scene);
  bool sampled = one.part == AnalyticCase::Part::direct;
  for (const Method& method : methods()) {
    if (one.reflects && !method.reflects) continue;
    if (options.quick && !one.reflects && method.reflects && sampled) continue;
    const double tightest = method.reflected_target / 3 * one.reflected_share;
    std::vector<double> wanted_errors = {0.001};
    if (one.reflects && options.quick) wanted_errors = {tightest};
    if (one.reflects && !options.quick) wanted_errors = {27 * tightest, 9 * tightest, 3 * tightest, tightest};
    for (const double wanted : wanted_errors) {
      EvaluateOptions evaluate;
      (one.reflects ? evaluate.wanted_rms_error : evaluate.wanted_relative_error) = wanted;
      evaluate.threads = options.threads;
      const Measured run = measure(method, rays, one.receivers, one.emitters, evaluate);
      std::optional<double> target;
      if (!one.reflects) target = one.direct_target;
      if (one.reflects && wanted == wanted_errors.back()) target = method.reflected_target;
      sampled = sampled || run.matrix.rays > 0;
      const AnalyticError error = run.refused.empty() ? error_of(one, run.matrix) : AnalyticError{};
      rows.push_back(row_of(one.name, method.name, one.reflects ? error.rms : error.worst, run,
                            one.reflects ? std::optional(wanted) : std::nullopt, target));
      if (one.reflects && run.refused.empty())
        rows.back().further.back().second = fmt::format("worst receiver: {:.2e}", error.worst);
    }
  }
}

}  // namespace luxrig
