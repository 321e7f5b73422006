/// The complement of a residual among all candidates of the flat, found in three ways: through the sparse columns (as
/// the search does), through a dense matrix of them, and by a k-d tree over them.

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nanoflann.hpp>

#include "core/solve/placement/scene/lattice.h"
#include "core/solve/placement/scene/search_space.h"
#include "core/solve/placement/search/complement_search.h"
#include "tools/bench/row_progress.h"
#include "tools/bench/suites.h"
#include "tools/bench/transport/candidates.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::VectorXd;
using Eigen::VectorXf;

constexpr double kIndexLattice_m = 0.3, kIndexGoal_lux = 200;
constexpr std::size_t kIndexQueries = 10, kIndexLeaf = 16;

/// Candidates that light any point, and residuals to complement: those of 0 to 9 lights. Each light is the best one for
/// the residual of the previous ones.
struct IndexCase {
  std::vector<Index> lit;
  VectorXd norm;  ///< per lit column
  std::vector<PlacedLights> chosen;
};

IndexCase index_case(const ColumnsView& columns, const MovableLight& light, const LightingGoal& goal,
                     const ComplementSearch& search) {
  IndexCase of;
  const VectorXd ones = VectorXd::Ones(columns.rows());
  std::vector<double> norms;
  for (Index j = 0; j < columns.columns(); ++j)
    if (const double squares = columns.squared_norm(j, ones.data()); squares > 0) {
      of.lit.push_back(j);
      norms.push_back(std::sqrt(squares));
    }
  of.norm = Eigen::Map<const VectorXd>(norms.data(), static_cast<Index>(norms.size()));
  of.chosen.emplace_back(light, goal);
  while (of.chosen.size() < kIndexQueries) {
    PlacedLights more = of.chosen.back();
    const auto best = search.best(more, 1, 0);
    if (best.empty() || !more.add(search.pose(best.front().candidate))) break;
    of.chosen.push_back(std::move(more));
  }
  return of;
}

/// Columns of norm 1 in float, as nanoflann needs them.
struct UnitColumns {
  MatrixXf of;

  UnitColumns(const ColumnsView& columns, const IndexCase& index)
      : of(MatrixXf::Zero(columns.rows(), static_cast<Index>(index.lit.size()))) {
    std::vector<std::uint32_t> rows;
    std::vector<double> values;
    for (std::size_t j = 0; j < index.lit.size(); ++j) {
      columns.entries(index.lit[j], rows, values);
      const auto column = static_cast<Index>(j);
      for (std::size_t k = 0; k < rows.size(); ++k)
        of(rows[k], column) = static_cast<float>(values[k] / index.norm[column]);
    }
  }
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(of.cols()); }
  [[nodiscard]] float kdtree_get_pt(std::size_t point, std::size_t dimension) const {
    return of(static_cast<Index>(dimension), static_cast<Index>(point));
  }
  template <class Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

/// Finds the column of norm 1 with the largest product with each residual.
BenchRow index_row(const std::string& name, const char* method, double build_seconds, const ColumnsView& columns,
                   const IndexCase& of, const std::function<Index(const PlacedLights&)>& best) {
  double worst = 0;
  std::vector<double> seconds;
  for (const PlacedLights& chosen : of.chosen) {
    Index found = 0;
    std::vector<double> runs;
    for (int run = 0; run < 5; ++run) runs.push_back(timed([&] { found = best(chosen); }).cpu);
    seconds.push_back(median_of(runs));
    double most = 0, got = 0;
    for (std::size_t j = 0; j < of.lit.size(); ++j) {
      const double cosine = columns.dot(of.lit[j], chosen.residual().data()) / of.norm[static_cast<Index>(j)];
      most = std::max(most, cosine);
      if (static_cast<Index>(j) == found) got = cosine;
    }
    worst = std::max(worst, 1 - got / most);
  }
  BenchRow row{name, method, worst, median_of(seconds), std::nullopt, std::nullopt, {}};
  row.further = {{"build_seconds", fmt::format("{:.3g}", build_seconds)},
                 {"slowest_seconds", fmt::format("{:.3g}", *std::max_element(seconds.begin(), seconds.end()))},
                 {"candidates", std::to_string(of.lit.size())},
                 {"points", std::to_string(columns.rows())}};
  say_row_made(row);
  return row;
}

void add_index_rows(std::size_t points, int threads, std::vector<BenchRow>& rows) {
  const TransportCase one(make_eight_room_flat());
  const std::vector<Receiver> receivers = this_many_receivers(one, points);
  const auto places_m = lattice_in(one.rays.bounds_world_m(), kIndexLattice_m);
  SearchSpaceOptions of_space;
  of_space.threads = threads;
  const auto space =
      SearchSpace::make(one.room.scene, one.rays, receivers, {make_isotropic(1), {}}, places_m, of_space);
  const SceneLight& light = space->light();
  const ColumnsView& columns = space->columns();
  const LightingGoal goal{VectorXd::Constant(light.points(), kIndexGoal_lux)};
  const std::string name = fmt::format("index-{}x{}", receivers.size(), places_m.size());

  std::unique_ptr<ComplementSearch> search;
  const double search_build =
      timed([&] { search = std::make_unique<ComplementSearch>(columns, space->poses(), goal); }).cpu;
  const IndexCase of = index_case(columns, light, goal, *search);
  const VectorXd inverse_norm = of.norm.cwiseInverse();

  VectorXd pull(columns.columns()), scale = VectorXd::Zero(columns.columns());
  for (std::size_t j = 0; j < of.lit.size(); ++j) scale[of.lit[j]] = inverse_norm[static_cast<Index>(j)];
  rows.push_back(index_row(name, "sparse-scan", 0, columns, of, [&](const PlacedLights& chosen) {
    columns.dot_all(chosen.residual().data(), scale.data(), pull.data());
    Index best = 0;
    pull.maxCoeff(&best);
    return std::lower_bound(of.lit.begin(), of.lit.end(), best) - of.lit.begin();
  }));

  std::unique_ptr<UnitColumns> dense;
  const double dense_build = timed([&] { dense = std::make_unique<UnitColumns>(columns, of); }).cpu;
  rows.push_back(index_row(name, "dense-scan", dense_build, columns, of, [&](const PlacedLights& chosen) {
    const VectorXf residual = chosen.residual().cast<float>();
    Index best = 0;
    (dense->of.transpose() * residual).maxCoeff(&best);
    return best;
  }));

  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Adaptor<float, UnitColumns>, UnitColumns, -1, Index>;
  std::unique_ptr<Tree> tree;
  const double tree_build = timed([&] {
                              const nanoflann::KDTreeSingleIndexAdaptorParams how(kIndexLeaf);
                              tree = std::make_unique<Tree>(static_cast<int>(columns.rows()), *dense, how);
                            }).cpu;
  rows.push_back(index_row(name, "k-d-tree", dense_build + tree_build, columns, of, [&](const PlacedLights& chosen) {
    const VectorXf unit = chosen.residual().normalized().cast<float>();
    Index best = 0;
    float distance = 0;
    nanoflann::KNNResultSet<float, Index> result(1);
    result.init(&best, &distance);
    tree->findNeighbors(result, unit.data(), nanoflann::SearchParams());
    return best;
  }));

  // The search's real query: the levels of the chosen lights follow. It answers another question, so it has no error
  // here.
  rows.push_back(index_row(name, "complement", search_build, columns, of, [&](const PlacedLights& chosen) {
    return static_cast<Index>(search->best(chosen, 1, 0).front().candidate);
  }));
  rows.back().error = std::nan("");
}

}  // namespace

std::vector<BenchRow> bench_placement_index(const BenchOptions& options) {
  std::vector<BenchRow> rows;
  for (const std::size_t points : {300, 3000})
    if (points == 300 || !options.quick) add_index_rows(points, options.threads, rows);
  return rows;
}

}  // namespace luxrig
