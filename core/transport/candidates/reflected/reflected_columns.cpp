#include "core/transport/candidates/reflected/reflected_columns.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace luxrig {
namespace {

/// Fraction of the memory bound for guides.
constexpr std::size_t kGuidesShare = 16;
/// The error at a node is measured from nodes a step away. Other positions are about half as far from theirs, and the
/// error of a linear fit grows with the square of the distance.
constexpr double kErrorShare = 0.35;
/// Error that interpolation may add to a typical entry of a candidate, as a share of the wanted error; and the most
/// that one receiver's squared error counts, in units of that error squared.
constexpr double kMaxError = 1;
constexpr double kMaxCounted = 4;
/// Least share of the weights of an interpolated result that must come from nodes with known error.
constexpr float kMinForetold = 0.5f;
constexpr std::size_t kPlacesPerGuide = 8;
constexpr std::size_t kMinPerGuide = 64;
constexpr std::size_t kPositionsPerTask = 16;

}  // namespace

ReflectedColumns::ReflectedColumns(const RayScene& scene, IndirectColumns indirect, const CandidateSet& candidates,
                                   std::span<const CandidateLuminaire> luminaires, std::span<const std::uint8_t> usable,
                                   InterpolationNodes nodes, const CandidateOptions& options,
                                   CandidateStatistics& statistics)
    : scene_(scene),
      indirect_(std::move(indirect)),
      positions_world_m_(candidates.positions_world_m),
      luminaires_(luminaires),
      usable_(usable),
      options_(options),
      statistics_(statistics),
      row_(IndirectColumns::kReplicates * indirect_.stride()),
      nodes_(std::move(nodes)) {
  look_at_nodes();
}

void ReflectedColumns::make_groups(std::size_t places) {
  const PointTree tree(positions_world_m_);
  const std::size_t per_guide =
      std::max(kMinPerGuide, kPlacesPerGuide * positions_world_m_.size() / std::max<std::size_t>(1, places));
  groups_.clear();
  group_of_.resize(positions_world_m_.size());
  for (const PointTree::Node& node : tree.nodes) {
    const bool within_group = !groups_.empty() && node.begin < groups_.back().end;
    if (within_group || (node.right != 0 && node.end - node.begin > per_guide)) continue;
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      group_of_[tree.order[i]] = static_cast<std::uint32_t>(groups_.size());
    groups_.push_back({node.begin, node.end, {}});
  }
  group_order_ = tree.order;
  place_in_order_.resize(tree.order.size());
  for (std::uint32_t i = 0; i < tree.order.size(); ++i) place_in_order_[tree.order[i]] = i;
  guides_made_ = 0;
}

/// Makes missing guides. A guide does not depend on when it is made.
void ReflectedColumns::make_guides(std::span<const Asked> asked) {
  if (guides_made_ * sizeof(DirectionGuide) > options_.memory_bound_bytes / kGuidesShare) {
    for (Group& group : groups_) group.guides.clear();
    guides_made_ = 0;
  }
  std::vector<Asked> wanted;  // with groups in place of positions
  for (const Asked& one : asked) {
    Group& group = groups_[group_of_[one.position]];
    group.guides.resize(luminaires_.size());
    if (!group.guides[one.luminaire]) wanted.push_back({group_of_[one.position], one.luminaire});
  }
  const auto order = [](const Asked& a) { return std::pair(a.position, a.luminaire); };
  std::sort(wanted.begin(), wanted.end(), [&](const Asked& a, const Asked& b) { return order(a) < order(b); });
  wanted.erase(
      std::unique(wanted.begin(), wanted.end(), [&](const Asked& a, const Asked& b) { return order(a) == order(b); }),
      wanted.end());
  guides_made_ += wanted.size();
  std::vector<std::uint64_t> cast(wanted.size(), 0);
  parallel_for(wanted.size(), options_.threads, [&](std::size_t w) {
    if (stopped()) return;
    Group& group = groups_[wanted[w].position];
    const CandidateLuminaire& luminaire = luminaires_[wanted[w].luminaire];
    std::vector<Vec3> lamps_m;
    for (std::uint32_t i = group.begin; i < group.end; ++i)
      if (usable_[group_order_[i]]) lamps_m.push_back(positions_world_m_[group_order_[i]] + luminaire.offset_world_m);
    group.guides[wanted[w].luminaire] = std::make_unique<DirectionGuide>(indirect_.guide(luminaire, lamps_m, cast[w]));
  });
  statistics_.rays += std::accumulate(cast.begin(), cast.end(), std::uint64_t{0});
}

void ReflectedColumns::evaluate(std::span<const Asked> asked, std::uint32_t rays_each,
                                const std::function<std::span<float>(std::size_t)>& replicates_of) {
  make_guides(asked);
  if (stopped()) return;
  const std::uint32_t per_replicate = rays_each / IndirectColumns::kReplicates;
  const std::size_t stride = indirect_.stride();
  std::vector<std::uint64_t> cast(asked.size(), 0);
  // Neighbours in sequence: they see the same surfaces, whose rows then stay in the cache.
  std::vector<std::uint32_t> order(asked.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return place_in_order_[asked[a].position] < place_in_order_[asked[b].position];
  });
  for (std::size_t k = 0; k < IndirectColumns::kReplicates; ++k)
    parallel_for((asked.size() + kPositionsPerTask - 1) / kPositionsPerTask, options_.threads, [&](std::size_t task) {
      for (std::size_t at = kPositionsPerTask * task; at < std::min(asked.size(), kPositionsPerTask * (task + 1));
           ++at) {
        if (stopped()) return;
        const std::size_t i = order[at];
        const auto [p, l] = asked[i];
        cast[i] += indirect_.evaluate(k, luminaires_[l], positions_world_m_[p] + luminaires_[l].offset_world_m,
                                      *groups_[group_of_[p]].guides[l],
                                      {per_replicate, std::uint64_t{p} * luminaires_.size() + l, options_.skips.unlit},
                                      replicates_of(i).subspan(k * stride, stride));
      }
    });
  statistics_.rays += std::accumulate(cast.begin(), cast.end(), std::uint64_t{0});
}

/// Traces reflected light at the nodes, and finds how well the others predict it.
void ReflectedColumns::look_at_nodes() {
  const auto usable = static_cast<std::size_t>(std::count(usable_.begin(), usable_.end(), std::uint8_t{1}));
  const std::size_t kinds = luminaires_.size();
  make_groups(nodes_.size() > 0 ? nodes_.size() : usable);
  statistics_.nodes = nodes_.size();
  if (nodes_.size() == 0) return;
  values_.assign(kinds, std::vector<float>(nodes_.size() * row_));
  std::vector<Asked> asked;
  for (std::uint32_t l = 0; l < kinds; ++l)
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) asked.push_back({nodes_.position(n), l});
  evaluate(asked, statistics_.rays_per_node, [&](std::size_t i) {
    return std::span(values_[i / nodes_.size()]).subspan(i % nodes_.size() * row_, row_);
  });
  if (!stopped()) find_errors();
}

/// Squared error of each node if interpolated from the others, minus the part from noise.
void ReflectedColumns::find_errors() {
  const std::size_t kinds = luminaires_.size(), stride = indirect_.stride();
  squared_errors_.assign(kinds, std::vector<float>(nodes_.size() * stride));
  foretold_.assign(kinds * nodes_.size(), 0);
  constexpr double kCount = IndirectColumns::kReplicates;
  std::vector<std::uint64_t> cast(nodes_.size(), 0);
  parallel_for(nodes_.size(), options_.threads, [&](std::size_t n) {
    std::vector<WeightedRow> shares;
    std::vector<float> foretold(row_);
    for (std::size_t l = 0; l < kinds; ++l) {
      if (l == 0 || luminaires_[l].offset_world_m != luminaires_[l - 1].offset_world_m)
        nodes_.shares(scene_, positions_world_m_[nodes_.position(n)], luminaires_[l].offset_world_m, shares, cast[n],
                      static_cast<std::uint32_t>(n));
      foretold_[l * nodes_.size() + n] = !shares.empty();
      if (shares.empty()) continue;
      std::fill(foretold.begin(), foretold.end(), 0.0f);
      add_weighted_rows(values_[l].data(), shares, foretold);
      const float* own = values_[l].data() + n * row_;
      for (std::size_t r = 0; r < stride; ++r) {
        double mean = 0, squares = 0;
        for (std::size_t k = 0; k < IndirectColumns::kReplicates; ++k) {
          const auto off = static_cast<double>(foretold[k * stride + r]) - static_cast<double>(own[k * stride + r]);
          mean += off / kCount;
          squares += off * off;
        }
        // Subtracted twice: once since it is in the mean's square, once since it is in the wanted value. Sums over
        // nodes average it out.
        const double noise = (squares - kCount * mean * mean) / (kCount * (kCount - 1));
        squared_errors_[l][n * stride + r] = static_cast<float>(kErrorShare * kErrorShare * (mean * mean - noise));
      }
    }
  });
  statistics_.rays += std::accumulate(cast.begin(), cast.end(), std::uint64_t{0});
}

/// False if the error would be too large.
bool ReflectedColumns::interpolate(const Asked& one, std::span<const WeightedRow> shares, std::span<float> replicates,
                                   std::span<float> squared_error_lux2) const {
  if (shares.empty()) return false;
  std::fill(replicates.begin(), replicates.end(), 0.0f);
  add_weighted_rows(values_[one.luminaire].data(), shares, replicates);
  std::vector<WeightedRow> error_shares;
  float sum = 0;
  for (const WeightedRow& share : shares)
    if (foretold_[one.luminaire * nodes_.size() + share.row]) {
      error_shares.push_back({share.row, std::abs(share.weight)});
      sum += error_shares.back().weight;
    }
  if (!(sum > kMinForetold)) return false;
  for (WeightedRow& share : error_shares) share.weight /= sum;
  std::fill(squared_error_lux2.begin(), squared_error_lux2.end(), 0.0f);
  add_weighted_rows(squared_errors_[one.luminaire].data(), error_shares, squared_error_lux2);
  // Errors of single receivers are mostly noise, of either sign; their mean is not. Each is clamped, so that a few at a
  // shadow edge, whose error is stated anyway, do not decide for all.
  const std::size_t stride = indirect_.stride();
  constexpr double kCount = IndirectColumns::kReplicates;
  const double most = kMaxError * options_.wanted_relative_error;
  double off = 0;
  std::size_t lit = 0;
  for (std::size_t r = 0; r < stride; ++r) {
    double mean = 0, squares = 0;
    for (std::size_t k = 0; k < IndirectColumns::kReplicates; ++k) {
      const auto lux = static_cast<double>(replicates[k * stride + r]);
      mean += lux / kCount;
      squares += lux * lux;
    }
    if (!(mean > 0)) continue;
    const double noise = (squares - kCount * mean * mean) / (kCount * (kCount - 1));
    off += std::clamp(static_cast<double>(squared_error_lux2[r]) / (most * most * (mean * mean + noise)), -kMaxCounted,
                      kMaxCounted);
    ++lit;
  }
  if (off > static_cast<double>(lit)) return false;
  // Noise of a slope may go below 0.
  for (float& lux : replicates) lux = std::max(lux, 0.0f);
  for (float& square : squared_error_lux2) square = std::max(square, 0.0f);
  return true;
}

bool ReflectedColumns::block(std::size_t first, std::size_t count, std::size_t receivers, std::span<float> lux,
                             std::span<float> standard_error_lux) {
  const std::size_t kinds = luminaires_.size(), tasks = (count + kPositionsPerTask - 1) / kPositionsPerTask;
  const auto column_of = [&](const Asked& one) { return (one.position - first) * kinds + one.luminaire; };
  const auto write = [&](std::size_t column, std::span<const float> replicates, std::span<const float> squared_lux2) {
    indirect_.summarise(replicates, squared_lux2, lux.subspan(column * receivers, receivers),
                        standard_error_lux.subspan(column * receivers, receivers));
  };
  std::vector<std::uint64_t> cast(tasks, 0);
  std::vector<std::vector<Asked>> looked_at(tasks);
  parallel_for(tasks, options_.threads, [&](std::size_t task) {
    std::vector<WeightedRow> shares;
    std::vector<float> sums(row_), squared(indirect_.stride());
    for (std::size_t p = first + kPositionsPerTask * task; p < first + std::min(count, kPositionsPerTask * (task + 1));
         ++p) {
      if (!usable_[p] || stopped()) continue;
      for (std::uint32_t l = 0; l < kinds; ++l) {
        const Asked one{static_cast<std::uint32_t>(p), l};
        if (l == 0 || luminaires_[l].offset_world_m != luminaires_[l - 1].offset_world_m)
          nodes_.shares(scene_, positions_world_m_[p], luminaires_[l].offset_world_m, shares, cast[task]);
        if (interpolate(one, shares, sums, squared))
          write(column_of(one), sums, squared);
        else
          looked_at[task].push_back(one);
      }
    }
  });
  statistics_.rays += std::accumulate(cast.begin(), cast.end(), std::uint64_t{0});
  std::vector<Asked> asked;
  for (const auto& some : looked_at) asked.insert(asked.end(), some.begin(), some.end());
  statistics_.columns_looked_at += asked.size();
  constexpr std::size_t kAtOnce = 256;  // so that their replicates take little memory
  std::vector<float> replicates(std::min(kAtOnce, asked.size()) * row_);
  for (std::size_t from = 0; from < asked.size() && !stopped(); from += kAtOnce) {
    const std::span<const Asked> some =
        std::span<const Asked>(asked).subspan(from, std::min(kAtOnce, asked.size() - from));
    const auto row = [&](std::size_t i) { return std::span(replicates).subspan(i * row_, row_); };
    evaluate(some, statistics_.rays_per_candidate, row);
    parallel_for(some.size(), options_.threads, [&](std::size_t i) { write(column_of(some[i]), row(i), {}); });
  }
  return !stopped();
}

std::size_t ReflectedColumns::bytes() const {
  std::size_t sum = indirect_.bytes() + guides_made_ * sizeof(DirectionGuide);
  for (const auto& values : values_) sum += values.size() * sizeof(float);
  for (const auto& errors : squared_errors_) sum += errors.size() * sizeof(float);
  return sum;
}

}  // namespace luxrig
