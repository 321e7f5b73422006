// A plan's levels and aims for a rig, with or without hanging the lights that it places.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/output/keep_out.h"
#include "core/plan/plan.h"
#include "core/text/nearest.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();
constexpr double kRounding_rad = 1e-9;
constexpr double kRounding = 1e-9;  ///< of a level

class PlanLevels {
 public:
  PlanLevels(const Plan& plan, const std::string& file_name) : plan_(plan), file_name_(file_name) {}

  /// If `hang` is null, a light that is not a fixture is a problem.
  Checked<Look> read(const Rig& rig, Rig* hang) {
    if (plan_.rig != rig.name) {
      problem(fmt::format("/rig: this plan is for rig \"{}\", not for \"{}\"", plan_.rig, rig.name),
              "give a plan solved for this rig");
      return tl::unexpected(std::move(problems_));
    }
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) index_of_.emplace(rig.fixtures[i].name, i);
    Look look = hung_look(rig);
    look.levels.assign(rig.fixtures.size(), kUnset);
    std::vector<bool> named(rig.fixtures.size(), false);
    const auto set = [&](std::size_t fixture, const PlannedLight& light, const std::string& path) {
      look.levels.resize(rig.fixtures.size(), kUnset);
      named.resize(rig.fixtures.size(), false);
      look.levels[fixture] = light.level;
      look.solved_levels.resize(rig.fixtures.size());
      look.solved_levels[fixture].reset();
      if (light.solved_level && std::abs(light.level - *light.solved_level) > kRounding)
        look.solved_levels[fixture] = light.solved_level;
      named[fixture] = true;
      if (fixture >= look.joints.size()) {  // just hung
        look.joints.push_back(rig.fixtures[fixture].joints);
        return look.aim_world_m.push_back(rig.fixtures[fixture].aim_world_m);
      }
      turn(rig.fixtures[fixture], light, path, look.joints[fixture]);
      if (!same_aim(look.joints[fixture], rig.fixtures[fixture].joints)) look.aim_world_m[fixture] = light.aim_world_m;
    };
    for (std::size_t t = 0; t < plan_.tasks.size(); ++t) {
      const PlannedTask& task = plan_.tasks[t];
      const bool places = task.kind == name_of(TaskKind::placement) || task.kind == name_of(TaskKind::highlight);
      each(rig, task.fixtures, fmt::format("/tasks/{}/fixtures", t), nullptr, false, set);
      each(rig, task.lights, fmt::format("/tasks/{}/lights", t), places ? hang : nullptr, places, set);
    }
    for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
      if (named.size() > i && named[i]) continue;
      problem(fmt::format("/tasks: no task says what fixture \"{}\" shall do", rig.fixtures[i].name),
              "add it with a level, or solve again");
    }
    const KeepOutZones zones(rig);
    for (const std::size_t f : zones.heads()) {
      const auto zone = look.levels[f] > 0 ? zones.met(f, look.joints[f]) : std::nullopt;
      if (zone)
        problem(fmt::format("/tasks: fixture \"{}\" would light keep-out zone \"{}\"", rig.fixtures[f].name,
                            zones.name(*zone)),
                "turn it elsewhere, zoom it in, or give it level 0 (luxrig solve lights no zone)");
    }
    for (std::size_t p = 0; p < plan_.points.size(); ++p) {
      const PlannedPoint& point = plan_.points[p];
      for (const auto& [key, value] : {std::pair("goal_lux", point.goal_lux), std::pair("weight", point.weight),
                                       std::pair("max_lux", point.max_lux)})
        if (value && !(*value >= 0))
          problem(fmt::format("/points/{}/{}: {} for point \"{}\"", p, key, *value, point.name),
                  "give a number from 0");
    }
    if (!problems_.empty()) return tl::unexpected(std::move(problems_));
    look.solved_levels.resize(rig.fixtures.size());
    take_goals(rig, look);
    return look;
  }

 private:
  void problem(std::string what, std::string mend) {
    // Fifty wrong entries are enough for a person.
    if (problems_.size() < 50) problems_.push_back({file_name_, 0, 0, std::move(what), std::move(mend)});
  }

  /// Only the plan's goals count: a point that has none in the plan, or is not in it, is not corrected. Its limits
  /// apply in addition to the rig's.
  void take_goals(const Rig& rig, Look& look) const {
    std::map<std::string_view, const PlannedPoint*> planned_at;
    for (const PlannedPoint& planned : plan_.points) planned_at.emplace(planned.name, &planned);
    const bool holds = holds_a_look(plan_);
    for (const Point& point : rig.points) {
      const auto found = planned_at.find(point.name);
      const PlannedPoint* planned = found == planned_at.end() ? nullptr : found->second;
      std::optional<double> goal_lx = planned ? planned->goal_lux : std::nullopt, max_lx = point.max_lx;
      if (planned && holds && planned->lux > 0 && std::isfinite(planned->lux)) goal_lx = planned->lux;
      if (planned && planned->max_lux) max_lx = std::min(max_lx.value_or(*planned->max_lux), *planned->max_lux);
      look.goal_lx.push_back(goal_lx);
      look.max_lx.push_back(max_lx);
      look.weight.push_back(planned && planned->weight ? *planned->weight : point.weight);
    }
  }

  void turn(const Fixture& fixture, const PlannedLight& light, const std::string& path, Joints& joints) {
    if (!fixture.moves || !light.joints) return;
    const auto within = [&](double rad, double min_rad, double max_rad, const char* key) {
      if (!(rad >= min_rad - kRounding_rad && rad <= max_rad + kRounding_rad))
        problem(fmt::format("{}/{}: {:.12g} for fixture \"{}\" is outside {:g}…{:g}", path, key, deg_from_rad(rad),
                            light.name, deg_from_rad(min_rad), deg_from_rad(max_rad)),
                "give an angle within the head's range, or solve again");
      return std::clamp(rad, min_rad, max_rad);
    };
    const JointRange& range = fixture.range;
    const Joints& planned = *light.joints;
    joints = {within(planned.pan_rad, range.pan_min_rad, range.pan_max_rad, "pan_deg"),
              within(planned.tilt_rad, range.tilt_min_rad, range.tilt_max_rad, "tilt_deg"),
              range.zooms() && planned.beam_rad != 0
                  ? within(planned.beam_rad, range.beam_min_rad, range.beam_max_rad, "beam_angle_deg")
                  : fixture.joints.beam_rad};
  }

  template <class Set>
  void each(const Rig& rig, const std::vector<PlannedLight>& lights, const std::string& list, Rig* hang, bool placed,
            const Set& set) {
    std::set<std::size_t> named_here;
    for (std::size_t l = 0; l < lights.size(); ++l) {
      const PlannedLight& light = lights[l];
      const std::string path = fmt::format("{}/{}", list, l);
      auto found = index_of_.find(light.name);
      if (found == index_of_.end() && hang && hung(*hang, light, path)) found = index_of_.find(light.name);
      if (found == index_of_.end()) {
        if (!hang) unknown(rig, light, path, placed);
        continue;
      }
      const std::size_t i = found->second;
      if (!named_here.insert(i).second) {
        problem(fmt::format("{}/name: fixture \"{}\" stands twice in this task", path, light.name),
                "keep one of the two");
      }
      const double most = rig.max_level(rig.fixtures[i]);
      if (!(light.level >= 0 && light.level <= most)) {
        problem(fmt::format("{}/level: {} for fixture \"{}\" is outside 0…{}", path, light.level, light.name, most),
                "give a level within the fixture's limits, or solve again");
      } else if (rig.fixtures[i].switched && light.level > 0 && light.level < 1) {
        problem(fmt::format("{}/level: {} for fixture \"{}\", which is on or off", path, light.level, light.name),
                "give 0 or 1, or solve again");
      }
      set(i, light, path);
    }
  }

  void unknown(const Rig& rig, const PlannedLight& light, const std::string& path, bool placed) {
    if (!placed || !light.position_world_m.allFinite()) {
      return problem(fmt::format("{}/name: the rig has no fixture \"{}\"", path, light.name),
                     "name a fixture of the rig, or solve again");
    }
    const Vec3& at = light.position_world_m;
    // An emitter hangs with its housing.
    std::string hangs = light.luminaire, called = light.name;
    for (const Luminaire& luminaire : rig.luminaires) {
      if (luminaire.name != light.luminaire || !luminaire.emitter_of) continue;
      hangs = rig.luminaires[*luminaire.emitter_of].name;
      const std::string emitter = luminaire.name.substr(hangs.size());
      if (called.ends_with(emitter)) called.resize(called.size() - emitter.size());
    }
    problem(
        fmt::format("{}/name: light \"{}\" does not hang yet", path, light.name),
        fmt::format("hang a {} at [{:.3f}, {:.3f}, {:.3f}], patch it, and add it to the rig as a [[fixture]] called "
                    "\"{}\" (until then, luxrig render and luxrig evaluate show this plan)",
                    hangs, at.x(), at.y(), at.z(), called));
  }

  bool hung(Rig& rig, const PlannedLight& light, const std::string& path) {
    std::vector<std::string_view> known;
    for (const Luminaire& luminaire : rig.luminaires) known.push_back(luminaire.name);
    const auto at = std::find(known.begin(), known.end(), light.luminaire);
    if (at == known.end()) {
      problem(fmt::format("{}/luminaire: there is no luminaire {}", path, in_quotes(light.luminaire)),
              mend_for_unknown(light.luminaire, known, "solve again"));
      return false;
    }
    if (!light.position_world_m.allFinite()) {
      problem(fmt::format("{}/position is missing, and the rig has no fixture {}", path, in_quotes(light.name)),
              "say where it hangs, or solve again");
      return false;
    }
    if (light.aim_world_m &&
        !(light.aim_world_m->allFinite() && (*light.aim_world_m - light.position_world_m).norm() > 0)) {
      problem(fmt::format("{}/aim: it looks at itself", path), "give a place elsewhere, or solve again");
      return false;
    }
    index_of_.emplace(light.name, rig.fixtures.size());
    rig.fixtures.push_back(hung_light(rig, light.name, static_cast<std::size_t>(at - known.begin()),
                                      light.position_world_m, light.aim_world_m));
    return true;
  }

  const Plan& plan_;
  const std::string& file_name_;
  std::map<std::string, std::size_t> index_of_;
  std::vector<Problem> problems_;
};

}  // namespace

Fixture hung_light(const Rig& rig, const std::string& name, std::size_t luminaire, const Vec3& position_world_m,
                   const std::optional<Vec3>& aim_world_m) {
  Fixture fixture;
  fixture.name = name;
  fixture.luminaire = luminaire;
  fixture.world_from_mount.translation_m = position_world_m;
  fixture.bus = rig.buses.size();
  fixture.aim_world_m = aim_world_m;
  if (aim_world_m) {
    // It is hung this way, so no joint limits apply.
    const JointRange any{-kPi, kPi, -kPi, kPi};
    if (const auto joints = pan_tilt_towards(fixture.world_from_mount, *aim_world_m - position_world_m, any, {}))
      fixture.joints = *joints;
  }
  return fixture;
}

bool holds_a_look(const Plan& plan) {
  const auto last = std::find_if(plan.tasks.rbegin(), plan.tasks.rend(), [](const PlannedTask& task) {
    return task.kind == name_of(TaskKind::aim) || task.kind == name_of(TaskKind::emittance);
  });
  return last != plan.tasks.rend() && last->kind == name_of(TaskKind::aim);
}

Checked<Look> look_for(const Plan& plan, const Rig& rig, const std::string& file_name) {
  return PlanLevels(plan, file_name).read(rig, nullptr);
}

Checked<HungPlan> hang_plan(const Plan& plan, const Rig& rig, const std::string& file_name) {
  HungPlan hung{rig, {}};
  auto look = PlanLevels(plan, file_name).read(hung.rig, &hung.rig);
  if (!look) return tl::unexpected(std::move(look.error()));
  hung.look = std::move(*look);
  return hung;
}

}  // namespace luxrig
