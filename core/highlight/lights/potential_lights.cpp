#include "core/highlight/lights/potential_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/highlight/shadow/direction_modes.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

struct LightsOfCell {
  std::vector<PotentialLight> lights;
  std::vector<std::size_t> ends;  // in votes
  std::vector<LightVote> votes;
};

void add_light(const DomainVotes& votes, std::uint32_t cell, const Vec3& towards, double window_rad,
               std::vector<const DomainVote*>& mine, LightsOfCell& found) {
  const double chord2 = 4 * std::pow(std::sin(0.5 * window_rad), 2) * (1 + 1e-12);
  mine.clear();
  for (const DomainVote& vote : votes.of(cell))
    if ((vote.direction.cast<double>() - towards).squaredNorm() <= chord2 && votes.weight(vote) > 0)
      mine.push_back(&vote);
  if (mine.empty()) return;
  // Votes come sorted by point, and stay so within each feature.
  std::stable_sort(mine.begin(), mine.end(),
                   [](const DomainVote* a, const DomainVote* b) { return a->feature < b->feature; });
  Vec3 sum = Vec3::Zero();
  double weight = 0;
  for (std::size_t i = 0; i < mine.size(); ++i) {
    const DomainVote& vote = *mine[i];
    const bool same_feature = i > 0 && mine[i - 1]->feature == vote.feature;
    if (!same_feature) found.votes.push_back({vote.feature, 0, 0});
    if (!same_feature || mine[i - 1]->point != vote.point) ++found.votes.back().points;
    found.votes.back().weight += votes.weight(vote);
    sum += votes.weight(vote) * vote.direction.cast<double>();
    weight += votes.weight(vote);
  }
  const Vec3 mean = sum.norm() > 1e-9 * weight ? Vec3(sum.normalized()) : towards;
  found.lights.push_back(
      {votes.cells[cell].centre_world_m, -mean, cell, static_cast<std::uint32_t>(mine.size()), weight});
  found.ends.push_back(found.votes.size());
}

void drop_small(const PotentialLightOptions& options, LightsOfCell& found) {
  double most = 0;
  for (const PotentialLight& light : found.lights) most = std::max(most, light.weight);
  LightsOfCell kept;
  for (std::size_t i = 0; i < found.lights.size(); ++i) {
    const PotentialLight& light = found.lights[i];
    if (light.votes < options.min_votes || light.weight < options.min_share * most) continue;
    kept.lights.push_back(light);
    const auto at = [&](std::size_t k) { return found.votes.begin() + static_cast<std::ptrdiff_t>(k); };
    kept.votes.insert(kept.votes.end(), at(i == 0 ? 0 : found.ends[i - 1]), at(found.ends[i]));
    kept.ends.push_back(kept.votes.size());
  }
  found = std::move(kept);
}

}  // namespace

Result<PotentialLights> potential_lights(const DomainVotes& votes, const PotentialLightOptions& options) {
  if (!(options.beam_angle_rad >= rad_from_deg(0.1) && options.beam_angle_rad <= 2 * kPi))
    return refusal(fmt::format("a beam of {} degrees", deg_from_rad(options.beam_angle_rad)));
  if (!(options.min_share >= 0 && options.min_share <= 1))
    return refusal(fmt::format("a least share of {} is not within 0 to 1", options.min_share));
  const double window_rad = options.beam_angle_rad / 2;
  std::vector<LightsOfCell> cells(votes.cells.size());
  parallel_for(cells.size(), options.threads, [&](std::size_t c) {
    if (options.watch.stop.stop_requested()) return;
    std::vector<Vec3f> directions;
    std::vector<double> weights;
    for (const DomainVote& vote : votes.of(c)) {
      directions.push_back(vote.direction);
      weights.push_back(votes.weight(vote));
    }
    std::vector<const DomainVote*> mine;
    for (const DirectionMode& mode : direction_modes(directions, weights, window_rad))
      add_light(votes, static_cast<std::uint32_t>(c), mode.direction, window_rad, mine, cells[c]);
    drop_small(options, cells[c]);
  });
  if (options.watch.stop.stop_requested())
    return tl::unexpected(Fault{Cause::cancelled, "", "the search for potential lights was stopped", {}});
  PotentialLights all;
  all.features = votes.features;
  all.points_of_feature = votes.points_of_feature;
  for (LightsOfCell& cell : cells) {
    for (const std::size_t end : cell.ends) all.begin.push_back(all.votes.size() + end);
    all.lights.insert(all.lights.end(), cell.lights.begin(), cell.lights.end());
    all.votes.insert(all.votes.end(), cell.votes.begin(), cell.votes.end());
    cell = {};
  }
  if (all.lights.empty())
    return refusal(
        fmt::format("no place of the light domain has {} votes within one beam: of {} votes in {} cells all "
                    "were dropped",
                    options.min_votes, votes.votes.size(), votes.cells.size()));
  return all;
}

}  // namespace luxrig
