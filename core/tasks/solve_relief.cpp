// Tasks for an object's relief: aim heads, find lights.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rig/housing.h"
#include "core/tasks/directions_task.h"
#include "core/tasks/highlight_task.h"
#include "core/tasks/solve_tasks.h"
#include "core/tasks/task_solver.h"

namespace luxrig {
namespace {

/// Share of max_object_lx that is left to the tasks that follow: each knows the light before it to less than that, and
/// light beside a used-up limit would be none.
constexpr double kLeftForLater = 0.01;

/// Dimmed by a limit to less than this share, lights are not seen as they were judged.
constexpr double kSeenAsJudged = 0.95;

/// share   by which its lights were dimmed in the end
ReliefReasons reasons_of(const Task& task, const ReliefSpec& relief, const AimScore& score, double share) {
  ReliefReasons reasons;
  reasons.task = task.name;
  reasons.seen = relief.seen;
  reasons.role = relief.role;
  reasons.set_up = relief.set_up;
  reasons.score = score;
  if (share < kSeenAsJudged) {
    reasons.dimmed_to = share;
    reasons.score.seen.reset();
  }
  reasons.score.local_contrast_lx *= share;
  if (reasons.score.role) {
    reasons.score.role->wanted_lx *= share;
    reasons.score.role->spared_lx *= share;
  }
  return reasons;
}

void add_dark(ReliefReasons& reasons, double gain) {
  ++reasons.dark;
  if (std::isfinite(gain)) reasons.gain_of_dark = std::max(gain, reasons.gain_of_dark.value_or(gain));
}

}  // namespace

Result<ReliefSurroundings> TaskSolver::surroundings(std::vector<bool> sought, const Task& task) const {
  const auto max_watts = watts_left(0, 0, task);
  if (!max_watts) return tl::unexpected(max_watts.error());
  ReliefSurroundings around{rig_,      session_.scene, *session_.rays, look(), std::move(sought), lux_of_points(),
                            *max_watts};
  if (auto kept = limits_left(around.point_lux); !kept) return tl::unexpected(kept.error());
  return around;
}

Result<double> TaskSolver::settle_relief(const Task& task, const ReliefSpec& spec, const ReliefSurroundings& around,
                                         const StudiedObject& object, const AimScore& score, const AimScore* before,
                                         const AskedOfLight& asked, PlannedTask& planned) {
  // A stop ends the search, not the use of its result.
  ComputeOptions to_the_end = options_;
  to_the_end.watch = options_.watch.without_stop();
  const auto light = light_on_object(around, object, look(), to_the_end);
  if (!light) return tl::unexpected(light.error());
  const bool more_follow = &task != &session_.rig.tasks.back();
  double share = spec.max_lx ? light->share_within(*spec.max_lx * (1 - (more_follow ? kLeftForLater : 0))) : 1;
  const Eigen::VectorXd lux = lux_of_points();
  for (std::size_t i = 0; i < rig_.points.size(); ++i) {
    const auto row = static_cast<Index>(i);
    const std::optional<double>& max_lx = rig_.points[i].max_lx;
    const double sought_lx = lux[row] - around.point_lux[row];
    if (max_lx && lux[row] > *max_lx && sought_lx > 0)
      share = std::min(share, std::max(0.0, (*max_lx - around.point_lux[row]) / sought_lx));
  }
  for (std::size_t f = 0; f < around.sought.size(); ++f)
    if (around.sought[f]) level_[static_cast<Index>(f)] *= share;
  PlannedRelief relief;
  relief.local_contrast_lx = share * score.local_contrast_lx;
  relief.coverage = score.coverage;
  relief.relative_contrast = score.relative_contrast;
  relief.object_lux = light->brightest_lx(share);
  if (score.role) relief.key_to_fill = ratio_of(spec.role, asked, share * score.role->wanted_lx);
  if (std::isfinite(score.key_to_fill)) relief.key_to_fill = score.key_to_fill;
  if (before) {
    relief.before_local_contrast_lx = before->local_contrast_lx;
    relief.before_coverage = before->coverage;
    relief.before_relative_contrast = before->relative_contrast;
  }
  if (score.seen && share >= kSeenAsJudged) {
    relief.seen = score.seen->objective;
    relief.lit_share = score.seen->lit_share;
    relief.clipped_share = score.seen->burnt_share + score.seen->crushed_share;
  }
  if (before && before->seen && relief.seen) relief.before_seen = before->seen->objective;
  planned.name = task.name;
  planned.kind = name_of(task.kind);
  planned.relief = relief;
  why_.assign(rig_.points.size(), "");
  return share;
}

Result<void> TaskSolver::aim(const Task& task) {
  const auto start = Steady::now();
  const std::vector<std::size_t>& heads = task.aim.heads;
  std::vector<bool> sought(rig_.fixtures.size(), false);
  std::vector<double> present;
  for (const std::size_t head : heads) {
    // The level at which all its emitters together give the present flux.
    double now_lm = 0;
    for (const std::size_t emitter : housing_of(rig_, head)) {
      sought[emitter] = true;
      double& level = level_[static_cast<Index>(emitter)];
      now_lm += level * rig_.luminaires[rig_.fixtures[emitter].luminaire].lumens;
      level = 0;
    }
    present.push_back(levels_set_before(rig_, task.name) ? now_lm / housing_luminaire(rig_, head).lumens
                                                         : rig_.fixtures[head].max_level);
  }
  const auto around = surroundings(std::move(sought), task);
  if (!around) return tl::unexpected(around.error());
  const auto object = study_object(session_, task.aim.relief, options_);
  if (!object) return tl::unexpected(object.error());
  const auto aimed = aim_fixtures(*around, *object, task, present, options_);
  if (!aimed) return tl::unexpected(aimed.error());
  for (std::size_t k = 0; k < heads.size(); ++k) {
    const AimedHead& head = aimed->heads[k];
    const std::vector<std::size_t> housing = housing_of(rig_, heads[k]);
    for (std::size_t e = 0; e < housing.size(); ++e) {
      const std::size_t emitter = housing[e];
      level_[static_cast<Index>(emitter)] = head.setting.level * aimed->mixes[k].levels[e];
      if (!rig_.fixtures[emitter].moves || !(head.setting.level > 0)) continue;  // a dark head keeps its aim
      look_.joints[emitter] = head.setting.joints;
      look_.aim_world_m[emitter] = head.aim_world_m;
    }
  }
  if (auto lit = light_anew(look()); !lit) return lit;

  PlannedTask planned;
  const auto share =
      settle_relief(task, task.aim.relief, *around, *object, aimed->score, &aimed->before, aimed->asked, planned);
  if (!share) return tl::unexpected(share.error());
  list(planned, 0, own_);
  planned.iterations = static_cast<int>(aimed->tried);
  ReliefReasons reasons = reasons_of(task, task.aim.relief, aimed->score, *share);
  reasons.before = aimed->before;
  std::vector<LitAlone> lit;
  for (std::size_t k = 0; k < heads.size(); ++k) {
    lit.push_back({housing_name(rig_, heads[k]), aimed->heads[k].setting.level, &aimed->without[k]});
    if (!(lit.back().level > 0)) add_dark(reasons, aimed->gain_if_lit[k]);
  }
  reasons.lights = services_of(aimed->score, lit);
  reasons_.push_back(std::move(reasons));
  planned.seconds = seconds_since(start);
  plan_.tasks.push_back(std::move(planned));
  return {};
}

Result<void> TaskSolver::highlight(const Task& task) {
  const auto start = Steady::now();
  const HighlightSpec& spec = task.highlight;
  const auto mounting = Mounting::make(rig_.mounting, rig_.file, session_.scene, *session_.rays);
  if (!mounting) return refusal(mounting.error()[0].text());  // session_of() has already made it
  const auto dark = surroundings(std::vector<bool>(rig_.fixtures.size(), false), task);
  if (!dark) return tl::unexpected(dark.error());
  const auto object = study_object(session_, spec.relief, options_);
  if (!object) return tl::unexpected(object.error());
  const auto found = find_relief_lights(*dark, *object, task, *mounting, options_);
  if (!found) return tl::unexpected(found.error());

  const Index before = level_.size();
  if (auto hung = hang(task, spec.luminaire, found->lights); !hung) return hung;
  std::vector<bool> sought(rig_.fixtures.size(), false);
  const std::size_t emitters = rig_.emitters_or_itself(spec.luminaire).size();
  for (std::size_t l = 0; l < emitters * found->lights.size(); ++l) {
    sought[static_cast<std::size_t>(before) + l] = true;
    level_[before + static_cast<Index>(l)] = found->lights[l / emitters].level;
  }
  const ReliefSurroundings around{
      rig_, session_.scene, *session_.rays, look(), std::move(sought), dark->point_lux, dark->max_watts};
  PlannedTask planned;
  const auto share = settle_relief(task, spec.relief, around, *object, found->score, nullptr, found->asked, planned);
  if (!share) return tl::unexpected(share.error());
  list(planned, before, level_.size());
  for (Index j = 0; j < own_; ++j) planned.fixtures.push_back(light_of(j));
  for (std::size_t k = 0; k < found->contrast_lx.size(); ++k)
    planned.numbers.push_back(
        {static_cast<int>(k) + 1, std::numeric_limits<double>::quiet_NaN(), found->contrast_lx[k]});
  planned.iterations = static_cast<int>(found->tried);
  ReliefReasons reasons = reasons_of(task, spec.relief, found->score, *share);
  std::vector<LitAlone> lit;
  for (std::size_t l = 0; l < found->lights.size(); ++l)
    lit.push_back({housing_name(rig_, static_cast<std::size_t>(before) + l * emitters), found->lights[l].level,
                   &found->without[l]});
  for (const double gain : found->dark_gains) add_dark(reasons, gain);
  reasons.lights = services_of(found->score, lit);
  reasons_.push_back(std::move(reasons));
  planned.seconds = seconds_since(start);
  plan_.tasks.push_back(std::move(planned));
  return {};
}

Result<void> TaskSolver::directions(const Task& task) {
  const auto start = Steady::now();
  auto found = find_directions(session_, task, options_);
  if (!found) return tl::unexpected(found.error());
  PlannedTask planned;
  planned.name = task.name;
  planned.kind = name_of(task.kind);
  planned.directions = std::move(found->directions);
  PlannedRelief relief;
  relief.local_contrast_lx = found->local_contrast_lx;
  relief.relative_contrast = found->exposed_contrast;
  relief.coverage = found->coverage;
  relief.object_lux = std::numeric_limits<double>::quiet_NaN();
  planned.relief = relief;
  for (std::size_t k = 0; k < found->exposed_by_count.size(); ++k)
    planned.numbers.push_back(
        {static_cast<int>(k) + 1, std::numeric_limits<double>::quiet_NaN(), {}, found->exposed_by_count[k]});
  for (Index j = 0; j < own_; ++j) planned.fixtures.push_back(light_of(j));
  planned.seconds = seconds_since(start);
  plan_.tasks.push_back(std::move(planned));
  return {};
}

}  // namespace luxrig
