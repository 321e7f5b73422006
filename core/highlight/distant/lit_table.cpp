#include "core/highlight/distant/lit_table.h"

#include <algorithm>
#include <numeric>

#include "core/highlight/distant/bin_neighbours.h"
#include "core/parallel.h"
#include "core/transport/progress.h"

namespace luxrig {
namespace {

constexpr std::size_t kPlacesPerLitTask = 32;

/// Data shared by all searches over the same bins.
struct LitBinGrid {
  explicit LitBinGrid(const DirectionBins& all)
      : bins(all), around(bins_within(bins, std::min(kPi, 1.6 * bin_width_rad(bins)))) {
    for (std::uint32_t b = 0; b < bins.count(); ++b) directions.push_back(bins.direction_of(b).cast<float>());
    // Sorts rays into cells four bins wide, so that neighbouring rays are cast together.
    const DirectionBins cells(std::max(1, bins.side() / 4));
    std::vector<std::uint32_t> cell(bins.count());
    for (std::uint32_t b = 0; b < bins.count(); ++b) cell[b] = cells.bin_of(bins.direction_of(b));
    order.resize(bins.count());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return cell[a] < cell[b]; });
    rank.resize(bins.count());
    for (std::uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k;
    // First rays: the bin at the centre of each cell of a coarser division, for all bins nearest to it.
    const DirectionBins coarse(std::max(1, bins.side() / 2));
    first_of.resize(bins.count());
    for (std::uint32_t b = 0; b < bins.count(); ++b)
      first_of[b] = bins.bin_of(coarse.direction_of(coarse.bin_of(bins.direction_of(b))));
    for (const std::uint32_t b : first_of) first_of[b] = b;
  }
  DirectionBins bins;
  BinNeighbours around;
  std::vector<Vec3f> directions;
  std::vector<std::uint32_t> order, rank, first_of;  ///< rank: place in the order
};

/// The search of one thread, one place at a time.
class LitSearch {
 public:
  LitSearch(const TargetRays& target, const LitBinGrid& grid, double lift_m)
      : target_(target), grid_(grid), lift_m_(lift_m), state_(grid.bins.count()) {}

  /// like   the row of a nearby place; empty = none
  void run(const OrientedPoint& place, std::span<const std::uint64_t> like, const Vec3f& like_normal, bool every_ray,
           std::span<std::uint64_t> row) {
    place_ = &place;
    const Vec3f normal = place.normal.cast<float>();
    for (std::uint32_t b = 0; b < state_.size(); ++b)
      state_[b] = grid_.directions[b].dot(normal) > 0 ? kFaces : std::uint8_t{0};
    if (every_ray) {
      ask_if([&](std::uint32_t b) { return state_[b] == kFaces; });
    } else if (like.empty()) {
      ask_if([&](std::uint32_t b) { return state_[b] == kFaces && grid_.first_of[b] == b; });
      for (std::uint32_t b = 0; b < state_.size(); ++b)
        if (state_[b] == kFaces && (state_[grid_.first_of[b]] & kOpen)) state_[b] |= kOpen;
      // If the nearest first ray is below the horizon, nothing is known.
      ask_if([&](std::uint32_t b) { return faces_unknown(b) && !(state_[grid_.first_of[b]] & kFaces); });
      follow_borders();
    } else {
      for (std::uint32_t b = 0; b < state_.size(); ++b)
        if (state_[b] == kFaces && (like[b / 64] >> (b % 64) & 1u)) state_[b] |= kOpen;
      ask_if([&](std::uint32_t b) { return faces_unknown(b) && grid_.directions[b].dot(like_normal) <= 0; });
      follow_borders();
    }
    for (std::uint32_t b = 0; b < state_.size(); ++b)
      if (state_[b] & kOpen) row[b / 64] |= std::uint64_t{1} << (b % 64);
  }

  std::uint64_t rays = 0;

 private:
  static constexpr std::uint8_t kFaces = 1, kKnown = 2, kOpen = 4;

  [[nodiscard]] bool faces_unknown(std::uint32_t b) const { return (state_[b] & (kFaces | kKnown)) == kFaces; }

  template <class Wanted>
  void ask_if(const Wanted& wanted) {
    asked_.clear();
    directions_.clear();
    for (const std::uint32_t b : grid_.order) {
      if (!wanted(b)) continue;
      asked_.push_back(b);
      directions_.push_back(grid_.directions[b]);
    }
    cast();
  }

  /// Casts rays for asked_; flipped_ gets the wrong guesses.
  void cast() {
    flipped_.clear();
    if (asked_.empty()) return;
    answers_.resize(asked_.size());
    target_.blocked(place_->position_world_m, place_->normal, lift_m_, directions_, answers_);
    for (std::size_t k = 0; k < asked_.size(); ++k) {
      const auto found = static_cast<std::uint8_t>(kFaces | kKnown | (answers_[k] ? 0 : kOpen));
      if ((found ^ state_[asked_[k]]) & kOpen) flipped_.push_back(asked_[k]);
      state_[asked_[k]] = found;
    }
    rays += asked_.size();
  }

  void follow_borders() {
    const auto at_a_border = [&](std::uint32_t b) {
      if (!faces_unknown(b)) return false;
      const std::uint8_t mine = state_[b] & kOpen;
      for (const std::uint32_t other : grid_.around.of(b))
        if ((state_[other] & kFaces) && (state_[other] & kOpen) != mine) return true;
      return false;
    };
    ask_if(at_a_border);
    // A new border can appear only where a guess was wrong.
    while (!flipped_.empty()) {
      asked_.clear();
      for (const std::uint32_t b : flipped_)
        for (const std::uint32_t other : grid_.around.of(b))
          if (faces_unknown(other) && ((state_[other] ^ state_[b]) & kOpen)) asked_.push_back(other);
      const auto earlier = [&](std::uint32_t a, std::uint32_t b) { return grid_.rank[a] < grid_.rank[b]; };
      std::sort(asked_.begin(), asked_.end(), earlier);
      asked_.erase(std::unique(asked_.begin(), asked_.end()), asked_.end());
      directions_.clear();
      for (const std::uint32_t b : asked_) directions_.push_back(grid_.directions[b]);
      cast();
    }
  }

  const TargetRays& target_;
  const LitBinGrid& grid_;
  double lift_m_;
  const OrientedPoint* place_ = nullptr;
  std::vector<std::uint8_t> state_;
  std::vector<std::uint32_t> asked_, flipped_;
  std::vector<Vec3f> directions_;
  std::vector<std::uint8_t> answers_;
};

}  // namespace

Result<LitTable> find_lit_bins(const TargetRays& target, const ContrastSamples& samples, const DirectionBins& bins,
                               const LitTableOptions& options) {
  LitTable table{bins, (bins.count() + 63) / 64, {}, 0};
  table.rows.assign(samples.points.size() * table.words, 0);
  std::vector<std::uint32_t> parent(samples.points.size(), TargetSurface::kNone);
  for (std::uint32_t i = 0; i < samples.interest; ++i)
    for (const std::uint32_t n : samples.of(i))
      if (n >= samples.interest && parent[n] == TargetSurface::kNone) parent[n] = i;

  const LitBinGrid grid(bins);
  const std::size_t tasks = (samples.points.size() + kPlacesPerLitTask - 1) / kPlacesPerLitTask + 1;
  CallingThreadProgress progress(options.watch, 0, 1, tasks);
  std::vector<std::uint64_t> rays;
  // Interest points first, since the others start from their results.
  for (const auto& [begin, end] :
       {std::pair(std::size_t{0}, samples.interest), std::pair(samples.interest, samples.points.size())}) {
    const std::size_t parts = (end - begin + kPlacesPerLitTask - 1) / kPlacesPerLitTask;
    rays.assign(parts, 0);
    parallel_for(parts, options.threads, [&, first = begin, last = end](std::size_t part) {
      if (options.watch.stop.stop_requested()) return;
      LitSearch search(target, grid, options.lift_m);
      const std::size_t from = first + part * kPlacesPerLitTask;
      for (std::size_t p = from; p < std::min(last, from + kPlacesPerLitTask); ++p) {
        if (samples.points[p].normal.isZero(0)) continue;
        const std::uint32_t like = parent[p];
        const bool alone = like == TargetSurface::kNone || samples.points[like].normal.isZero(0);
        search.run(samples.points[p], alone ? std::span<const std::uint64_t>() : table.of(like),
                   alone ? Vec3f::Zero() : Vec3f(samples.points[like].normal.cast<float>()), options.every_ray,
                   std::span(table.rows).subspan(p * table.words, table.words));
      }
      rays[part] = search.rays;
      progress.one_done();
    });
    table.rays += std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
  }
  if (options.watch.stop.stop_requested())
    return tl::unexpected(Fault{Cause::cancelled, "", "the search for lit directions was stopped", {}});
  progress.report_end();
  return table;
}

}  // namespace luxrig
