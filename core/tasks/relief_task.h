#pragma once
/// Tasks for an object's relief, done in the rig's scene: heads aimed, or lights found that do not hang yet.

#include <span>

#include "core/highlight/aim/aim_heads.h"
#include "core/highlight/surface/relief_study.h"
#include "core/rig/rig.h"
#include "core/scene/ray_scene.h"
#include "core/tasks/session.h"

namespace luxrig {

/// What stays as it is while lights are sought.
struct ReliefSurroundings {
  const Rig& rig;
  const Scene& scene;
  const RayScene& rays;
  Look look;                   ///< when the search begins: levels of the fixtures that are not sought, joints of all
  std::vector<bool> sought;    ///< per fixture
  Eigen::VectorXd point_lux;   ///< what others give the rig's points
  double max_watts = 0;        ///< of those that are sought, together; may be infinite
};

struct StudiedObject {
  ReliefStudy study;
  ContrastSamples samples;
};

/// Refuses, naming the object, when it has no relief, or none that the camera sees.
[[nodiscard]] Result<StudiedObject> study_object(const Session& session, const ReliefSpec& relief,
                                                 const ComputeOptions& options);

struct AimedFixtures {
  std::vector<AimedHead> heads;  ///< one per head of the task
  AimScore score, before;        ///< `before`: as they looked and shone when asked
  std::size_t tried = 0;
};

/// present_levels   of the heads, for AimedFixtures::before
/// Refuses when no head sees the object or light that stays breaks a limit alone.
[[nodiscard]] Result<AimedFixtures> aim_fixtures(const ReliefSurroundings& around, const StudiedObject& object,
                                                 const Task& task, std::span<const double> present_levels,
                                                 const ComputeOptions& options);

/// The rig's points with a limit, and some of the object's places where it has one, with what stays there.
[[nodiscard]] Result<std::vector<AimLimit>> limits_of(const ReliefSurroundings& around, const StudiedObject& object,
                                                      const ReliefSpec& relief, const ComputeOptions& options);

/// What stays at each of the object's samples [lx].
[[nodiscard]] Result<std::vector<double>> staying_lux(const ReliefSurroundings& around, const StudiedObject& object,
                                                      const ComputeOptions& options);

/// All light, with what is reflected, at the object's brightest places.
struct ObjectLight {
  std::vector<double> fixed_lx, sought_lx;  ///< of what stays, and of the lights that were sought

  /// By how much the lights that were sought must be dimmed so that nowhere is more: 0…1.
  [[nodiscard]] double share_within(double max_lx) const;
  /// When they are dimmed by `share`.
  [[nodiscard]] double brightest_lx(double share) const;
};

/// Looks for them on the whole of its surface. look: levels and joints of all fixtures of the rig, as set.
[[nodiscard]] Result<ObjectLight> light_on_object(const ReliefSurroundings& around, const StudiedObject& object,
                                                  const Look& look, const ComputeOptions& options);

/// The same fault with its task or object named first; its cause stays, so that a stop stays a stop.
[[nodiscard]] tl::unexpected<Fault> in_words(Fault fault, const std::string& of);

}  // namespace luxrig
