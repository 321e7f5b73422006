#pragma once
/// A session's light, and what is not known of it, learnt from readings: LightUnknowns with the light's changes taken
/// anew wherever a mount is found to be.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/calibration/light_unknowns.h"
#include "core/result.h"
#include "core/tasks/session.h"

namespace luxrig {

/// What a careful technician's rig is off by: lamps by a fifth, mounts by 5 cm and 2° per axis, paint by a tenth.
/// Luxmeters by half of their stated tolerance, and one more in the hand by 1 %.
[[nodiscard]] LightPriors usual_priors(const Rig& rig);

/// The instrument in the hand, in those priors.
[[nodiscard]] inline std::size_t meter_in_hand(const Rig& rig) { return rig.luxmeters.size(); }

/// Standard error of the light at the goals over that light: root mean square, and worst.
struct GoalError {
  double rms = 0, worst = 0;
  std::size_t goals = 0;
};

class RigLight {
 public:
  /// Traces the light, and anew for each material (seconds). The session must outlive it. Without levels in
  /// the priors, lamps are taken to be read at their brightest_levels().
  [[nodiscard]] static Result<RigLight> of(const Session& session, const LightPriors& priors,
                                           const ComputeOptions& options);
  /// The same light by other priors, before anything is learnt; nothing is traced.
  [[nodiscard]] Result<RigLight> with_priors(const LightPriors& priors) const;

  /// Per fixture: the level at which it turned out to be read. Before anything is learnt.
  void read_at(const Eigen::VectorXd& level) { known_.read_at(level); }
  /// Adds readings, and takes the light's changes anew at the mounts found, until these stand still. The light is traced
  /// anew (seconds) where mounts and paint are found to be far from where it was: a beam that hits a picture in
  /// place of the wall beside it changes what is reflected, too.
  [[nodiscard]] Result<void> learn(std::span<const LightReading> readings);
  [[nodiscard]] const LightUnknowns& known() const { return known_; }
  /// The light as the rig file has it, at level 1: receivers (points, then luxmeters) × fixtures.
  [[nodiscard]] const Eigen::MatrixXd& stated_lux() const { return stated_lux_; }

  /// Under these levels. Goals without light are left out.
  [[nodiscard]] GoalError error_of_goals(const Eigen::VectorXd& level) const;

  /// Points for a meter in the hand, best first: after every lamp is read there one by one, the light at the goals under
  /// `level` is known best, relative to what it is. At most `count`, none of `but`.
  [[nodiscard]] std::vector<std::size_t> places_to_measure(const Eigen::VectorXd& level, std::size_t count,
                                                           std::span<const std::size_t> but) const;
  /// Lamps whose light alone is worth a reading at a point with a meter in the hand, the most telling first. The rest
  /// would add less than a twentieth of what all teach. brightest: levels to light them at; lamps at 0 are left out.
  [[nodiscard]] std::vector<std::size_t> lamps_to_read(std::size_t point, const Eigen::VectorXd& level,
                                                       std::span<const double> brightest) const;

 private:
  /// What the rig is found to be: mounts, and reflectances over those stated less 1.
  struct Found {
    std::vector<Eigen::VectorXd> mounts;
    Eigen::VectorXd paint;
  };
  [[nodiscard]] Found found() const;
  /// The largest change, as a share of what is not known before anything is measured.
  [[nodiscard]] double apart(const Found& a, const Found& b) const;
  [[nodiscard]] Result<void> trace_anew(const Found& at);
  [[nodiscard]] Result<void> take_anew();
  struct Goals;
  /// The goals first among the queries.
  [[nodiscard]] Goals goals_under(const Eigen::VectorXd& level) const;
  [[nodiscard]] LightQuery asked_in_hand(std::size_t point, std::size_t fixture) const;
  [[nodiscard]] static Result<RigLight> of_light(const Session& session, const LightPriors& priors,
                                                 const ComputeOptions& options, TransportMatrix light,
                                                 std::vector<Eigen::MatrixXd> paint);
  RigLight(const Session& session, LightPriors priors, const ComputeOptions& options, TransportMatrix light,
           std::vector<Eigen::MatrixXd> paint, LightSensitivity sensitivity);

  const Session* session_;
  LightPriors priors_;
  ComputeOptions options_;
  TransportMatrix light_;  ///< of the rig as in traced_at_
  Found traced_at_;
  Eigen::MatrixXd stated_lux_;
  std::vector<Eigen::MatrixXd> paint_;
  LightUnknowns known_;
};

/// Standard error of a reading of a meter in the hand: it is never held twice at the same place, nor level.
[[nodiscard]] double error_in_hand_lx(double lux);

}  // namespace luxrig
