// Scan of a hemisphere with a tenth of the rays: sparse rays, then along every border between blocked and open.
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/highlight/shadow/shadow_edges.h"

namespace luxrig {
namespace {

using MaskRow = HorizonMask::Row;

constexpr int kCoarsestStep = 8;
/// A first ray may meet or miss a patch smaller than the gaps between them. One such hit means several missed patches,
/// so every direction is then traced.
constexpr int kLonelyRays = 1;

/// One of the first rays; it represents `gap` azimuths around it.
struct SparseRay {
  int azimuth, elevation, gap;
};

/// Per step: rows `step` apart; within a row, azimuths about as far apart on the sphere.
const std::array<std::vector<SparseRay>, kCoarsestStep + 1>& sparse_rays() {
  static const auto all = [] {
    std::array<std::vector<SparseRay>, kCoarsestStep + 1> made;
    for (int step = 1; step <= kCoarsestStep; ++step) {
      std::vector<SparseRay>& order = made[static_cast<std::size_t>(step)];
      for (int j = 0; j < kScanElevations; j += step) {
        const double along = std::cos(kPi / 2 * (j + 0.5) / kScanElevations);
        const int gap = std::clamp(static_cast<int>(step / along), step, kScanAzimuths / 8);
        for (int i = 0; i < kScanAzimuths; i += gap) order.push_back({i, j, gap});
      }
      // Sixteen rays cast together are four in each of four rows.
      const auto key = [&](const SparseRay& s) {
        return std::array{s.elevation / (4 * step), s.azimuth / (4 * s.gap), s.elevation, s.azimuth};
      };
      std::sort(order.begin(), order.end(), [&](const SparseRay& a, const SparseRay& b) { return key(a) < key(b); });
    }
    return made;
  }();
  return all;
}

/// One point's search. Bits of `blocked_` are answers where `known_`, guesses elsewhere.
class HorizonSearch {
 public:
  HorizonSearch(const TargetRays& target, const OrientedPoint& point, double lift_m)
      : target_(target), point_(point), lift_m_(lift_m), frame_(point.normal) {}

  HorizonMask run(int step, std::uint64_t& rays) {
    ask_sparsely(step);
    if (lonely_rays(step) >= kLonelyRays) {
      rays += rays_ + kScanAzimuths * kScanElevations;
      return scan_every_direction(target_, point_, lift_m_);
    }
    guess_rows_between(step);
    HorizonMask wanted;
    while (next_to_a_border(wanted)) {
      // In blocks of 8 × 4, so that rays cast together lie together.
      for (int j = 0; j < kScanElevations; j += 4)
        for (int w = 0; w < HorizonMask::kWords; ++w)
          for (int shift = 0; shift < 64; shift += 8)
            for (int row = j; row < std::min(j + 4, kScanElevations); ++row) {
              const std::uint64_t word = wanted.rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(w)];
              for (std::uint64_t bits = word >> shift & 0xFFu; bits != 0; bits &= bits - 1)
                ask(64 * w + shift + std::countr_zero(bits), row);
            }
      cast();
    }
    rays += rays_;
    return blocked_;
  }

 private:
  void ask(int azimuth, int elevation) {
    asked_.push_back({static_cast<std::uint16_t>(azimuth), static_cast<std::uint16_t>(elevation)});
  }

  void cast() {
    directions_.clear();
    for (const ShadowEdge& at : asked_) directions_.push_back(frame_.direction(at.azimuth, at.elevation));
    answers_.resize(asked_.size());
    target_.blocked(point_.position_world_m, point_.normal, lift_m_, directions_, answers_);
    for (std::size_t k = 0; k < asked_.size(); ++k) {
      known_.set(asked_[k].azimuth, asked_[k].elevation, true);
      blocked_.set(asked_[k].azimuth, asked_[k].elevation, answers_[k] != 0);
    }
    rays_ += asked_.size();
    asked_.clear();
  }

  void ask_sparsely(int step) {
    const std::vector<SparseRay>& order = sparse_rays()[static_cast<std::size_t>(step)];
    for (const SparseRay& s : order) ask(s.azimuth, s.elevation);
    cast();
    for (const SparseRay& s : order) {
      if (!blocked_.test(s.azimuth, s.elevation)) continue;
      for (int i = s.azimuth - (s.gap - 1) / 2; i <= s.azimuth + s.gap / 2; ++i) {
        const int around = (i + kScanAzimuths) % kScanAzimuths;
        if (!known_.test(around, s.elevation)) blocked_.set(around, s.elevation, true);
      }
    }
  }

  /// Number of first rays that differ from all four around them.
  [[nodiscard]] int lonely_rays(int step) const {
    int count = 0;
    for (const SparseRay& s : sparse_rays()[static_cast<std::size_t>(step)]) {
      const bool mine = blocked_.test(s.azimuth, s.elevation);
      const auto differs = [&](int azimuth, int elevation) {
        return elevation < 0 || elevation >= kScanElevations ||
               blocked_.test((azimuth + kScanAzimuths) % kScanAzimuths, elevation) != mine;
      };
      if (differs(s.azimuth - s.gap, s.elevation) && differs(s.azimuth + s.gap, s.elevation) &&
          differs(s.azimuth, s.elevation - step) && differs(s.azimuth, s.elevation + step))
        ++count;
    }
    return count;
  }

  void guess_rows_between(int step) {
    const int last = (kScanElevations - 1) / step * step;
    for (int j = 0; j < kScanElevations; ++j) {
      const int nearest = std::min((j + (step - 1) / 2) / step * step, last);
      if (nearest != j) blocked_.rows[static_cast<std::size_t>(j)] = blocked_.rows[static_cast<std::size_t>(nearest)];
    }
  }

  /// Marks the next rays: guesses that differ from a neighbour. Of two differing guesses the blocked one goes first,
  /// since its answer often settles the other. False when nothing is left.
  [[nodiscard]] bool next_to_a_border(HorizonMask& wanted) const {
    const MaskRow full = HorizonMask::full_row();
    std::uint64_t any = 0;
    for (std::size_t j = 0; j < kScanElevations; ++j) {
      const MaskRow& b = blocked_.rows[j];
      const MaskRow& k = known_.rows[j];
      MaskRow known_blocked;
      for (std::size_t w = 0; w < b.size(); ++w) known_blocked[w] = b[w] & k[w];
      const MaskRow next_b = HorizonMask::to_next(b), previous_b = HorizonMask::to_previous(b);
      const MaskRow next_kb = HorizonMask::to_next(known_blocked),
                    previous_kb = HorizonMask::to_previous(known_blocked);
      for (std::size_t w = 0; w < b.size(); ++w) {
        // Neighbours beyond the base and the apex equal the direction itself, so there is no border.
        const std::uint64_t below_b = j > 0 ? blocked_.rows[j - 1][w] : ~std::uint64_t{0};
        const std::uint64_t above_b = j + 1 < kScanElevations ? blocked_.rows[j + 1][w] : ~std::uint64_t{0};
        const std::uint64_t below_kb = j > 0 ? below_b & known_.rows[j - 1][w] : 0;
        const std::uint64_t above_kb = j + 1 < kScanElevations ? above_b & known_.rows[j + 1][w] : 0;
        const std::uint64_t blocked_guess = b[w] & ~(next_b[w] & previous_b[w] & below_b & above_b);
        const std::uint64_t open_guess = ~b[w] & (next_kb[w] | previous_kb[w] | below_kb | above_kb);
        wanted.rows[j][w] = (blocked_guess | open_guess) & ~k[w] & full[w];
        any |= wanted.rows[j][w];
      }
    }
    return any != 0;
  }

  const TargetRays& target_;
  const OrientedPoint& point_;
  double lift_m_;
  ScanFrame frame_;
  HorizonMask known_, blocked_;
  std::vector<ShadowEdge> asked_;
  std::vector<Vec3f> directions_;
  std::vector<std::uint8_t> answers_;
  std::uint64_t rays_ = 0;
};

}  // namespace

HorizonMask search_horizon(const TargetRays& target, const OrientedPoint& point, double lift_m, int step,
                           std::uint64_t& rays) {
  return HorizonSearch(target, point, lift_m).run(step, rays);
}

}  // namespace luxrig
