#pragma once
/// Tasks for an object's relief, done in the rig's scene: aim heads, or find places for new lights.

#include <span>

#include "core/highlight/aim/aim_heads.h"
#include "core/highlight/surface/relief_study.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "core/tasks/emitter_mix.h"
#include "core/tasks/light_role.h"
#include "core/tasks/session.h"

namespace luxrig {

/// Everything that stays fixed while lights are sought.
struct ReliefSurroundings {
  const Rig& rig;
  const Scene& scene;
  const RayScene& rays;
  Look look;                  ///< at the start: levels of the fixtures that are not sought, joints of all
  std::vector<bool> sought;   ///< per fixture
  Eigen::VectorXd point_lux;  ///< light of the others at the rig's points
  double max_watts = 0;       ///< of all sought lights together; may be infinite
};

struct StudiedObject {
  ReliefStudy study;
  ContrastSamples samples;
};

/// Refuses, naming the object, if it has no relief, or none that the camera sees.
[[nodiscard]] Result<StudiedObject> study_object(const Session& session, const ReliefSpec& relief,
                                                 const ComputeOptions& options);

struct AimedFixtures {
  std::vector<AimedHead> heads;   ///< one per head of the task
  std::vector<EmitterMix> mixes;  ///< per head: of its emitters, at level 1
  AimScore score, before;         ///< `before`: with the aims and levels at the start
  std::size_t tried = 0;
  std::vector<AimScore> without;    ///< per head: the score with that head dark
  std::vector<double> gain_if_lit;  ///< AimResult
  AskedOfLight asked;               ///< by the task's role
};

/// present_levels: of the heads, for AimedFixtures::before. Refuses if no head sees the object, or if light that stays
/// exceeds a limit by itself. Of a set-up, only as many heads are lit as it has, all in its window; refuses, saying what to
/// hang where, if none hangs there. Of a rim light, only those behind the object.
[[nodiscard]] Result<AimedFixtures> aim_fixtures(const ReliefSurroundings& around, const StudiedObject& object,
                                                 const Task& task, std::span<const double> present_levels,
                                                 const ComputeOptions& options);

/// The rig's points with a limit, and some places of the object if it has one, with the light that stays there.
[[nodiscard]] Result<std::vector<AimLimit>> limits_of(const ReliefSurroundings& around, const StudiedObject& object,
                                                      const ReliefSpec& relief, const ComputeOptions& options);

/// Light that stays at each of the object's samples [lx].
[[nodiscard]] Result<std::vector<double>> staying_lux(const ReliefSurroundings& around, const StudiedObject& object,
                                                      const ComputeOptions& options);

/// Contrast and coverage of the object's relief by heads that were judged elsewhere (LitPlaces); NaN if none of them sees
/// it. Replaces those of `score`.
void judge_relief(const ReliefSurroundings& around, const StudiedObject& object, std::vector<HangingHead> heads,
                  std::span<const HeadSetting> settings, const AimWishes& wishes, const AimOptions& options,
                  AimScore& score);

/// All light, direct and reflected, at the object's brightest places.
struct ObjectLight {
  std::vector<double> fixed_lx, sought_lx;  ///< light that stays, and of the sought lights

  /// Factor 0…1 that dims the sought lights so that no place exceeds max_lx.
  [[nodiscard]] double share_within(double max_lx) const;
  /// Brightest place with the sought lights dimmed by `share`.
  [[nodiscard]] double brightest_lx(double share) const;
};

/// Searches the whole surface. look: levels and joints of all fixtures of the rig, as set.
[[nodiscard]] Result<ObjectLight> light_on_object(const ReliefSurroundings& around, const StudiedObject& object,
                                                  const Look& look, const ComputeOptions& options);

/// The fault with its task or object named first. The cause is kept, so a stop stays a stop.
[[nodiscard]] tl::unexpected<Fault> in_words(Fault fault, const std::string& of);

}  // namespace luxrig
