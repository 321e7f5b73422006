#pragma once
/// Solves a rig's tasks one after the other; the settings of each count in the next. Private to solve_tasks.cpp
/// (levels, places) and solve_relief.cpp (aims and lights for an object's relief).

#include <chrono>

#include "core/output/keep_out.h"
#include "core/solve/emittance.h"
#include "core/solve/placement/scene/place_in_scene.h"
#include "core/tasks/relief_task.h"
#include "core/tasks/solve_tasks.h"

namespace luxrig {

class TaskSolver {
 public:
  TaskSolver(const Session& session, const TransportMatrix& transport, const ComputeOptions& options);

  Result<void> emittance(const Task& task);
  Result<void> placement(const Task& task);
  Result<void> aim(const Task& task);
  Result<void> highlight(const Task& task);
  Result<void> directions(const Task& task);
  /// Every lamp as bright as permitted within limits of lux.
  void light_as_hung();
  /// Call once, at the end.
  SolvedTasks done();

 private:
  using Index = Eigen::Index;
  using Steady = std::chrono::steady_clock;
  static double seconds_since(Steady::time_point start) {
    return std::chrono::duration<double>(Steady::now() - start).count();
  }

  /// 0 for a head that looks into a keep-out zone.
  [[nodiscard]] double max_level(Index light) const {
    const auto f = static_cast<std::size_t>(light);
    if (zones_.met(f, look_.joints[f])) return 0;
    return rig_.max_level(rig_.fixtures[f]);
  }
  [[nodiscard]] std::optional<double> watts_of(Index light) const {
    return rig_.luminaires[rig_.fixtures[static_cast<std::size_t>(light)].luminaire].watts;
  }
  [[nodiscard]] PlannedLight light_of(Index light) const;
  [[nodiscard]] std::vector<double> levels() const { return {level_.data(), level_.data() + level_.size()}; }
  [[nodiscard]] Look look() const {
    Look look = look_;
    look.levels = levels();
    return look;
  }
  /// Illuminance at the rig's points by all light as set.
  [[nodiscard]] Eigen::VectorXd lux_of_points() const;
  /// Seeks levels of the lights from `begin` to `end`; the others stay as they are.
  [[nodiscard]] EmittanceProblem problem_of(Index begin, Index end) const;
  /// A fault if light that stays exceeds limits by itself: no level of the sought lights could keep them.
  [[nodiscard]] Result<void> limits_left(const Eigen::VectorXd& fixed_lx) const;
  /// Power that a task's lights from `begin` to `end` may take; +inf = no limit.
  [[nodiscard]] Result<double> watts_left(Index begin, Index end, const Task& task) const;
  Result<void> solve_levels_of(Index begin, Index end, double max_watts, PlannedTask& planned);
  /// Adds the lights as fixtures of the model, and computes their light.
  Result<void> hang(const Task& task, std::size_t luminaire, std::span<const LightInScene> lights);
  /// Updates the transport for the rig as it hangs and the aims of `look`.
  Result<void> light_anew(const Look& look);
  /// Adds lights, power and time.
  void list(PlannedTask& planned, Index begin, Index end) const;
  /// Light that stays while the sought fixtures (one mark per fixture) are dark. They must be dark when this is called.
  Result<ReliefSurroundings> surroundings(std::vector<bool> sought, const Task& task) const;
  /// Dims the sought fixtures, whose levels and aims are set, by one factor until limits hold for all light, reflected
  /// light included, and returns it. Fills `planned`, except for list(). before: none for lights that did not hang.
  Result<double> settle_relief(const Task& task, const ReliefSpec& spec, const ReliefSurroundings& around,
                               const StudiedObject& object, const AimScore& score, const AimScore* before,
                               const AskedOfLight& asked, PlannedTask& planned);

  const Session& session_;
  const ComputeOptions& options_;
  Steady::time_point start_ = Steady::now();
  KeepOutZones zones_;
  Rig rig_;    ///< the session's, or one with placed lights as further fixtures
  Look look_;  ///< joints and aims; its levels are level_
  TransportMatrix transport_;
  std::vector<Joints> lit_joints_;  ///< aims in transport_
  std::optional<ModelUsed> used_;   ///< of the last transport computed here
  Index own_;
  Eigen::VectorXd level_;
  std::vector<std::string> why_;
  Plan plan_;
  std::vector<ReliefReasons> reasons_;
};

}  // namespace luxrig
