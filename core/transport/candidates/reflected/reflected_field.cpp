#include "core/transport/candidates/reflected/reflected_field.h"

#include <algorithm>

#include "core/transport/candidates/air_regions.h"
#include "core/transport/candidates/reflected/weighted_rows.h"

namespace luxrig {

namespace {

/// Up to this number, all places may be nodes.
constexpr std::size_t kFewPlaces = 60;

}  // namespace

Result<ReflectedField> ReflectedField::make(const Scene& scene, const RayScene& rays,
                                            std::span<const Receiver> receivers, const Emitter& luminaire,
                                            std::span<const Vec3> places_world_m, std::size_t max_nodes,
                                            const CandidateOptions& options) {
  std::vector<std::uint8_t> usable(places_world_m.size());
  const ReceiversAir air(scene, rays, receivers);
  for (std::size_t p = 0; p < usable.size(); ++p) usable[p] = air.reaches(places_world_m[p]);

  ReflectedField field;
  field.rays_ = &rays;
  // If every place were a node, none would be more accurate than a single evaluation.
  const auto all = static_cast<std::size_t>(std::count(usable.begin(), usable.end(), 1));
  const double step_m =
      InterpolationNodes::step_for(places_world_m, usable, std::min(max_nodes, std::max(all / 2, kFewPlaces)));
  if (step_m > 0) field.nodes_ = InterpolationNodes(places_world_m, usable, step_m);
  field.receivers_ = receivers.size();
  field.stride_ = (receivers.size() + kRowUnit - 1) / kRowUnit * kRowUnit;
  field.lux_.assign(field.nodes_.size() * field.stride_, 0);
  CandidateSet set{{}, {luminaire}};
  set.luminaires[0].world_from_lamp.translation_m = Vec3::Zero();
  for (std::size_t n = 0; n < field.nodes_.size(); ++n)
    set.positions_world_m.push_back(places_world_m[field.nodes_.position(n)]);
  CandidateOptions looked_at = options;
  looked_at.indirect = true;
  looked_at.skips.foretold = false;  // nodes are the few places with their own rays
  auto statistics = stream_candidates(scene, rays, receivers, set, looked_at, [&](const CandidateColumns& block) {
    for (std::size_t c = 0; c < block.columns(); ++c) {
      float* to = field.lux_.data() + (block.first_column + c) * field.stride_;
      for (std::uint64_t e = block.begin[c]; e < block.begin[c + 1]; ++e)
        to[block.receiver[e]] = block.total_lux[e] - block.direct_lux[e];
    }
    return true;
  });
  if (!statistics) return tl::unexpected(statistics.error());
  field.statistics_ = *statistics;
  return field;
}

bool ReflectedField::add(const Vec3& place_world_m, Eigen::VectorXd& lux, Eigen::MatrixXd* slopes) const {
  std::vector<WeightedRow> shares;
  std::vector<Vec3> rises_per_m;
  std::uint64_t rays = 0;
  nodes_.shares(*rays_, place_world_m, Vec3::Zero(), shares, rays, ~0u, slopes ? &rises_per_m : nullptr);
  if (shares.empty()) {
    nodes_.mean_shares(*rays_, place_world_m, shares);
    rises_per_m.assign(shares.size(), Vec3::Zero());
  }
  if (shares.empty()) return false;
  std::vector<float> sums(stride_, 0.0F);
  add_weighted_rows(lux_.data(), shares, sums);
  const auto count = static_cast<Eigen::Index>(receivers_);
  // A noisy plane may dip below 0 where there is almost no light.
  for (Eigen::Index r = 0; r < count; ++r)
    lux[r] += std::max(0.0, static_cast<double>(sums[static_cast<std::size_t>(r)]));
  if (slopes)
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const Eigen::Map<const Eigen::VectorXf> of_node(lux_.data() + shares[i].row * stride_, count);
      for (int axis = 0; axis < 3; ++axis) slopes->col(axis) += rises_per_m[i][axis] * of_node.cast<double>();
    }
  return true;
}

}  // namespace luxrig
