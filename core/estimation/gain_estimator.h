#pragma once
/// What luxmeters teach about the rig: how much each fixture really gives, and how far off the model is where a meter
/// stands. From that: predictions with their error, the most light that the evidence allows at a limited point, and
/// corrected levels.
///
/// Model, linear and Gaussian (kriging; posterior in data space):
///   reading_i = Σ_j M_ij · level_j · x_ij + noise      x_ij = g_j + e_ij
/// g_j: true output over rated of fixture j, prior 1 ± a quarter of (gain_max − gain_min);
/// e_ij: what is wrong at meter i alone (pose, reflectance), prior 0 ± a third of the rig's open_loop_margin, joined
/// by the transport's standard error. Readings of the same meter at other levels share e_ij, so that
/// repeating a reading does not feign certainty. Bounds that nothing crosses: g in [gain_min, gain_max], and the model
/// without g right at every point to within a factor of 1/(1 − open_loop_margin) either way.
///
/// Light that no fixture gives (daylight, LightModel::point_fixed_lx) counts as one more fixture, always at level 1: it
/// may be off by the same factors, readings teach how far, and what limits leave for fixtures is less by the most of
/// it.
///
/// A meter's systematic tolerance does not slow the loop (the reading shall equal the goal), but limits must hold with
/// it: the true value may be reading / (1 − tolerance).
///
/// Time is an argument; same calls, same result.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/estimation/light_model.h"
#include "core/output/devices.h"
#include "core/output/output_program.h"
#include "core/rig/rig.h"

namespace luxrig {

/// Whether a reading can be believed, and if not, why (for an alarm: what is wrong, with figures).
struct Judgement {
  std::size_t luxmeter = 0;
  bool believed = false;
  bool stuck = false;                    ///< not believed, since its value stood still while the light changed
  std::string why;                       ///< empty when believed
  double predicted_lx = 0;               ///< by what was known before
  double lowest_lx = 0, highest_lx = 0;  ///< what the model allows
};

/// Lux at a point with its standard error (transport, gains, and what is wrong locally).
struct Prediction {
  double lux = 0;
  double standard_error_lx = 0;
};

/// For OutputProgram: one row per limited point. max_lx is what daylight leaves of the limit, 0 when it leaves nothing.
struct WorstCase {
  std::vector<std::size_t> points;      ///< index in the rig, ascending
  Eigen::MatrixXd worst_lux_per_level;  ///< points × fixtures
  Eigen::VectorXd max_lx;
};

struct Correction {
  std::vector<double> level;     ///< per fixture; within max_level and all limits, in the worst case of the evidence
  std::vector<double> aimed_lx;  ///< per point of the rig: what the present estimate predicts at `level`
  std::vector<std::string> why;  ///< per point: what keeps it from its goal; empty when it will be met or has none
};

/// What a show makes of levels before any luxmeter has been read: within the limits, with the margins that hold then.
/// One of each per fixture; goals, limits, gain_min, gain_max and open_loop_margin are the rig's.
[[nodiscard]] std::vector<double> opening_levels(const Rig& rig, const LightModel& model,
                                                 std::span<const double> level);

class GainEstimator {
 public:
  static constexpr double kRepeatability = 0.005;  ///< of a reading, standard deviation; the rest is its tolerance

  /// Uses the rig's fixtures (max_level), luxmeters, points, limits and control. The model's matrices must have the
  /// rig's sizes (asserted), or be empty.
  GainEstimator(const Rig& rig, const LightModel& model);

  /// A reading that is off from what is expected by less than this share is never called a jump, whatever the cause: a
  /// lamp that gives a meter less than this may burn out unseen.
  static constexpr double kJump = 0.2;
  /// A reading at the same levels that is off by less is taken for noise, or for what was not known before.
  [[nodiscard]] static double smallest_jump_lx(const Prediction& expected);

  /// Would this reading be believed? `level`: per fixture, as it was (settled) when the reading was taken.
  [[nodiscard]] Judgement judge(const LuxReading& reading, std::span<const double> level) const;

  /// What a meter shows just now, believed or not, while the lamps are at `level`: tells a stuck meter, whose value is
  /// the same to the last bit while the light changed. For every reading as it comes, also in the middle of a fade;
  /// moves no estimate.
  void shows(const LuxReading& reading, std::span<const double> level);

  /// Judges and learns from what is believed; nothing else moves an estimate. One judgement per reading, in order.
  std::vector<Judgement> update(Time now, std::span<const LuxReading> readings, std::span<const double> level);

  /// Goals, weights and limits from now on: of these, one per point of the rig.
  void set_points(std::span<const Point> points);

  /// Held by hand: corrections leave its level alone, and work the others out around it.
  void set_held(std::size_t fixture, bool held) { held_[fixture] = held ? 1 : 0; }

  /// The most that this fixture may be asked for from now on (parked: nothing).
  void set_max_level(std::size_t fixture, double max_level) {
    max_level_[static_cast<Eigen::Index>(fixture)] = max_level;
  }

  /// A lamp that does not obey: what it gives is light that is there anyway, whatever level is asked.
  struct Lost {
    double level = 0;  ///< the last that it took
    double most = 0;   ///< that it may have by now; above `level` where nobody knows what it does without data
  };
  /// Per fixture; nothing: it obeys. watched: per luxmeter, 1: it is read, and shows no more than its point's limit;
  /// what a lost lamp may do beyond its last level counts only where nobody would see it, and where dimming the others
  /// could make good for it.
  void set_lost(std::vector<std::optional<Lost>> lost, std::vector<std::uint8_t> watched);
  /// Limited points that lost lamps alone may have above their limit, for all that others can do.
  [[nodiscard]] std::vector<std::size_t> beyond_dimming() const;
  /// What these fixtures (1: counts) would give to a meter at full level, over what it is predicted to read.
  [[nodiscard]] double share_at_meter(std::size_t luxmeter, std::span<const std::uint8_t> fixtures,
                                      std::span<const double> level) const;

  /// What the fixture is believed to give to a point at full level.
  [[nodiscard]] double lux_per_level(std::size_t point, std::size_t fixture) const;

  /// What all meters read over what the model as stated says (rated lamps, nothing learned): the median, as a
  /// logarithm, with its standard error by all that is stated: lamps, places, curves, transport, tolerances.
  struct CommonScale {
    double log_scale = 0, log_standard_error = 0;
  };
  /// readings: settled, at these levels, one of a meter. Nothing with fewer than two meters that have light.
  [[nodiscard]] std::optional<CommonScale> common_scale(std::span<const LuxReading> readings,
                                                        std::span<const double> level) const;
  /// What a meter would read were all as stated.
  [[nodiscard]] double stated_lux(std::size_t luxmeter, std::span<const double> level) const;
  /// By which share a reading over stated_lux may change from one level to the other, as curves are not known better
  /// (and daylight not at all).
  [[nodiscard]] double curve_error_at_meter(std::size_t luxmeter, std::span<const double> from,
                                            std::span<const double> to) const;

  /// Drops what this meter taught (it is gone, or was exchanged).
  void forget(std::size_t luxmeter);

  [[nodiscard]] double gain(std::size_t fixture) const { return gain_[static_cast<Eigen::Index>(fixture)]; }
  [[nodiscard]] double gain_standard_error(std::size_t fixture) const {
    return gain_error_[static_cast<Eigen::Index>(fixture)];
  }
  /// The most that this fixture may give: estimate + 3 standard errors, at most gain_max.
  [[nodiscard]] double upper_gain(std::size_t fixture) const;

  [[nodiscard]] Prediction at_point(std::size_t point, std::span<const double> level) const;
  [[nodiscard]] Prediction at_meter(std::size_t luxmeter, std::span<const double> level) const;

  /// Share by which all that the model says may be off together, since its meters may be: the tolerance of the best
  /// meter whose readings count; 0 before the first.
  [[nodiscard]] double common_tolerance() const;

  /// A meter stands at this point and at least one of its readings is believed.
  [[nodiscard]] bool confirmed(std::size_t point) const;

  /// The most lux that can truly be at this point at these levels, given bounds and evidence: without a meter there,
  /// model with upper gains, over (1 − open_loop_margin); with one, the last believed reading / (1 − tolerance), plus 1
  /// % for its noise, carried over to these levels in the worst way the bounds allow.
  [[nodiscard]] double most_lux_at_point(std::size_t point, std::span<const double> level, Time now) const;
  /// The same were lost lamps at these levels, too.
  [[nodiscard]] double most_lux_as_given(std::size_t point, std::span<const double> level, Time now) const;

  /// Rows for OutputProgram: as long as row · level ≤ max_lx, no level on the straight way `from` -> `to` (a fade moves
  /// all fixtures by the same share, and switches as level_on_the_way() does), nor a share of one, can bring more than
  /// max_lx, so far as bounds and evidence say.
  [[nodiscard]] WorstCase worst_case(std::span<const double> from, std::span<const double> to, Time now) const;

  /// Rows that hold for any levels, as a desk may want them: by bounds alone, so that they ask for more than evidence
  /// would.
  [[nodiscard]] WorstCase worst_of_any(Time now) const;

  /// What each lamp is worth to the goals, by the model.
  [[nodiscard]] LampWorth worth() const;

  /// `level` with the fixtures that light a limited point dimmed (scale_to_limits), so that most_lux_at_point <= max_lx
  /// everywhere; those that are on or off go off when that is not enough.
  [[nodiscard]] std::vector<double> within_limits(std::span<const double> level, Time now) const;

  /// Levels that bring the rig's goals (in lux: emitters of one housing keep their shares, and with them its colour),
  /// as far as limits allow, starting from the present `level`; a metered goal goes before goals that nobody measures.
  /// What is on or off stays so (no contactor is worn out for a few lux), unless a limit wants it off.
  /// What is held by hand stays, too; where limits leave too little for all, the others dim before it does.
  /// at_once: somebody has just changed what is wanted, so goals that nobody measures may move levels all the way; else
  /// these stay near where they are, as readings are what is new.
  /// Never fails: where the solver is stopped or refuses, the present levels within limits.
  [[nodiscard]] Correction correct(std::span<const double> level, Time now, bool at_once = false) const;

 private:
  struct Evidence {
    std::size_t luxmeter = 0;
    double lux = 0;
    Time taken{};
    Eigen::VectorXd level;
  };
  struct Meter {
    std::optional<double> lux;  ///< last value, believed or not
    Time since{};               ///< it is the same since then
    Eigen::VectorXd level;      ///< as it was then
    std::string stuck;          ///< why it is known to be; empty: it is not. Until the value changes
  };

  /// Rows of M and of the transport's standard error, with what is known of x there.
  struct Row {
    Eigen::RowVectorXd lux_per_level, standard_error;
    Eigen::RowVectorXd factor, factor_error;  ///< x and its standard error, within bounds
    std::optional<std::size_t> luxmeter;      ///< whose evidence holds here
    double unseen_lx = 0;                     ///< of lost lamps, beyond their last level
  };
  [[nodiscard]] double unseen_lux(std::size_t point, const Row& row) const;
  [[nodiscard]] double beyond_last_level(const Row& row) const;
  [[nodiscard]] Eigen::RowVectorXd without_lost(Eigen::RowVectorXd row) const;
  [[nodiscard]] std::vector<double> dimmed_to_limits(std::span<const double> level, Time now) const;
  [[nodiscard]] bool any_lost() const;
  [[nodiscard]] bool is_lost(Eigen::Index fixture) const {
    return static_cast<std::size_t>(fixture) < lost_.size() && lost_[static_cast<std::size_t>(fixture)].has_value();
  }
  [[nodiscard]] Row row_of_meter(std::size_t luxmeter) const;
  [[nodiscard]] Row row_of_point(std::size_t point) const;
  [[nodiscard]] Prediction predict(const Row& row, const Eigen::VectorXd& level) const;
  [[nodiscard]] Eigen::RowVectorXd unmeasured_worst(const Row& row) const;
  [[nodiscard]] double most_lux(const Row& row, const Eigen::VectorXd& level, Time now) const;
  [[nodiscard]] const Evidence* latest(std::size_t luxmeter) const;
  [[nodiscard]] double covariance(const Row& one, const Eigen::VectorXd& one_level, const Evidence& other) const;
  [[nodiscard]] Eigen::VectorXd as_given(std::span<const double> level) const;  ///< with the 1 of daylight
  /// The same, with lost lamps as they are believed to be.
  [[nodiscard]] Eigen::VectorXd vector_of(std::span<const double> level) const;
  static constexpr double kDriftPerMinute = 0.001;  ///< of a lamp: old evidence loses weight, old limits grow
  static constexpr double kDark_lx = 0.5;           ///< what a meter may show in the dark (offset, stray light)
  static constexpr double kFarthestStep = 4;        ///< of a level, as the logarithm of its ratio: 1 % to half
  static constexpr double kCurveError = 0.1;        ///< how far the exponent of level -> true output may be from 1
  [[nodiscard]] static double minutes_between(Time from, Time to) { return std::max(0.0, to_seconds(to - from) / 60); }
  static constexpr int kLimitRounds = 6;  ///< limits hold for the worst case, which depends on where the levels go
  [[nodiscard]] static std::vector<double> list_of(const Eigen::VectorXd& level) {
    return {level.data(), level.data() + level.size()};
  }
  [[nodiscard]] Eigen::Index fixtures() const { return max_level_.size(); }
  [[nodiscard]] Eigen::MatrixXd fixtures_per_light(const Eigen::VectorXd& present) const;
  void switch_off_brightest(const Row& row, std::span<double> level) const;
  [[nodiscard]] double most_without_fixtures(const Row& row, Time now) const;
  void learn(const LuxReading& reading, const Eigen::VectorXd& level);
  void estimate(Time now);

  Eigen::MatrixXd point_, point_error_, meter_, meter_error_;  ///< a column per fixture, then daylight's, if any
  std::vector<Luxmeter> luxmeters_;
  std::vector<Point> points_;
  std::vector<std::string> fixture_names_;
  std::vector<std::optional<std::size_t>> meter_of_point_;
  Eigen::VectorXd max_level_, watts_;
  double max_watts_;                    ///< of the rig; +inf without a limit
  std::vector<std::uint8_t> switched_;  ///< per fixture, 1: on or off
  std::vector<std::uint8_t> held_;      ///< per fixture, 1: by hand
  std::vector<std::size_t> housing_;    ///< per fixture: the first of those that change together
  double gain_min_ = 0, gain_max_ = 1;
  double local_ = 1;  ///< 1/(1 − open_loop_margin)
  double prior_gain_ = 1, prior_gain_sd_ = 0, prior_local_sd_ = 0;

  std::vector<std::optional<Lost>> lost_;  ///< per fixture; may be empty
  std::vector<std::uint8_t> watched_;      ///< per luxmeter; may be empty
  std::vector<Evidence> evidence_;         ///< in the order in which it came
  std::vector<Meter> meters_;
  Eigen::LDLT<Eigen::MatrixXd> innovation_;  ///< covariance of the evidence
  Eigen::VectorXd gain_, gain_error_;
  Eigen::MatrixXd factor_, factor_error_;  ///< x: luxmeters × columns
};

}  // namespace luxrig
