#include "core/solve/placement/scene/search_space.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace luxrig {
namespace {

constexpr double kMinShare = 1e-3;  ///< of a column's brightest entry

/// Direct columns, and the field's contribution to each.
struct LitColumn {
  std::vector<std::uint32_t> row;
  std::vector<float> lux;
};

LitColumn with_reflected(const CandidateColumns& direct, std::size_t column, const Vec3& place_m,
                         const ReflectedField& field, Eigen::Index points) {
  Eigen::VectorXd lux = Eigen::VectorXd::Zero(points);
  field.add(place_m, lux, nullptr);
  for (std::uint64_t e = direct.begin[column]; e < direct.begin[column + 1]; ++e)
    lux[direct.receiver[e]] += static_cast<double>(direct.direct_lux[e]);
  LitColumn lit;
  const double least = kMinShare * lux.maxCoeff();
  for (Eigen::Index r = 0; r < points; ++r) {
    if (!(lux[r] > least)) continue;
    lit.row.push_back(static_cast<std::uint32_t>(r));
    lit.lux.push_back(static_cast<float>(lux[r]));
  }
  return lit;
}

}  // namespace

Result<SearchSpace> SearchSpace::make(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers,
                                      const Emitter& luminaire, std::span<const Vec3> places_world_m,
                                      const SearchSpaceOptions& options) {
  const bool aimed = !options.aims_world.empty();
  const bool has_size = luminaire.shape.kind != LuminousShape::Kind::point;
  const bool indirect = options.indirect && !has_size;
  const bool by_field = indirect && !aimed;

  SearchSpace space;
  IncrementalOptions incremental;
  incremental.indirect = indirect && !by_field;
  incremental.run() = options;
  auto transport = IncrementalTransport::make(scene, rays, receivers, incremental);
  if (!transport) return tl::unexpected(transport.error());
  space.transport_ = std::move(*transport);

  Emitter lamp = luminaire;
  lamp.shape = {};
  lamp.world_from_lamp.translation_m.setZero();
  CandidateOptions of_candidates;
  of_candidates.run() = options;
  of_candidates.surface_cells = options.surface_cells;
  of_candidates.wanted_relative_error = options.reflected_error;
  if (by_field) {
    auto field = ReflectedField::make(scene, rays, receivers, lamp, places_world_m, options.max_nodes, of_candidates);
    if (!field) return tl::unexpected(field.error());
    space.reflected_ = std::make_unique<ReflectedField>(std::move(*field));
  }
  SceneLightOptions of_light;
  of_light.aimed = aimed;
  of_light.indirect = indirect;
  of_light.reflected = space.reflected_.get();
  of_light.rays = &rays;
  of_light.may_hang = options.may_hang;
  Emitter moved_lamp = lamp;
  moved_lamp.shape = luminaire.shape;
  space.light_ = std::make_unique<SceneLight>(
      *space.transport_, std::vector<Receiver>(receivers.begin(), receivers.end()), moved_lamp, std::move(of_light));

  CandidateSet set{{places_world_m.begin(), places_world_m.end()}, {}};
  const Vec3 hung_aim = -lamp.world_from_lamp.rotation.col(2);
  const std::vector<Vec3> aims = aimed ? options.aims_world : std::vector<Vec3>{hung_aim};
  for (const Vec3& aim : aims) {
    set.luminaires.push_back(space.light_->hung({Vec3::Zero(), aim}));
    set.luminaires.back().shape = {};
  }
  for (const Vec3& place_m : places_world_m)
    for (const Vec3& aim : aims) space.poses_.push_back({place_m, aim});
  of_candidates.indirect = indirect && !by_field;
  auto found = candidate_transport(scene, rays, receivers, set, of_candidates);
  if (!found) return tl::unexpected(found.error());
  CandidateColumns& columns = found->matrix;

  const auto points = static_cast<Eigen::Index>(receivers.size());
  if (by_field) {
    std::vector<LitColumn> lit(columns.columns());
    parallel_for(lit.size(), options.threads, [&](std::size_t c) {
      lit[c] = with_reflected(columns, c, places_world_m[c], *space.reflected_, points);
    });
    space.begin_ = {0};
    for (const LitColumn& of : lit) {
      space.row_.insert(space.row_.end(), of.row.begin(), of.row.end());
      space.lux_.insert(space.lux_.end(), of.lux.begin(), of.lux.end());
      space.begin_.push_back(space.row_.size());
    }
  } else {
    space.begin_ = std::move(columns.begin);
    space.row_ = std::move(columns.receiver);
    space.lux_ = std::move(columns.total_lux);
  }
  space.view_ = ColumnsView(points, space.begin_, space.row_, space.lux_);
  return space;
}

std::vector<Vec3> aims_over_sphere(std::size_t count) {
  std::vector<Vec3> aims;
  constexpr double kTurn_rad = kPi * (3 - 2.2360679774997896964);  // the golden angle
  for (std::size_t i = 0; i < count; ++i) {
    const double z = count == 1 ? -1 : -1 + 2 * static_cast<double>(i) / static_cast<double>(count - 1);
    const double across = std::sqrt(std::max(0.0, 1 - z * z)), turn_rad = kTurn_rad * static_cast<double>(i);
    aims.emplace_back(across * std::cos(turn_rad), across * std::sin(turn_rad), z);
  }
  return aims;
}

}  // namespace luxrig
