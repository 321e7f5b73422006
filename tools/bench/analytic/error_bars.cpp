/// Are reported errors honest? Many seeds in one cheap room: how often the truth is within two reported standard
/// errors.

#include <fmt/format.h>

#include <cmath>

#include "tools/bench/analytic/box_radiosity.h"
#include "tools/bench/analytic/case.h"
#include "tools/bench/rooms/enclosures.h"

namespace luxrig {

namespace {

/// per_edge    receivers along each edge of each wall: from some dozens on `gather` shares paths between them
void add_rows_of_methods(int seeds, int per_edge, double wanted, const BenchOptions& options,
                         std::vector<BenchRow>& rows) {
  const double edge_m = 3, reflectance = 0.6;
  const Vec3 source_m(1.7, 1.2, 2.0);
  Scene scene = make_cube(edge_m, reflectance);
  scene.origin_world_m = Vec3::Constant(edge_m / 2);
  const RayScene rays(scene);
  std::array<double, 6> same;
  same.fill(reflectance);
  const BoxRadiosity exact({Vec3::Constant(edge_m), same, 1000, source_m}, 8);
  std::vector<Receiver> receivers;
  std::vector<double> exact_lx;
  for (const WallPoint& p : cube_wall_grid(edge_m, per_edge)) {
    const Vec3 shift = Vec3(0.37, -0.61, 0.23) / per_edge,
               at_m = p.position_m + shift - shift.dot(p.normal) * p.normal + scene.origin_world_m;
    receivers.push_back({at_m, p.normal});
    exact_lx.push_back(exact.direct_lx(at_m, p.normal) + exact.reflected_lx(at_m, p.normal));
  }
  const std::vector<Emitter> source = {{make_isotropic(1000), {Mat3::Identity(), source_m}}};
  for (const Method& method : methods()) {
    if (!method.reflects) continue;
    Measured all;
    double seconds = 0, squares = 0;
    std::uint64_t traced = 0;
    int within = 0, count = 0;
    for (int seed = 1; seed <= seeds && all.refused.empty(); ++seed) {
      EvaluateOptions evaluate;
      evaluate.wanted_rms_error = wanted;
      evaluate.seed = static_cast<std::uint64_t>(seed);
      evaluate.threads = options.threads;
      all = measure(method, rays, receivers, source, evaluate);
      seconds += all.seconds, traced += all.matrix.rays;
      if (!all.refused.empty()) break;
      const Eigen::VectorXd levels = Eigen::VectorXd::Ones(1), lux = all.matrix.lux(levels);
      const Eigen::VectorXd bar_lx = all.matrix.standard_error_lux(levels);
      for (std::size_t r = 0; r < receivers.size(); ++r, ++count) {
        const auto row = static_cast<Eigen::Index>(r);
        const double off_lx = std::abs(lux[row] - exact_lx[r]);
        within += off_lx <= 2 * bar_lx[row];
        squares += std::pow(off_lx / exact_lx[r], 2);
      }
    }
    all.seconds = seconds, all.matrix.rays = traced;
    const double share = count ? static_cast<double>(within) / count : 0;
    BenchRow row = row_of(fmt::format("error-bars-{}-seeds-{}-points", seeds, receivers.size()), method.name,
                          std::abs(share - 0.95), all, wanted, 0.02);
    if (all.refused.empty())
      row.further.back().second = fmt::format("within two standard errors: {:.2f} %; rms error {:.2e}", 100 * share,
                                              std::sqrt(squares / std::max(count, 1)));
    rows.push_back(row);
  }
}

}  // namespace

void add_error_bar_rows(const BenchOptions& options, std::vector<BenchRow>& rows) {
  add_rows_of_methods(options.quick ? 200 : 1000, 1, 0.02, options, rows);
  add_rows_of_methods(options.quick ? 20 : 200, 3, 0.05, options, rows);
}

}  // namespace luxrig
