#pragma once
/// State of a ShowController. Private to show_controller.cpp and its neighbours show_….cpp (behaviour), and
/// show_status.cpp (reports).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/estimation/gain_estimator.h"
#include "core/show/bypass_list.h"
#include "core/show/controller/correction_progress.h"
#include "core/show/controller/predicted_light.h"
#include "core/show/controller/shared_control.h"
#include "core/show/controller/solve_beside.h"
#include "core/show/fault_watch.h"
#include "core/show/hand_settings.h"
#include "core/show/head_guard.h"
#include "core/show/health_watch.h"
#include "core/show/lost_fixtures.h"
#include "core/show/meter_readings.h"
#include "core/show/scale_watch.h"
#include "core/show/show_controller.h"
#include "core/show/turned_heads.h"

namespace luxrig {

/// Noise of a reading that no correction could remove: a value within this share of its target has arrived.
inline constexpr double kArrivedTolerance = 0.03;

/// max_lux_at_point holds 1 % for a meter's noise on top of its tolerance, and corrections aim at the limit itself.
/// Half of that may be used up before a reading counts; else noise alone would start one correction after another.
inline constexpr double kBreachSlack = 0.005;

/// One late answer is no failure: a device that is reported as faulted is lost after this. Limits are checked first
/// (limits_bear_waiting).
inline constexpr Duration kPatience = std::chrono::milliseconds(1200);
/// From the last level that a lamp took until the show knows of its loss: the driver's detection, then kPatience.
inline constexpr Duration kNoticedWithin = std::chrono::milliseconds(3200);

struct ShowController::State {
  State(const Rig& rig, const LightModel& model, std::span<const Joints> joints);

  Rig rig;
  GainEstimator estimator;
  mutable PredictedLight predicted;
  HealthWatch health;
  MeterReadings readings;
  ScaleWatch scale;
  FaultWatch faults;
  OutputProgram program;

  HeadGuard head_guard;
  std::vector<Joints> model_joints;         ///< per fixture: aim in the estimator's model
  std::vector<std::uint8_t> parking;        ///< per fixture, 1: parks when it is dark; empty = none
  std::vector<std::uint8_t> tells_of_lamp;  ///< per fixture, 1: its device reports a burnt-out lamp
  std::vector<std::uint8_t> powerless;      ///< per fixture, 1: its lamp is lost, and starts as after a power cut
  bool power_came = false;                  ///< light has been asked for once

  SharedControl sharing;
  TurnedHeads turned_heads;

  Phase phase = Phase::idle;
  Time phase_since{};
  std::optional<Time> rig_since;           ///< when this rig was first used
  Time last{};                             ///< the latest instant given to any call
  Time healthy_since{};                    ///< meaningful while not failing
  bool failing = true;                     ///< the light depends on something lost; true until the first step
  bool asked_safe = false;                 ///< by go_safe: no automatic return
  std::string failure;                     ///< cause of the freeze, for the detail line
  std::optional<std::vector<double>> cue;  ///< levels in force, as corrected so far
  std::vector<double> asked;               ///< levels in force before limits dimmed them, as corrected so far
  LostFixtures lost;
  std::vector<std::uint8_t> watched;  ///< per luxmeter, 1: watches its limit, as the estimator knows
  struct Awaited {
    Look look;
    LightModel model;  ///< with its joints
    std::optional<double> fade_s;  ///< none = the rig's
  };
  std::optional<Awaited> awaited;  ///< taken as soon as the heads that it turns are dark
  Time arrive{};                   ///< heads have arrived by then; no fade starts before
  bool turned = false;             ///< heads have got their first aim
  std::vector<double> in_force;    ///< levels that were on before our look, until it is on; else empty
  bool afresh = false;             ///< a person applied a plan; not all meters have been believed since
  CorrectionProgress progress;
  SolveBeside solving;

  // Set by hand (show_by_hand.cpp).
  HandSettings hands;
  Look planned;                        ///< the look in force as planned: goals, limits and weights of all points
  std::vector<Point> points_in_force;  ///< the rig's points, with goals, limits and weights in force
  std::optional<double> hands_fade_s;  ///< of the last setting or release; none = the rig's
  bool unsolved = false;               ///< a setting by hand is newer than the levels in force
  [[nodiscard]] Result<void> hold(Time now, std::span<const ByHand> wanted, const ByHandTimes& times);
  std::size_t release(Time now, std::span<const std::size_t> fixtures, std::span<const std::size_t> points,
                      std::optional<double> fade_s = {});
  void release_what_is_over(Time now);
  void take_points(const Look& look);
  void take_levels_of_plan(Time now, const std::vector<double>& levels, const Look& look);
  /// Passes goals, limits, held and lost fixtures to the estimator.
  void tell_estimator();
  void start_with_hands(Time now, std::optional<double> fade_s = {});
  /// The levels, with those held by hand put in.
  [[nodiscard]] std::vector<double> with_hands(std::vector<double> levels) const;
  [[nodiscard]] std::string why_not(Time now, const ByHand& held) const;

  // Light held to be measured (show_measuring.cpp).
  bool measuring = false;     ///< by a hold that is in force
  bool safe_is_read = false;  ///< meters have been read under the safe look
  double beyond_model = 1;    ///< largest reading over the most that the model allows there, while safe or measuring
  std::optional<Alarm> measured_beyond;  ///< why measuring ended by itself
  /// Meters that show what the model does not allow send the rig to its safe look, or would if it were not measured.
  [[nodiscard]] bool only_model_is_off() const;
  [[nodiscard]] bool all_lamps_held() const;
  [[nodiscard]] Result<void> may_measure(std::span<const ByHand> wanted) const;
  void watch_measuring(Time now);
  void see_beyond_model(Time now, const Judgement& judgement);
  /// A limit is kept by what meters showed, too.
  void keep_measured_limits(Time now, std::vector<double>& level) const;

  // Bypassed (show_bypass.cpp).
  BypassList bypassed;
  void bypass(Time now, std::span<const std::size_t> fixtures, std::span<const std::size_t> luxmeters, bool on);
  void close_bypassed(Time now);
  void tell_bypassed(ShowStatus& status) const;
  /// Highest level that a plan may ask for; 0 for a parked fixture.
  [[nodiscard]] double max_of(std::size_t fixture) const;

  // A rig file read again (show_reload.cpp).
  void exchange_rig(Time now, const Rig& other, const LightModel& model, bool same_light);

  // Behaviour (show_controller.cpp).
  [[nodiscard]] Time at_least_last(Time now);
  void enter(Phase next, Time now);
  [[nodiscard]] std::vector<double> present_levels(Time now, bool under_ceilings = true) const;
  void fade(Time now, std::vector<double> from, std::vector<double> to, double seconds, FadeCurve curve);
  void guard(Time now, const std::vector<double>& from, const std::vector<double>& to);
  /// fade_s: none = the rig's.
  void start_cue(Time now, std::vector<double> levels, std::optional<double> fade_s = {});
  void go_to_asked(Time now, std::vector<double> present, std::optional<double> fade_s = {});
  [[nodiscard]] std::vector<double> wanted_levels(std::span<const double> levels) const;
  [[nodiscard]] bool turns(std::size_t fixture) const;  ///< the awaited look turns it
  void take_look(Time now);
  void freeze(Time now);
  void resume(Time now);
  void fade_to_safe(Time now);
  void take_sample(Time now);
  void look_at_faults(Time now);

  // A lamp dimmed for a moment (show_dips.cpp).
  struct Dipped {
    std::size_t fixture = 0;
    double level = 0;         ///< before, and after
    bool comes_back = false;  ///< on the way there
  };
  std::optional<Dipped> dipped;
  [[nodiscard]] std::vector<std::uint8_t> may_be_dipped() const;
  /// Levels that are out, as without a dip.
  [[nodiscard]] std::vector<double> undipped_levels(Time now) const;
  void step_dip(Time now);
  void dip_to(Time now, double level);
  /// Other light is asked for: the dip is over, wherever it was.
  void drop_dip();
  void solve(Time now, SolveBeside::For what);
  void take_solved(Time now);
  void drop_solving();
  void correct_or_hold(Time now, Correction correction);
  void look_at_drift(Time now, const Correction& correction);
  void watch_drift(Time now);
  void doubt_the_past(Time now);
  void look_at_failures(Time now);
  void advance(Time now);

  // Lighting desks (show_desks.cpp).
  void guard_against_desks(Time now);
  [[nodiscard]] bool waits_for_desks(Time now);
  void begin_after_listening(Time now);
  void step_desks(Time now);
  [[nodiscard]] DeskFollowerSettings desk_settings(const DeskRules& rules,
                                                   const std::vector<std::size_t>& fixtures) const;
  Result<void> identify(Time now, std::size_t fixture, Duration how_long);
  Result<void> aim(Time now, std::size_t fixture, const Joints& joints, double level, Duration how_long);

  // Parking (show_park.cpp).
  Result<void> park(Time now, std::span<const std::size_t> fixtures);
  void unpark();
  [[nodiscard]] bool parked(std::size_t fixture) const {
    return !program.parked.empty() && program.parked[fixture] != 0;
  }
  void finish_parking();
  /// The heads' positions are not known yet: light waits for their longest way, and for homing.
  void first_turn(Time now, std::span<const Joints> joints);

  // Partial failures (show_losses.cpp).
  void watch_losses(Time now);
  /// No limit would be exceeded if any lamps were stuck at their recent maximum while the others go on.
  [[nodiscard]] bool limits_bear_waiting(Time now) const;
  void tell_lost_lamps();
  [[nodiscard]] bool too_much_lost() const;  ///< so much light is lost that the show stops
  [[nodiscard]] std::vector<std::uint8_t> watched_meters() const;
  /// Fixtures that do not answer may light it, by an unknown amount.
  [[nodiscard]] bool in_doubt(std::size_t luxmeter) const;
  void tell_losses(ShowStatus& status) const;

  // Power (show_startup.cpp).
  /// Brings the first light up by stages, from what is lit already. False if nothing is staged.
  bool start_lamps(Time now, const std::vector<double>& present, const std::vector<double>& levels);
  void watch_power(Time now);

  // Status (show_status.cpp, show_verdicts.cpp).
  [[nodiscard]] std::vector<double> safe_levels() const;
  /// The safe look within limits: with lost lamps as they are, and with all of them answering again.
  [[nodiscard]] std::vector<double> limited_safe_levels(Time now) const;
  /// Largest |aimed − measured| / goal over the metered goals; 0 without any.
  [[nodiscard]] double possible_gain(const Correction& correction) const;
  /// The most that it moves the light at a metered goal, by what is known, as a share of the goal.
  [[nodiscard]] double known_gain(const Correction& correction) const;
  [[nodiscard]] Duration wait_before(const Correction& correction) const;
  [[nodiscard]] std::optional<std::size_t> meter_at(std::size_t point) const;
  /// True if `lux` is where corrections want the point: at its goal, or at the best that limits allow.
  [[nodiscard]] bool arrived(std::size_t point, double lux) const;
  [[nodiscard]] bool all_metered_goals_arrived() const;
  [[nodiscard]] PointStatus point_status(std::size_t point, std::span<const double> level, Time now) const;
  [[nodiscard]] double in_doubt_for_lost_lamps_lx(std::size_t point, std::span<const double> level) const;
  [[nodiscard]] LuxEstimate light_by_model(std::size_t point, std::span<const double> level,
                                           const Prediction& prediction) const;
  [[nodiscard]] std::vector<double> with_lost_lamps_at(std::span<const double> level, bool full) const;
  [[nodiscard]] bool any_lamp_lost() const;
  /// A meter would show it if this lamp were out.
  [[nodiscard]] bool seen_by_a_meter(std::size_t fixture, std::span<const double> level) const;
  /// A calibration saw this lamp burn, not long ago.
  [[nodiscard]] bool calibration_saw(std::size_t fixture, Time now) const;
  /// A lamp without which the point would miss its goal, that no calibration has seen lately, and whose failure neither
  /// its device nor a meter would show.
  [[nodiscard]] std::optional<std::size_t> unseen_lamp_for(std::size_t point, std::span<const double> level, Time now,
                                                           const LuxEstimate& light, double allowed_lx) const;
  /// Levels believed to be out. Where a desk drives lamps itself: the values it sends. For a lamp that does not answer:
  /// the last level it took.
  [[nodiscard]] std::vector<double> levels_out(Time now) const;
  /// Its meter's newest reading is not that of the sample, by more than noise.
  [[nodiscard]] bool reads_otherwise_now(std::size_t point, const PointStatus& status) const;
  void judge_goal(std::size_t point, std::span<const double> level, Time now, PointStatus& status) const;
  void judge_limit(std::size_t point, std::span<const double> level, Time now, PointStatus& status) const;
  void remember_levels(Time now);
  [[nodiscard]] std::string detail(Time now, const VerdictCounts& goals) const;
  [[nodiscard]] ShowStatus status(Time now) const;
};

}  // namespace luxrig
