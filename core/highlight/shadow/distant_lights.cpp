#include "core/highlight/shadow/distant_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr int kMaxRounds = 200;

struct VotedBin {
  std::uint32_t bin;
  double votes;
  Vec3 direction;
  std::size_t cluster = 0;
};

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

std::vector<Vec3> first_means(const std::vector<VotedBin>& bins, std::size_t wanted) {
  const auto most = std::max_element(bins.begin(), bins.end(),
                                     [](const VotedBin& a, const VotedBin& b) { return a.votes < b.votes; });
  std::vector<Vec3> means = {most->direction};
  std::vector<double> nearest_rad(bins.size(), kPi);
  while (means.size() < wanted) {
    std::size_t best = 0;
    double best_pull = -1;
    for (std::size_t i = 0; i < bins.size(); ++i) {
      nearest_rad[i] = std::min(nearest_rad[i], angle_between(bins[i].direction, means.back()));
      const double pull = bins[i].votes * nearest_rad[i] * nearest_rad[i];
      if (pull > best_pull) {
        best_pull = pull;
        best = i;
      }
    }
    if (!(best_pull > 0)) break;
    means.push_back(bins[best].direction);
  }
  return means;
}

/// The spherical mean: the point where weighted steps along great circles to all directions cancel.
Vec3 mean_on_sphere(const std::vector<VotedBin>& bins, std::size_t cluster, Vec3 mean) {
  for (int round = 0; round < 20; ++round) {
    Vec3 step = Vec3::Zero();
    double votes = 0;
    for (const VotedBin& bin : bins) {
      if (bin.cluster != cluster) continue;
      const Vec3 across = bin.direction - mean.dot(bin.direction) * mean;
      const double length = across.norm();
      if (length > 1e-12) step += bin.votes * angle_between(mean, bin.direction) / length * across;
      votes += bin.votes;
    }
    if (!(votes > 0)) return mean;
    step /= votes;
    const double turn = step.norm();
    if (turn < 1e-9) break;
    mean = (std::cos(turn) * mean + std::sin(turn) / turn * step).normalized();
  }
  return mean;
}

}  // namespace

Result<std::vector<DistantLight>> distant_lights(const DirectionHistogram& histogram,
                                                 const DistantLightOptions& options) {
  if (options.lights < 1) return refusal(fmt::format("{} lights cannot bring out anything", options.lights));
  if (!(options.cut >= 0 && options.cut <= 1)) return refusal(fmt::format("cut {} is not within 0 to 1", options.cut));
  const std::uint32_t most =
      histogram.votes.empty() ? 0 : *std::max_element(histogram.votes.begin(), histogram.votes.end());
  if (most == 0) return refusal("the object has no shadow edges: there is no relief that a light could bring out");
  std::vector<VotedBin> bins;
  double all = 0;
  for (std::uint32_t b = 0; b < histogram.votes.size(); ++b) {
    const double votes = histogram.votes[b];
    if (votes == 0 || votes < options.cut * most) continue;
    bins.push_back({b, votes, histogram.mean_direction[b]});
    all += votes;
  }

  std::vector<Vec3> means = first_means(bins, static_cast<std::size_t>(options.lights));
  for (int round = 0; round < kMaxRounds; ++round) {
    bool changed = round == 0;
    for (VotedBin& bin : bins) {
      std::size_t nearest = 0;
      for (std::size_t m = 1; m < means.size(); ++m)
        if (angle_between(bin.direction, means[m]) < angle_between(bin.direction, means[nearest])) nearest = m;
      changed |= nearest != bin.cluster;
      bin.cluster = nearest;
    }
    if (!changed) break;
    for (std::size_t m = 0; m < means.size(); ++m) means[m] = mean_on_sphere(bins, m, means[m]);
  }

  struct Represented {
    const VotedBin* best = nullptr;
    double votes = 0;
  };
  std::vector<Represented> clusters(means.size());
  for (const VotedBin& bin : bins) {
    Represented& cluster = clusters[bin.cluster];
    if (cluster.best == nullptr || bin.votes > cluster.best->votes) cluster.best = &bin;
    cluster.votes += bin.votes;
  }
  std::erase_if(clusters, [](const Represented& c) { return c.best == nullptr; });
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Represented& a, const Represented& b) { return a.votes > b.votes; });
  std::vector<DistantLight> lights;
  for (const Represented& c : clusters)
    lights.push_back({c.best->direction, histogram.votes[c.best->bin], c.votes / all});
  return lights;
}

}  // namespace luxrig
