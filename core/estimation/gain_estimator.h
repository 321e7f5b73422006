#pragma once
/// Learns from luxmeters: the true output of each fixture, and the error of the model at each meter. Yields predictions
/// with their error, the most light that the evidence allows at a limited point, and corrected levels.
///
/// Model, linear and Gaussian (kriging; posterior in data space):
///   reading_i = Σ_j M_ij · level_j · x_ij + noise      x_ij = g_j + e_ij
/// g_j: true output over rated of fixture j, prior 1 ± a quarter of (gain_max − gain_min).
/// e_ij: error at meter i alone (pose, reflectance), prior 0 ± a third of the rig's open_loop_margin (at least 2 %),
/// combined with the transport's standard error. A calibrated LightModel states both for each fixture instead. Readings of one meter at different levels share e_ij, so repeating a
/// reading does not feign certainty. Hard bounds: g in [gain_min, gain_max], and the model without g correct at every
/// point to within a factor of 1/(1 − open_loop_margin) either way.
///
/// Daylight (LightModel::point_fixed_lx) counts as one more fixture, always at level 1. It may be off by the same
/// factors, and readings correct it. Limits leave for fixtures what its highest possible value leaves.
///
/// A meter's systematic tolerance does not slow the loop (the reading should equal the goal), but limits must hold with
/// it: the true value may be reading / (1 − tolerance).
///
/// Time is an argument. The same calls give the same result.

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

/// Whether a reading is believed; if not, why (as the text of an alarm, with figures).
struct Judgement {
  std::size_t luxmeter = 0;
  bool believed = false;
  bool stuck = false;                    ///< not believed, since its value stayed constant while the light changed
  std::string why;                       ///< empty if believed
  double predicted_lx = 0;               ///< before this reading
  double lowest_lx = 0, highest_lx = 0;  ///< range that the model allows
  double allowed_lx = 0;                 ///< around predicted_lx, from what the meter read before; 0 = it has not
};

/// Lux at a point with its standard error (transport, gains, and local errors).
struct Prediction {
  double lux = 0;
  double standard_error_lx = 0;
};

/// For OutputProgram: one row per limited point. max_lx is the part of the limit that daylight leaves, 0 if none.
struct WorstCase {
  std::vector<std::size_t> points;      ///< index in the rig, ascending
  Eigen::MatrixXd worst_lux_per_level;  ///< points × fixtures
  Eigen::VectorXd max_lx;
};

struct Correction {
  std::vector<double> level;     ///< per fixture; within max_level and, in the worst case of the evidence, all limits
  std::vector<double> aimed_lx;  ///< per point of the rig: present prediction at `level`
  std::vector<double> now_lx;    ///< the same at the levels that were corrected
  std::vector<std::string> why;  ///< per point: why it misses its goal; empty: it does not, or For::drift
};

/// The levels of a show before any luxmeter is read: within the limits, with the margins that then apply. One per
/// fixture. Goals, limits, gain_min, gain_max and open_loop_margin are the rig's.
[[nodiscard]] std::vector<double> opening_levels(const Rig& rig, const LightModel& model,
                                                 std::span<const double> level);

struct EmittanceProblem;

class GainEstimator {
 public:
  enum class For {
    round,  ///< only readings are new: the lights of unmetered goals stay near their present levels
    drift,  ///< the same, only to see how much would change: nobody is told why
    hands   ///< the wanted light has just been changed: unmetered goals may move levels all the way
  };
  static constexpr double kRepeatability = 0.005;  ///< standard deviation, share of a reading; beside its tolerance

  /// Uses the rig's fixtures (max_level), luxmeters, points, limits and control. The model's matrices must have the
  /// rig's sizes (asserted), or be empty.
  GainEstimator(const Rig& rig, const LightModel& model);

  /// A reading closer than this to its expected value (as a share) is never called a jump. So the failure of a lamp
  /// that gives less than this share of a meter's light may go unnoticed.
  static constexpr double kJump = 0.2;
  /// At unchanged levels, a smaller change is taken as noise, or as something not known before.
  [[nodiscard]] static double smallest_jump_lx(const Prediction& expected);

  /// Whether this reading would be believed. `level`: per fixture, settled, when the reading was taken.
  [[nodiscard]] Judgement judge(const LuxReading& reading, std::span<const double> level) const;

  /// Records a reading, believed or not, while the lamps are at `level`. It reveals a stuck meter, whose value is
  /// constant to the last bit while the light changes. Call it for every reading, even during a fade. Changes no
  /// estimate.
  void shows(const LuxReading& reading, std::span<const double> level);

  /// Judges readings and learns from those believed; only this changes estimates. One judgement per reading, in order.
  std::vector<Judgement> update(Time now, std::span<const LuxReading> readings, std::span<const double> level);

  /// Sets goals, weights and limits from now on; one Point per point of the rig.
  void set_points(std::span<const Point> points);

  /// A fixture held by hand: corrections keep its level and adapt the others.
  void set_held(std::size_t fixture, bool held) { held_[fixture] = held ? 1 : 0; }

  /// The highest level for this fixture from now on (parked: 0).
  void set_max_level(std::size_t fixture, double max_level) {
    max_level_[static_cast<Eigen::Index>(fixture)] = max_level;
  }

  /// A lamp that does not respond. Its light is taken as fixed, whatever level is asked for.
  struct Lost {
    double level = 0;  ///< the last that it accepted
    double most = 0;   ///< highest that it may have by now; above `level` if its behaviour without data is unknown
    friend bool operator==(const Lost&, const Lost&) = default;
  };
  /// lost: per fixture; none = it responds. watched: per luxmeter, 1 = it is read and shows no more than its point's
  /// limit. The light of a lost lamp beyond its last level counts only where no meter would show it, and only if
  /// dimming the others can make up for it.
  void set_lost(std::vector<std::optional<Lost>> lost, std::vector<std::uint8_t> watched);
  /// Limited points where lost lamps alone may exceed the limit, whatever the others do.
  [[nodiscard]] std::vector<std::size_t> beyond_dimming() const;
  /// Light of the chosen fixtures (1 = chosen) at a meter at full level, over its predicted reading.
  [[nodiscard]] double share_at_meter(std::size_t luxmeter, std::span<const std::uint8_t> fixtures,
                                      std::span<const double> level) const;

  /// Estimated light of the fixture at a point at full level.
  [[nodiscard]] double lux_per_level(std::size_t point, std::size_t fixture) const;

  /// The same at a meter, with its standard error.
  [[nodiscard]] Prediction lux_per_level_at_meter(std::size_t luxmeter, std::size_t fixture) const;

  /// Readings of all meters over the model as stated (rated lamps, nothing learned): the median, as a logarithm. Its
  /// standard error is from everything stated: lamps, positions, curves, transport, tolerances.
  struct CommonScale {
    double log_scale = 0, log_standard_error = 0;
  };
  /// readings: settled, at these levels, one per meter. nullopt if fewer than two meters have light.
  [[nodiscard]] std::optional<CommonScale> common_scale(std::span<const LuxReading> readings,
                                                        std::span<const double> level) const;
  /// What a meter would read if everything were as stated.
  [[nodiscard]] double stated_lux(std::size_t luxmeter, std::span<const double> level) const;
  /// Share by which a reading over stated_lux may change from one level to the other, given the uncertainty of dimmer
  /// curves (all daylight counts as uncertain).
  [[nodiscard]] double curve_error_at_meter(std::size_t luxmeter, std::span<const double> from,
                                            std::span<const double> to) const;

  /// Drops all evidence of this meter (it is gone, or was exchanged).
  void forget(std::size_t luxmeter);

  [[nodiscard]] double gain(std::size_t fixture) const { return gain_[static_cast<Eigen::Index>(fixture)]; }
  [[nodiscard]] double gain_standard_error(std::size_t fixture) const {
    return gain_error_[static_cast<Eigen::Index>(fixture)];
  }
  /// Upper bound of the fixture's gain: estimate + 3 standard errors, at most gain_max. gain_max if a meter that it
  /// lights shows more than what it taught before: one of both was wrong. It stays so until that meter, with this lamp
  /// lit, shows what it taught.
  [[nodiscard]] double upper_gain(std::size_t fixture) const { return upper_gain_[static_cast<Eigen::Index>(fixture)]; }

  /// A number that changes with everything learned: predictions at the same levels differ only with it.
  [[nodiscard]] std::uint64_t knowledge() const { return knowledge_; }
  [[nodiscard]] Prediction at_point(std::size_t point, std::span<const double> level) const;
  [[nodiscard]] Prediction at_meter(std::size_t luxmeter, std::span<const double> level) const;

  /// Share by which all predictions may be off together because meters may be: the tolerance of the best meter whose
  /// readings count; 0 before the first.
  [[nodiscard]] double common_tolerance() const;

  /// Whether there is a meter at this point with at least one believed reading.
  [[nodiscard]] bool confirmed(std::size_t point) const;

  /// The most lux that can truly be at this point at these levels, given bounds and evidence. Without a meter there:
  /// the model with upper gains, over (1 − open_loop_margin). With one: the last reading that is believed, or a later one
  /// that is not but is higher, / (1 − tolerance), plus 1 % for its noise, carried over to these levels in the worst way
  /// that the bounds allow.
  [[nodiscard]] double max_lux_at_point(std::size_t point, std::span<const double> level, Time now) const;
  /// The same if lost lamps were at these levels, too.
  [[nodiscard]] double max_lux_as_given(std::size_t point, std::span<const double> level, Time now) const;

  /// Rows for OutputProgram. If row · level ≤ max_lx, then bounds and evidence exclude more than max_lx. This holds for
  /// every level on the straight way `from` -> `to` (a fade moves all fixtures by the same share and switches as
  /// level_on_the_way() does), and for any share of such a level.
  [[nodiscard]] WorstCase worst_case(std::span<const double> from, std::span<const double> to, Time now) const;

  /// Rows for any levels, as a desk may send. They use bounds alone, so they are stricter than with evidence.
  [[nodiscard]] WorstCase worst_of_any(Time now) const;
  /// The same while heads are turned by hand: what they give is bounded wherever they are aimed, however they hang
  /// (LightModel::any_aim_lux_per_level), and whatever power of its drive a dimmer is that was not measured. That power
  /// makes no row, so at a limit each such lamp gets one part for itself, and all others together get one.
  /// turned: per fixture, 1 = such a head. Dark if the model does not say what it gives.
  [[nodiscard]] WorstCase worst_of_any(Time now, std::span<const std::uint8_t> turned) const;
  /// The model says what heads give wherever they are aimed.
  [[nodiscard]] bool tells_of_any_aim() const { return any_aim_.size() > 0; }

  /// Worth of each lamp to the goals, by the model.
  [[nodiscard]] LampWorth worth() const;

  /// `level`, with the fixtures that light a limited point dimmed (scale_to_limits) so that max_lux_at_point ≤ max_lx
  /// everywhere. On-or-off fixtures go off if that does not suffice.
  [[nodiscard]] std::vector<double> within_limits(std::span<const double> level, Time now) const;

  /// Levels that meet the rig's goals as far as limits allow, starting from the present `level`. Goals are in lux:
  /// emitters of one housing keep their shares, and so its colour. A metered goal comes before unmetered ones.
  /// On-or-off fixtures stay as they are, unless a limit wants them off (no contactor should wear out for a few lux).
  /// Fixtures held by hand stay, too; if limits leave too little for all, the others dim first.
  /// Never fails: if the solver is stopped or refuses, returns the present levels within limits.
  [[nodiscard]] Correction correct(std::span<const double> level, Time now, For what = For::round) const;

 private:
  struct Evidence {
    std::size_t luxmeter = 0;
    double lux = 0;
    Time taken{};
    Eigen::VectorXd level;
  };
  struct Meter {
    std::optional<double> lux;  ///< last value, believed or not
    Time since{};               ///< the value has been the same since then
    Eigen::VectorXd level;      ///< at that time
    std::string stuck;          ///< why it is known to be stuck; empty = it is not. Until the value changes
  };

  /// Rows of M and of the transport's standard error, with the knowledge of x there.
  struct Row {
    Eigen::RowVectorXd lux_per_level, standard_error;
    Eigen::RowVectorXd factor, factor_error;  ///< x and its standard error, within bounds
    std::optional<std::size_t> luxmeter;      ///< whose evidence applies here
    double unseen_lx = 0;                     ///< light of lost lamps beyond their last level
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
  [[nodiscard]] double max_lux(const Row& row, const Eigen::VectorXd& level, Time now) const;
  [[nodiscard]] const Evidence* latest(std::size_t luxmeter) const;
  /// No reading was learned from since the one in over_.
  [[nodiscard]] bool contradicted(std::size_t luxmeter) const;
  void doubt_lamps(const Judgement& judgement, bool showed_more, const Eigen::VectorXd& level);
  [[nodiscard]] double covariance(const Row& one, const Eigen::VectorXd& one_level, const Evidence& other) const;
  [[nodiscard]] Eigen::VectorXd as_given(std::span<const double> level) const;  ///< with the 1 for daylight
  /// The same, with lost lamps at their believed levels.
  [[nodiscard]] Eigen::VectorXd vector_of(std::span<const double> level) const;
  static constexpr double kDriftPerMinute = 0.001;  ///< of a lamp: old evidence loses weight, old limits grow
  static constexpr double kDark_lx = 0.5;           ///< a meter may show this in the dark (offset, stray light)
  static constexpr double kFarthestStep = 4;        ///< of a level, as the logarithm of its ratio: 1 % to half
  static constexpr double kCurveError = 0.1;        ///< deviation from 1 of the exponent of level -> true output
  [[nodiscard]] static double minutes_between(Time from, Time to) { return std::max(0.0, to_seconds(to - from) / 60); }
  static constexpr int kLimitRounds = 6;  ///< limits hold for the worst case, which depends on the new levels
  [[nodiscard]] static std::vector<double> list_of(const Eigen::VectorXd& level) {
    return {level.data(), level.data() + level.size()};
  }
  [[nodiscard]] Eigen::Index fixtures() const { return max_level_.size(); }
  [[nodiscard]] Eigen::MatrixXd fixtures_per_light(const Eigen::VectorXd& present) const;
  void knows_more();
  void explain(const EmittanceProblem& problem, const Eigen::MatrixXd& lux_per_level,
               const std::vector<Eigen::Index>& on_or_off, const std::vector<Eigen::Index>& held,
               const Eigen::VectorXd& set, const std::vector<Row>& rows, Correction& correction) const;
  void switch_off_brightest(const Row& row, std::span<double> level) const;
  [[nodiscard]] double max_without_fixtures(const Row& row, Time now) const;
  void learn(const LuxReading& reading, const Eigen::VectorXd& level);
  void estimate(Time now);
  void bound_gains();
  void find_unexplained(const Eigen::MatrixXd& local_variance);
  /// Per luxmeter, at least 1: how much its lessons differ from each other beyond their stated errors, whatever factor
  /// they have in common (Birge ratio: square root of χ² per degree of freedom). Some were wrong then: a lamp did not
  /// respond, or somebody shaded the meter. covariance: of the evidence; the others: per piece of it [lx].
  [[nodiscard]] Eigen::VectorXd contradiction_of_lessons(const Eigen::MatrixXd& covariance,
                                                         const Eigen::VectorXd& stated_lux,
                                                         const Eigen::VectorXd& surprise) const;

  Eigen::MatrixXd any_aim_;                                    ///< as the model's; may be empty
  std::vector<std::pair<DimmerCurve, bool>> dimmers_;          ///< per fixture: its label's curve; 1 = it was measured
  Eigen::MatrixXd point_, point_error_, meter_, meter_error_;  ///< a column per fixture, then one for daylight, if any
  std::vector<Luxmeter> luxmeters_;
  std::vector<Point> points_;
  std::vector<std::string> fixture_names_;
  std::vector<std::optional<std::size_t>> meter_of_point_;
  Eigen::VectorXd max_level_, watts_;
  double max_watts_;                    ///< of the rig; +inf = no limit
  std::vector<std::uint8_t> switched_;  ///< per fixture, 1 = on or off
  std::vector<std::uint8_t> held_;      ///< per fixture, 1 = held by hand
  std::vector<std::size_t> housing_;    ///< per fixture: the first of those that change together
  double gain_min_ = 0, gain_max_ = 1;
  double local_ = 1;  ///< 1/(1 − open_loop_margin)
  double prior_gain_ = 1;
  Eigen::RowVectorXd prior_gain_sd_, prior_local_sd_;  ///< per column

  std::vector<std::optional<Lost>> lost_;  ///< per fixture; may be empty
  std::vector<std::uint8_t> watched_;      ///< per luxmeter; may be empty
  std::vector<Evidence> evidence_;         ///< in order of arrival
  /// Per luxmeter: the last reading that contradicts what it read before, and is higher. Nothing is learned from it, but
  /// the meter may be right now (somebody stood in the light before), so limits hold by it while contradicted().
  std::vector<std::optional<Evidence>> over_;
  /// Luxmeters × columns: this lamp may be why the meter showed more than what it had taught. A believed reading ends
  /// the doubt only where the lamp is bright enough to show it: with the lamp dark, any lesson fits.
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> doubted_;
  std::vector<Meter> meters_;
  std::uint64_t knowledge_ = 0;
  Eigen::LDLT<Eigen::MatrixXd> innovation_;  ///< covariance of the evidence
  Eigen::VectorXd gain_, gain_error_, upper_gain_;
  Eigen::MatrixXd factor_, factor_error_;  ///< x: luxmeters × columns
  Eigen::MatrixXd factor_beyond_;          ///< by how much the evidence asks for more, or less, than the bounds of x
  /// Per column: by how much more x at a luxmeter that it lights differs from its gain than local errors explain. So it
  /// may be elsewhere.
  Eigen::VectorXd unexplained_;
};

}  // namespace luxrig
