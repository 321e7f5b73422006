#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/highlight/aim/aim_heads_state.h"
#include "core/parallel.h"

namespace luxrig {
namespace {

/// Shares of the level that the limits allow, or of the highest level; besides 0.
constexpr double kLevelShares[] = {1, 0.75, 0.5, 0.35, 0.2, 0.1, 0.05};
/// If heads share a limit, a head's room may be what the others give up.
constexpr double kOthersShares[] = {1, 0.7, 0.4};
constexpr int kMaxSweeps = 12;
constexpr double kMinGain = 1e-6;  ///< of the objective
/// First and last step of aim refinement, as shares of the beam.
constexpr double kFirstStep = 0.25, kLastStep = 0.015;
constexpr double kWidestStep_rad = rad_from_deg(20);

std::optional<Joints> joints_towards(const HangingHead& head, const Vec3& direction, std::size_t zoom) {
  auto joints = head.moves ? pan_tilt_towards(head.world_from_mount, direction, head.range, head.present)
                           : std::optional(head.present);
  if (!joints) return joints;
  joints->beam_rad = head.zoom[zoom].beam_rad;
  return may_light(head, *joints) ? joints : std::nullopt;
}

/// Two unit vectors at right angles to a unit vector and to each other.
std::pair<Vec3, Vec3> across(const Vec3& direction) {
  const Vec3 x = direction.unitOrthogonal();
  return {x, direction.cross(x)};
}

class AimSearch {
 public:
  AimSearch(const HeadAims::State& state, const std::vector<std::vector<Vec3>>& first_aims)
      : state_(state), judge_(&state.search_judge()), limited_(judge_->wishes.limited()) {
    for (std::size_t k = 0; k < state.heads.size(); ++k) {
      columns_.emplace_back();
      if (first_aims[k].empty()) continue;
      const HangingHead& head = state.heads[k];
      for (std::size_t zoom = 0; zoom < head.zoom.size(); ++zoom)
        for (const Vec3& aim : first_aims[k])
          if (const auto joints = joints_towards(head, aim, zoom)) columns_[k].push_back({{*joints, zoom, 0}, {}});
      parallel_for(columns_[k].size(), state.options.threads, [&, k](std::size_t c) {
        columns_[k][c].column = judge_->column(state_.heads[k], k, columns_[k][c].setting);
      });
    }
  }

  SearchedAims run() {
    Look best;
    for (const Start start : {Start::dark, Start::bright, Start::shared, Start::present}) {
      if (!limited_ && (start == Start::shared || start == Start::present)) continue;
      Look look = begun(start);
      for (int sweep = 0; sweep < kMaxSweeps && !stopped() && swept(look); ++sweep) {
      }
      if (best.settings.empty() || look.objective > best.objective) best = std::move(look);
    }
    if (state_.full.wishes.seen && judge_ != &state_.full) judge_in_full(best);
    for (double step = kFirstStep; step >= kLastStep && !stopped();) {
      const double was = best.objective;
      for (std::size_t k = 0; k < state_.heads.size(); ++k) refine(best, k, step);
      if (best.objective < was + kMinGain) step /= 2;
    }
    return {std::move(best.settings), tried_};
  }

 private:
  struct Candidate {
    HeadSetting setting;
    AimColumn column;
  };
  struct Look {
    std::vector<HeadSetting> settings;
    std::vector<AimColumn> columns;  ///< of the settings; undefined for a dark head
    double objective = 0;
  };
  enum class Start { dark, bright, shared, present };
  struct Tried {
    double level = 0, objective = -std::numeric_limits<double>::infinity();
  };

  [[nodiscard]] bool stopped() const { return state_.options.watch.stop.stop_requested(); }
  [[nodiscard]] HeadRole role_of(std::size_t head) const { return role_in(judge_->wishes, head); }

  /// The sum of all heads but one, each at a share of its level.
  [[nodiscard]] AimSum without(const Look& look, std::size_t head, double share = 1) const {
    AimSum sum = judge_->objective->nothing();
    for (std::size_t k = 0; k < look.settings.size(); ++k) {
      if (k == head) continue;
      HeadSetting setting = look.settings[k];
      setting.level *= share;
      add(sum, k, setting, look.columns[k]);
    }
    return sum;
  }
  void add(AimSum& sum, std::size_t k, const HeadSetting& setting, const AimColumn& column) const {
    const HangingHead& head = state_.heads[k];
    judge_->objective->add(sum, column, setting.level, role_of(k), head.watts,
                           travel_s(head, head.present, setting.joints));
  }

  /// Starts: dark; each head with its first aim as bright as the others allow; each with an equal share of its level
  /// alone; or the present aims with such a share.
  [[nodiscard]] Look begun(Start start) const {
    Look look;
    const std::size_t count = state_.heads.size();
    for (std::size_t k = 0; k < count; ++k) {
      look.settings.push_back({state_.heads[k].present, 0, 0});
      look.columns.emplace_back();
      if (start == Start::dark || columns_[k].empty()) continue;
      if (start == Start::present) {
        if (!may_light(state_.heads[k], look.settings[k].joints)) continue;
        look.columns[k] = judge_->column(state_.heads[k], k, look.settings[k]);
      } else {
        look.settings[k] = columns_[k].front().setting;
        look.columns[k] = columns_[k].front().column;
      }
    }
    for (std::size_t k = 0; start != Start::dark && k < count; ++k) {
      if (columns_[k].empty() || !may_light(state_.heads[k], look.settings[k].joints)) continue;
      const AimSum others = start == Start::bright ? without(look, k) : judge_->objective->nothing();
      // A ratio between heads has no meaning while the others are dark.
      const bool alone = start != Start::bright;
      look.settings[k].level =
          judge_->objective->highest_level(others, look.columns[k], role_of(k), state_.heads[k].max_level,
                                           state_.heads[k].watts, !alone) /
          (alone ? static_cast<double>(count) : 1.0);
    }
    look.objective = judge_->objective->objective(without(look, count));
    return look;
  }

  /// The best level of a head with this light, with the others fixed.
  [[nodiscard]] Tried best_level(const AimSum& others, std::size_t k, const HeadSetting& setting,
                                 const AimColumn& column) const {
    const double most =
        judge_->objective->highest_level(others, column, role_of(k), state_.heads[k].max_level, state_.heads[k].watts);
    const auto at = [&](double level) {
      AimSum sum = others;
      HeadSetting lit = setting;
      lit.level = level;
      add(sum, k, lit, column);
      return Tried{level, judge_->objective->objective(sum)};
    };
    Tried best = at(0);
    if (!(most > 0)) return best;
    // What is seen is the same at every level of a single light: then the highest.
    for (const double share : kLevelShares)
      if (const Tried tried = at(share * most); tried.objective > best.objective + (best.level > 0 ? kMinGain : 0))
        best = tried;
    return best;
  }

  /// Moves each head in turn to its best candidate, with the others fixed or, if limits are shared, dimmed. False when
  /// none gains.
  bool swept(Look& look) {
    bool gained = false;
    for (std::size_t k = 0; k < columns_.size() && !stopped(); ++k) {
      if (columns_[k].empty()) continue;
      const std::size_t candidates = columns_[k].size();
      std::vector<AimSum> others;
      for (const double share : kOthersShares)
        if (share == 1 || limited_) others.push_back(without(look, k, share));
      std::vector<Tried> tried(candidates * others.size());
      parallel_for(tried.size(), state_.options.threads, [&](std::size_t t) {
        const Candidate& candidate = columns_[k][t % candidates];
        tried[t] = best_level(others[t / candidates], k, candidate.setting, candidate.column);
      });
      tried_ += tried.size();
      const auto best = std::max_element(tried.begin(), tried.end(), [](const Tried& a, const Tried& b) {
        return a.objective < b.objective;  // the first of equal ones
      });
      if (best->objective < look.objective + kMinGain) continue;
      const auto at = static_cast<std::size_t>(best - tried.begin());
      const Candidate& taken = columns_[k][at % candidates];
      for (std::size_t j = 0; j < look.settings.size(); ++j)
        if (j != k) look.settings[j].level *= kOthersShares[at / candidates];
      set(look, k, taken.setting, best->level, taken.column, best->objective);
      gained = true;
    }
    return gained;
  }

  /// From here on by all samples and the fine picture, which aims are refined by.
  void judge_in_full(Look& look) {
    judge_ = &state_.full;
    parallel_for(look.settings.size(), state_.options.threads, [&](std::size_t k) {
      if (look.settings[k].level > 0) look.columns[k] = judge_->column(state_.heads[k], k, look.settings[k]);
    });
    look.objective = judge_->objective->objective(without(look, look.settings.size()));
  }

  void set(Look& look, std::size_t k, HeadSetting setting, double level, AimColumn column, double objective) const {
    setting.level = level;
    if (!(level > 0)) {  // no reason to turn
      setting.joints = state_.heads[k].present;
      setting.zoom = 0;
    }
    look.settings[k] = setting;
    look.columns[k] = std::move(column);
    look.objective = objective;
  }

  /// Tries one head's aim a step to each side, its other zoom stops, and its level.
  void refine(Look& look, std::size_t k, double step_of_beam) {
    const HangingHead& head = state_.heads[k];
    if (!(look.settings[k].level > 0) || stopped()) return;
    const AimSum others = without(look, k);
    const HeadSetting was = look.settings[k];
    std::vector<Candidate> ways = {{was, look.columns[k]}};
    for (std::size_t zoom = 0; zoom < head.zoom.size(); ++zoom) {
      if (zoom == was.zoom) continue;
      Candidate zoomed{was, {}};
      zoomed.setting.zoom = zoom;
      zoomed.setting.joints.beam_rad = head.zoom[zoom].beam_rad;
      if (!may_light(head, zoomed.setting.joints)) continue;
      ways.push_back(std::move(zoomed));
    }
    if (head.moves) {
      const double step_rad = std::min(kWidestStep_rad, step_of_beam * state_.cone_rad[k][was.zoom]);
      const Vec3 beam = lamp_pose(head, was.joints).direction({0, 0, -1});
      const auto [x, y] = across(beam);
      for (int side = 0; side < 8; ++side) {
        const double angle_rad = side * kPi / 4;
        const Vec3 direction =
            std::cos(step_rad) * beam + std::sin(step_rad) * (std::cos(angle_rad) * x + std::sin(angle_rad) * y);
        if (const auto joints = joints_towards(head, direction, was.zoom)) ways.push_back({{*joints, was.zoom, 0}, {}});
      }
    }
    std::vector<Tried> tried(ways.size());
    parallel_for(ways.size(), state_.options.threads, [&](std::size_t w) {
      if (w > 0) ways[w].column = judge_->column(head, k, ways[w].setting);
      tried[w] = best_level(others, k, ways[w].setting, ways[w].column);
    });
    tried_ += tried.size();
    std::size_t best = 0;
    for (std::size_t w = 1; w < tried.size(); ++w)
      if (tried[w].objective > tried[best].objective) best = w;
    if (tried[best].objective > look.objective + kMinGain)
      set(look, k, ways[best].setting, tried[best].level, std::move(ways[best].column), tried[best].objective);
  }

  const HeadAims::State& state_;
  const AimJudge* judge_;
  bool limited_;  ///< heads share a limit
  std::vector<std::vector<Candidate>> columns_;
  std::size_t tried_ = 0;
};

}  // namespace

std::vector<Vec3> voted_aims(const HangingHead& head, double narrowest_rad, const HeadSight& sight,
                             const ContrastSamples& samples, std::size_t most) {
  std::vector<Vec3> aims;
  Vec3 middle = Vec3::Zero();
  for (std::size_t i = 0; i < sight.direction.size(); ++i)
    if (sight.lux_per_cd[i] > 0) middle += sight.lux_per_cd[i] * sight.direction[i];
  if (middle.isZero(0)) return aims;
  middle.normalize();
  if (!head.moves) {
    aims.push_back(lamp_pose(head, head.present).direction({0, 0, -1}));
    return aims;
  }
  // Votes are collected in squares of half a beam on a plane across the direction to the middle.
  const double cell = std::tan(std::clamp(narrowest_rad / 2, rad_from_deg(0.5), rad_from_deg(40)));
  const auto [x, y] = across(middle);
  struct Cell {
    int column, row;
    double votes;
    Vec3 sum;
  };
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < samples.interest; ++i) {
    const bool lit = sight.lux_per_cd[i] > 0;
    double vote = 0;
    for (const std::uint32_t j : samples.of(i))
      if ((sight.lux_per_cd[j] > 0) != lit) vote = std::max({vote, sight.lux_per_cd[i], sight.lux_per_cd[j]});
    const Vec3& direction = sight.direction[i];
    const double ahead = direction.dot(middle);
    if (!(vote > 0) || ahead < 0.05) continue;
    const int column = static_cast<int>(std::floor(direction.dot(x) / ahead / cell)),
              row = static_cast<int>(std::floor(direction.dot(y) / ahead / cell));
    const auto at =
        std::find_if(cells.begin(), cells.end(), [&](const Cell& c) { return c.column == column && c.row == row; });
    Cell& mine = at == cells.end() ? cells.emplace_back(Cell{column, row, 0, Vec3::Zero()}) : *at;
    mine.votes += vote;
    mine.sum += vote * direction;
  }
  std::stable_sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.votes > b.votes; });
  const auto can = [&](const Vec3& direction) {
    for (std::size_t zoom = 0; zoom < head.zoom.size(); ++zoom)
      if (joints_towards(head, direction, zoom)) return true;
    return false;
  };
  for (const Cell& one : cells)
    if (aims.size() + 1 < most && can(one.sum)) aims.push_back(one.sum.normalized());
  if (can(middle)) aims.push_back(middle);
  return aims;
}

SearchedAims search_aims(const HeadAims::State& state, const std::vector<std::vector<Vec3>>& first_aims) {
  return AimSearch(state, first_aims).run();
}

}  // namespace luxrig
