#pragma once
/// The show: applies plans, fades, keeps limits, checks meters before it believes them, corrects, and goes to the safe
/// look when something fails. Time is an argument; no thread, no device. One thread calls it.
///
///   idle -> fading -> settling -> measuring -> (correcting -> settling -> measuring)* -> holding
///   any of these -> moving (heads that get a new aim go dark, then turn) -> fading
///   any  -> frozen (a device failed: the present look is held) -> safe_fading -> safe
///   safe/frozen -> fading, to the plan in force, when everything is back
///   blackout overrides all of these; lifting it fades back up.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/estimation/light_model.h"
#include "core/output/devices.h"
#include "core/output/output_program.h"
#include "core/plan/look.h"
#include "core/plan/verdict.h"
#include "core/rig/rig.h"
#include "core/show/by_hand.h"
#include "core/show/desk_follower.h"

namespace luxrig {

enum class Phase { idle, moving, fading, settling, measuring, correcting, holding, frozen, safe_fading, safe };
[[nodiscard]] const char* name_of(Phase phase);

struct Alarm {
  bool severe = false;
  std::string device;  ///< may be empty
  std::string text;    ///< the fault, and how to mend it
  Time since{};
};

struct PointStatus {
  std::optional<double> goal_lx;      ///< of the look in force
  double predicted_lx = 0;            ///< model with present gain estimates, at the present levels
  double standard_error_lx = 0;       ///< of predicted_lx: transport, gains, the meters that taught them
  std::optional<double> measured_lx;  ///< by the meter at this point
  Time measured_at{};
  LuxEstimate light;                  ///< best estimate: by the meter, else by the model
  std::optional<Verdict> verdict;     ///< none without a goal
  std::string reason;                 ///< of the verdict, for a person; empty when met
  std::optional<LimitVerdict> limit;  ///< none without a limit
  std::string limit_reason;           ///< empty when kept
  std::string why;                    ///< binding constraint if the goal itself is not met

  [[nodiscard]] bool met() const { return verdict == Verdict::met; }
};

struct FixtureStatus {
  Joints joints;                      ///< ordered aim
  std::optional<Vec3> aim_world_m{};  ///< the aimed point, if the plan or the rig file states it
  /// `level` is believed to be out. For a lamp that does not answer: the last level it took; see level_known.
  double level = 0, drive = 0, target_level = 0;
  bool level_known = true;                   ///< false: its device does not answer, so its lamp's state is not known
  double gain = 1, gain_standard_error = 0;  ///< estimated true output over rated
  bool parked = false;                       ///< dark at rest or on the way there, until the next apply
  bool kept_dark = false;                    ///< its beam could meet a keep-out zone
  std::string waits_for{};                   ///< if parked or kept dark: what lights it again, for a person
  bool aimed_by_hand = false;                ///< see ShowController::aim
  bool dipped = false;                       ///< dimmed for seconds to tell what is wrong; see `fault_dips`
  bool identified = false;                   ///< blinks or nods, so that a person sees which one it is
};

struct DeskStatus {
  std::string name;  ///< of the part
  DeskMode mode = DeskMode::merge;
  DeskPhase phase = DeskPhase::listening;
  Time since{};        ///< start of the phase
  std::string source;  ///< empty if no desk has been heard
  bool heard = false;  ///< the desk is present now
  bool silent = false;
};

/// A device that a person has taken out of the show.
struct Bypassed {
  bool luxmeter = false;  ///< else a fixture
  std::size_t index = 0;
  Time since{};
  std::string risk;  ///< consequences, and what is no longer watched, for a person
};

struct ShowStatus {
  Phase phase = Phase::idle;
  std::string detail;  ///< one line for a person
  Time phase_since{};
  int round = 0;           ///< correction rounds since the last cue
  bool converged = false;  ///< corrections bring no metered goal nearer; does not mean that goals are met
  VerdictCounts goals;
  int limits_kept = 0, limits_exceeded = 0, limits_unknown = 0;
  bool blackout = false;
  /// In the safe look only since luxmeters show what the model does not allow, and they have been read there: the rig may
  /// be measured from here (hold() with `measuring`).
  bool may_be_measured = false;
  /// An accepted plan is not in force yet: something has failed, a desk may have the light, or heads go dark first.
  bool plan_waits = false;
  bool resting = false;  ///< parked heads have arrived
  std::vector<FixtureStatus> fixtures;
  std::vector<PointStatus> points;
  std::vector<std::optional<LuxReading>> luxmeters;  ///< last believed reading
  std::vector<std::optional<LuxReading>> shown;      ///< last reading of each luxmeter, believed or not
  std::vector<Alarm> alarms;
  std::vector<DeskStatus> desks;
  std::vector<ByHand> by_hand;     ///< levels by fixture, then goals by point
  std::vector<Bypassed> bypassed;  ///< fixtures, then luxmeters
};

class ShowController {
 public:
  /// joints: aim of each fixture in the model; empty = as in the rig file
  ShowController(const Rig& rig, LightModel model, std::span<const Joints> joints = {});
  ~ShowController();
  ShowController(ShowController&&) noexcept;

  /// Takes failed devices out of the show, or (on = false) back in. A bypassed luxmeter is not read and raises no
  /// alarm, and what it taught is forgotten. A bypassed fixture fades out and stays dark, even for a desk; the rest is
  /// solved without it. A safe look and alarms that the devices caused end. A notice stays until the bypass is undone.
  void bypass(Time now, std::span<const std::size_t> fixtures, std::span<const std::size_t> luxmeters, bool on);

  /// Call before anything but add_desk(). Luxrig sends this light, which is already on, from here on; the first apply
  /// fades from it. Lamps that burn do not come up by stages; dark ones do. Until that apply, limits let this light
  /// pass, since its sender kept them with knowledge from meters. Two kinds of heads start dark, as their aim is not
  /// known: heads whose axes may have to home, and heads that could light a keep-out zone.
  void go_on_from(Time now, const LightInForce& light);

  /// Another sender has sent in our place until now, with these levels last (one per fixture). The light goes on from
  /// there to its target. Readings taken in that time are forgotten.
  void take_back(Time now, std::span<const double> level);

  /// Fades to these levels (one per fixture, 0…max_level) without turning heads, then measures and corrects towards the
  /// goals of the previous look, at first the rig's. The levels are first reduced so that no limited point can exceed
  /// its limit, with the rig's open-loop margin.
  void apply(Time now, std::span<const double> levels);

  /// Applies a look with other aims and goals. model: for the joints of the look. Heads that move fade out, turn in the
  /// dark and fade in where they arrive, so no beam crosses a limited place on its way. The first time, their position
  /// is not known, and the light waits for their longest way. What meters have taught is kept while no head turns.
  /// fade_s: as for hold().
  void apply(Time now, Look look, LightModel model, std::optional<double> fade_s = {});

  /// Sets levels and goals by hand. They stay until released, through corrections and later plans, within limits. The
  /// rest is solved around them at once, as far as the model knows. Blackout, failures and the safe look override them
  /// while they last. Before the first look they are only stored for it. All or none: refused with a reason if one of
  /// them is invalid, and after go_safe. times.fade_s: what is held fades so long; none = as the rig's looks; for_s does
  /// not count here (ByHand::until).
  /// times.measuring: the light is held to be measured, until a lamp is released or held otherwise. With `on_meter_loss`,
  /// luxmeters that show what the model does not allow then neither send the rig to its safe look nor keep it there, as
  /// the model is what is measured. Limits are kept by the model, and by how far readings are beyond it; a reading above
  /// its point's limit ends it in the safe look. Refused unless every lamp is held, and while anything else has failed.
  Result<void> hold(Time now, std::span<const ByHand> wanted, const ByHandTimes& times = {});
  /// Levels go back to their values before, goals to the plan's, and everything is solved again. Aims by hand end.
  /// Returns the number released. fade_s: as for hold().
  std::size_t release(Time now, std::span<const std::size_t> fixtures, std::span<const std::size_t> points,
                      std::optional<double> fade_s = {});
  /// All settings held now; `why` is empty (status() fills it).
  [[nodiscard]] std::vector<ByHand> by_hand() const;

  /// Replaces the rig by one with the same fixtures, outputs, luxmeters and keep-out zones. Heads keep their aim. The
  /// light stays until the next apply, which should follow at once and fades to levels that the new limits allow.
  /// model: of the new rig. same_light: the new rig gives the same light, so what meters taught is kept.
  void exchange_rig(Time now, const Rig& rig, const LightModel& model, bool same_light);

  /// Everything dark at once, in every phase; movement goes on. Lifting it fades back.
  void blackout(Time now, bool on);

  /// Fades to the safe look and stays there until the next apply (a clean stop).
  void go_safe(Time now);

  /// These heads (empty = all with a rest position) go dark, turn to their rest position, and stay so until the next
  /// apply. Other light stays. A desk neither lights nor turns them, except one in standby, which drives them itself.
  /// Refused for a fixture without a rest position, if no head has one, and after go_safe.
  Result<void> park(Time now, std::span<const std::size_t> fixtures);

  /// From now on a lighting desk shares control of these fixtures, by these rules. Returns the index for desk(). Limits
  /// hold for its values, too. While it shares control no meter is believed, since the light is not the computed one.
  /// Where the desk may already have the light (takeover, standby), the first apply waits in phase idle until it is
  /// known whether a desk is there, 5 s at most. A part that is still undecided then stays silent, and fades in later.
  std::size_t add_desk(const DeskRules& rules, const DeskPart& part);
  void desk(Time now, std::size_t index, const DeskFrame& frame);
  /// Gives the light, by fade, to desks that are back and wait to be asked.
  void hand_back(Time now);

  /// Shows a person which fixture it is: its housing blinks for `how_long`, or nods where allowed, and then returns to
  /// its state before. Within limits, and dark under a blackout. A repeated call prolongs it. Refused before the first
  /// apply (nothing is lit then), for a duration of 0 or less, under a blackout, for a parked head, and for a head that
  /// looks into a keep-out zone.
  Result<void> identify(Time now, std::size_t fixture, Duration how_long);

  /// Turns a head by hand for `how_long`, its housing lit to `level`; then it returns to its state before. It turns
  /// while it is lit: give level 0 first, and light when it is there. A repeated call replaces the last. Keep-out zones
  /// and max_level hold, and so does blackout; no meter is believed meanwhile. Refused where a point has a limit, as the
  /// light of another aim is not known there, and for what identify() is refused for.
  Result<void> aim(Time now, std::size_t fixture, const Joints& joints, double level, Duration how_long);

  void reading(Time now, const LuxReading& reading);
  void health(Time now, std::span<const Health> devices);

  /// Runs a long solve, or a search for what is wrong, once, on any thread; the next step() takes up the result. Without
  /// it, step() and settings by hand do that themselves: milliseconds, but seconds with hundreds of lamps and limits.
  using Beside = std::function<void(std::function<void()>)>;
  void solve_beside(Beside beside);

  /// Advances the state machine; call at 20 Hz or more.
  void step(Time now);

  /// The levels of the safe look, within limits. A head whose beam could meet a keep-out zone is dark. Takes
  /// milliseconds.
  [[nodiscard]] std::vector<double> safe_look(Time now) const;

  /// Hand it to the output thread whenever its revision has changed.
  [[nodiscard]] const OutputProgram& program() const;
  [[nodiscard]] Phase phase() const;  ///< of status(), without the rest
  [[nodiscard]] ShowStatus status(Time now) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
