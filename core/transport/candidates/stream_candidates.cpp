#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/parallel.h"
#include "core/transport/candidates/air_regions.h"
#include "core/transport/candidates/error_histogram.h"
#include "core/transport/candidates/reflected/indirect_plan.h"
#include "core/transport/candidates/reflected/reflected_columns.h"
#include "core/transport/direct/emitter_sampler.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxPositionsPerBlock = 8192;
/// Bytes per receiver and column in a block: direct light, indirect light and its error, and an entry of the result.
constexpr std::size_t kBytesPerPair = 3 * sizeof(float) + sizeof(std::uint32_t) + 3 * sizeof(float);

Result<void> check(std::span<const Receiver> receivers, const CandidateSet& candidates,
                   const CandidateOptions& options) {
  EvaluateOptions limits;
  limits.wanted_relative_error = options.wanted_relative_error;
  if (auto checked = check_evaluation(receivers, {}, limits); !checked) return checked;
  if (auto checked = check_evaluation({}, candidates.luminaires, limits); !checked) return checked;
  if (candidates.luminaires.empty()) return refusal("no luminaire to hang at the candidate positions");
  for (std::size_t l = 0; l < candidates.luminaires.size(); ++l) {
    if (candidates.luminaires[l].sky) return refusal(fmt::format("luminaire {} is a sky; it hangs nowhere", l));
    if (candidates.luminaires[l].shape.kind != LuminousShape::Kind::point)
      return refusal(fmt::format("luminaire {} has a size; candidates are points: take its far field as one", l));
  }
  for (std::size_t p = 0; p < candidates.positions_world_m.size(); ++p)
    if (!candidates.positions_world_m[p].allFinite())
      return refusal(fmt::format("candidate position {} is not finite", p));
  if (!(options.min_lux >= 0) || !std::isfinite(options.min_lux))
    return refusal(fmt::format("least lux is {:g}; it must be finite and at least 0", options.min_lux));
  return {};
}

tl::unexpected<Fault> cancelled() {
  return tl::unexpected(Fault{Cause::cancelled, "", "stopped while computing the candidates' light", {}});
}

class Stream {
 public:
  Stream(const Scene& scene, const RayScene& rays, std::span<const Receiver> receivers, const CandidateSet& candidates,
         const CandidateOptions& options)
      : scene_(scene),
        rays_(rays),
        receivers_(receivers),
        candidates_(candidates),
        options_(options),
        luminaires_(luminaires_ready(candidates.luminaires)) {}

  Result<CandidateStatistics> run(const TakeColumns& take) {
    const std::size_t positions = candidates_.positions_world_m.size();
    statistics_.columns = candidates_.columns();
    const bool empty_scene = scene_.triangles.empty();
    if (!empty_scene && options_.skips.blockers) blockers_.emplace(scene_);
    visibility_ = {empty_scene ? nullptr : &rays_, blockers_ ? &*blockers_ : nullptr};
    if (!empty_scene && options_.skips.other_air && !receivers_.empty()) air_.emplace(scene_, rays_, receivers_);
    find_usable();
    std::size_t fixed_bytes = 0;
    if (options_.indirect && !empty_scene && positions > 0 && !receivers_.empty()) {
      InterpolationNodes nodes = choose_nodes(candidates_, usable_, receivers_.size(), options_);
      auto planned = plan_indirect(scene_, visibility_, receivers_, candidates_, luminaires_, usable_, nodes, options_,
                                   statistics_);
      if (!planned) return tl::unexpected(std::move(planned.error()));
      report(0.1);
      reflected_.emplace(rays_, std::move(*planned), candidates_, luminaires_, usable_, std::move(nodes), options_,
                         statistics_);
      if (options_.watch.stop.stop_requested()) return cancelled();
      fixed_bytes = reflected_->bytes();
      report(0.5);
    }
    const std::size_t per_position =
        std::max<std::size_t>(1, receivers_.size() * luminaires_.size()) * kBytesPerPair + sizeof(Vec3);
    const std::size_t room = options_.memory_bound_bytes > fixed_bytes ? options_.memory_bound_bytes - fixed_bytes : 0;
    const std::size_t per_block = std::min(kMaxPositionsPerBlock, room / per_position);
    if (per_block == 0 && positions > 0)
      return refusal(fmt::format("one candidate position needs {} bytes besides {} for the surfaces; the bound is {}",
                                 per_position, fixed_bytes, options_.memory_bound_bytes));
    const double begun = reflected_ ? 0.5 : 0.0;
    for (std::size_t first = 0; first < positions; first += per_block) {
      const std::size_t count = std::min(per_block, positions - first);
      if (!block(first, count)) return cancelled();
      if (!take(columns_)) return cancelled();
      report(begun + (1 - begun) * static_cast<double>(first + count) / static_cast<double>(positions));
    }
    statistics_.median_relative_error = errors_.median();
    return statistics_;
  }

 private:
  void report(double done) const {
    if (options_.watch.progress) options_.watch.progress(done);
  }

  bool block(std::size_t first, std::size_t count) {
    const std::span<const Vec3> positions_m(candidates_.positions_world_m.data() + first, count);
    use_.assign(usable_.begin() + static_cast<std::ptrdiff_t>(first),
                usable_.begin() + static_cast<std::ptrdiff_t>(first + count));
    for (const std::uint8_t used : use_)
      if (!used) statistics_.columns_other_air += luminaires_.size();
    if (!direct_of_block(visibility_, receivers_, positions_m, use_, luminaires_, options_, direct_lux_, statistics_))
      return false;
    const std::size_t columns = count * luminaires_.size(), rows = receivers_.size();
    indirect_lux_.assign(reflected_ ? columns * rows : 0, 0.0f);
    indirect_error_lux_.assign(reflected_ ? columns * rows : 0, 0.0f);
    if (reflected_ && !reflected_->block(first, count, rows, indirect_lux_, indirect_error_lux_)) return false;
    gather(first, columns);
    return true;
  }

  /// A position is usable if any of its luminaires is in air that reaches a receiver.
  void find_usable() {
    const std::size_t positions = candidates_.positions_world_m.size();
    usable_.assign(positions, 1);
    if (!air_) return;
    constexpr std::size_t kPerTask = 256;
    parallel_for((positions + kPerTask - 1) / kPerTask, options_.threads, [&](std::size_t task) {
      for (std::size_t p = kPerTask * task; p < std::min(positions, kPerTask * (task + 1)); ++p)
        usable_[p] = std::any_of(luminaires_.begin(), luminaires_.end(), [&](const CandidateLuminaire& luminaire) {
          return air_->reaches(candidates_.positions_world_m[p] + luminaire.offset_world_m);
        });
    });
  }

  float direct(std::size_t r, std::size_t column) const {
    return direct_lux_[r * (direct_lux_.size() / receivers_.size()) + column];
  }

  /// Entries of the block, columns in order.
  void gather(std::size_t first_position, std::size_t columns) {
    const std::size_t rows = receivers_.size();
    const auto least = static_cast<float>(options_.skips.reach ? options_.min_lux : 0);
    const auto total = [&](std::size_t r, std::size_t c) {
      return direct(r, c) + (reflected_ ? indirect_lux_[c * rows + r] : 0.0f);
    };
    columns_.first_column = first_position * luminaires_.size();
    columns_.begin.assign(columns + 1, 0);
    const auto kept = [&](float lux) { return lux > 0 && lux >= least; };
    const std::size_t tasks = (columns + 255) / 256;
    parallel_for(tasks, options_.threads, [&](std::size_t task) {
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 256 * task; c < std::min(columns, 256 * (task + 1)); ++c)
          columns_.begin[c + 1] += kept(total(r, c));
    });
    for (std::size_t c = 0; c < columns; ++c) {
      statistics_.columns_unlit += columns_.begin[c + 1] == 0 && use_[c / luminaires_.size()];
      columns_.begin[c + 1] += columns_.begin[c];
    }
    const std::uint64_t entries = columns_.begin.back();
    columns_.receiver.resize(entries);
    columns_.direct_lux.resize(entries);
    columns_.total_lux.resize(entries);
    columns_.standard_error_lux.resize(entries);
    std::vector<ErrorHistogram> histograms(tasks);
    parallel_for(tasks, options_.threads, [&](std::size_t task) {
      for (std::size_t c = 256 * task; c < std::min(columns, 256 * (task + 1)); ++c) {
        std::uint64_t at = columns_.begin[c];
        for (std::size_t r = 0; r < rows; ++r) {
          const float lux = total(r, c);
          if (!kept(lux)) continue;
          const float error = reflected_ ? indirect_error_lux_[c * rows + r] : 0.0f;
          columns_.receiver[at] = static_cast<std::uint32_t>(r);
          columns_.direct_lux[at] = direct(r, c);
          columns_.total_lux[at] = lux;
          columns_.standard_error_lux[at] = error;
          histograms[task].add(error / lux);
          ++at;
        }
      }
    });
    for (const ErrorHistogram& h : histograms) errors_.add(h);
  }

  const Scene& scene_;
  const RayScene& rays_;
  std::span<const Receiver> receivers_;
  const CandidateSet& candidates_;
  const CandidateOptions& options_;
  std::vector<CandidateLuminaire> luminaires_;
  std::optional<Blockers> blockers_;
  VisibilityScene visibility_{};
  std::optional<ReceiversAir> air_;
  std::vector<std::uint8_t> usable_;  ///< per position
  std::optional<ReflectedColumns> reflected_;
  CandidateStatistics statistics_;
  ErrorHistogram errors_;
  // Of the current block:
  std::vector<std::uint8_t> use_;    ///< per position
  std::vector<float> direct_lux_;    ///< receivers × columns
  std::vector<float> indirect_lux_;  ///< columns × receivers
  std::vector<float> indirect_error_lux_;
  CandidateColumns columns_;
};

template <class T>
void append_all(std::vector<T>& to, std::vector<CandidateColumns>& blocks, std::vector<T> CandidateColumns::*part,
                std::size_t size) {
  to.reserve(size);
  for (CandidateColumns& block : blocks) {
    to.insert(to.end(), (block.*part).begin(), (block.*part).end());
    std::vector<T>().swap(block.*part);
  }
}

}  // namespace

Result<CandidateStatistics> stream_candidates(const Scene& scene, const RayScene& rays,
                                              std::span<const Receiver> receivers, const CandidateSet& candidates,
                                              const CandidateOptions& options, const TakeColumns& take) {
  if (auto checked = check(receivers, candidates, options); !checked) return tl::unexpected(std::move(checked.error()));
  return Stream(scene, rays, receivers, candidates, options).run(take);
}

Result<CandidateTransport> candidate_transport(const Scene& scene, const RayScene& rays,
                                               std::span<const Receiver> receivers, const CandidateSet& candidates,
                                               const CandidateOptions& options) {
  CandidateOptions working = options;
  working.memory_bound_bytes = options.memory_bound_bytes / 4;
  // Blocks are joined one array at a time, so that at most five quarters of the matrix exist at once.
  const std::size_t matrix_bound = (options.memory_bound_bytes - working.memory_bound_bytes) / 5 * 4;
  std::vector<CandidateColumns> blocks;
  std::size_t bytes = 0;
  const auto statistics =
      stream_candidates(scene, rays, receivers, candidates, working, [&](const CandidateColumns& block) {
        bytes += block.bytes();
        if (bytes > matrix_bound) return false;
        blocks.push_back(block);
        return true;
      });
  if (bytes > matrix_bound) {
    const std::size_t done = blocks.empty() ? 0 : blocks.back().first_column + blocks.back().columns();
    return refusal(
        fmt::format("{} of {} columns fill the {} bytes that the matrix may have; stream the columns, raise "
                    "the least lux or the bound",
                    done, candidates.columns(), matrix_bound));
  }
  if (!statistics) return tl::unexpected(statistics.error());
  CandidateTransport result;
  result.statistics = *statistics;
  CandidateColumns& matrix = result.matrix;
  std::size_t entries = 0;
  for (const CandidateColumns& block : blocks) {
    for (std::size_t c = 0; c < block.columns(); ++c) matrix.begin.push_back(entries + block.begin[c + 1]);
    entries += block.entries();
  }
  append_all(matrix.receiver, blocks, &CandidateColumns::receiver, entries);
  append_all(matrix.direct_lux, blocks, &CandidateColumns::direct_lux, entries);
  append_all(matrix.total_lux, blocks, &CandidateColumns::total_lux, entries);
  append_all(matrix.standard_error_lux, blocks, &CandidateColumns::standard_error_lux, entries);
  return result;
}

}  // namespace luxrig
