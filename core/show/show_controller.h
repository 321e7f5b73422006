#pragma once
/// The show: applies plans, fades, keeps limits, believes meters with care, corrects, and goes to the
/// safe look when something fails. Time is an argument; no thread, no device. One thread calls it.
///
///   idle -> fading -> settling -> measuring -> (correcting -> settling -> measuring)* -> holding
///   any of these -> moving (heads that shall look elsewhere go dark, then turn) -> fading
///   any  -> frozen (a device failed: the present look is held) -> safe_fading -> safe
///   safe/frozen -> fading, to the plan in force, when everything is back
///   blackout lies over all of these and wins; lifting it fades back up.

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
  std::string text;    ///< what is wrong, and what would mend it
  Time since{};
};

struct PointStatus {
  std::optional<double> goal_lx;      ///< of the look in force
  double predicted_lx = 0;            ///< model with present gain estimates, at the present levels
  double standard_error_lx = 0;       ///< of that: transport and gain uncertainty
  std::optional<double> measured_lx;  ///< of the meter that stands there
  Time measured_at{};
  LuxEstimate light;                  ///< what is known of it, all in all: by the meter, else by the model
  std::optional<Verdict> verdict;     ///< none without a goal
  std::string reason;                 ///< of that verdict, for a person; empty when met
  std::optional<LimitVerdict> limit;  ///< none without a limit
  std::string limit_reason;           ///< empty when kept
  std::string why;                    ///< what binds when the goal itself is not met

  [[nodiscard]] bool met() const { return verdict == Verdict::met; }
};

struct FixtureStatus {
  Joints joints;  ///< where it shall look
  std::optional<Vec3> aim_world_m{};  ///< the point there, if the plan or the rig file knows it
  /// `level`: what is believed to be out. Of a lamp that does not answer, the last that it took; see level_known.
  double level = 0, drive = 0, target_level = 0;
  bool level_known = true;                   ///< false: its device is lost, and what it does with its lamp is not known
  double gain = 1, gain_standard_error = 0;  ///< estimated true output over rated
  bool parked = false;                       ///< dark where it rests, or on the way there, until the next apply
  bool kept_dark = false;                    ///< its beam could meet a keep-out zone
  std::string waits_for{};                   ///< parked or kept dark: what lights it again, for a person
  bool identified = false;                   ///< blinks or nods, so that a person sees which one it is
};

struct DeskStatus {
  std::string name;  ///< of the part
  DeskMode mode = DeskMode::merge;
  DeskPhase phase = DeskPhase::listening;
  Time since{};        ///< when that began
  std::string source;  ///< empty: nobody has been heard
  bool heard = false;  ///< it is there now
  bool silent = false;
};

/// A device that a person has taken out of the show.
struct Bypassed {
  bool luxmeter = false;  ///< else a fixture
  std::size_t index = 0;
  Time since{};
  std::string risk;  ///< what is done without it, and what nobody watches, for a person
};

struct ShowStatus {
  Phase phase = Phase::idle;
  std::string detail;  ///< one line for a person
  Time phase_since{};
  int round = 0;           ///< correction rounds made since the last cue
  bool converged = false;  ///< corrections bring no metered goal nearer; says nothing of goals met
  VerdictCounts goals;
  int limits_kept = 0, limits_exceeded = 0, limits_unknown = 0;
  bool blackout = false;
  /// A plan was taken that is not in force yet: something has failed, a desk may have the light, or heads go dark first.
  bool plan_waits = false;
  bool resting = false;  ///< heads that were parked have got there
  std::vector<FixtureStatus> fixtures;
  std::vector<PointStatus> points;
  std::vector<std::optional<LuxReading>> luxmeters;  ///< last believed reading
  std::vector<Alarm> alarms;
  std::vector<DeskStatus> desks;
  std::vector<ByHand> by_hand;     ///< levels by fixture, then goals by point
  std::vector<Bypassed> bypassed;  ///< fixtures, then luxmeters
};

class ShowController {
 public:
  /// joints   where heads look in the model, one per fixture; empty: as the rig file says
  ShowController(const Rig& rig, LightModel model, std::span<const Joints> joints = {});
  ~ShowController();
  ShowController(ShowController&&) noexcept;

  /// Takes devices that have failed out of the show, or (on = false) back in. A bypassed luxmeter is not read, accuses
  /// nobody, and what it taught is forgotten. A bypassed fixture fades out and stays dark, whoever asks; the rest is
  /// solved without it. What they caused (a safe look, alarms) ends. A notice stays until it is undone.
  void bypass(Time now, std::span<const std::size_t> fixtures, std::span<const std::size_t> luxmeters, bool on);

  /// Before anything but add_desk(): that light is on, and goes out from here on; the first apply fades from there.
  /// Lamps of it that burn do not come up by stages; those that are dark do. Limits let it
  /// pass until then, as whoever sent it kept them by what meters had taught. Dark from the start are only heads whose
  /// axes may have to look for their home, and heads that could light a keep-out zone: nobody knows where they look.
  void go_on_from(Time now, const LightInForce& light);

  /// Somebody else has sent in our place until now, and these levels (one per fixture) last: the light goes on from
  /// there to what it was to be. What meters read meanwhile is forgotten.
  void take_back(Time now, std::span<const double> level);

  /// Fades to these levels (one per fixture, 0…max_level) with heads as they look, then measures and corrects towards
  /// the goals of the look before, at first the rig's. The levels are first reduced so that, with the rig's open-loop
  /// margin, no limited point can exceed its limit.
  void apply(Time now, std::span<const double> levels);

  /// A look with heads that look elsewhere, and other goals. model: with its joints. What moves is faded out first, turned in the dark, and
  /// faded in where it arrives, so that no beam crosses a limited place on its way; the first time heads are turned
  /// nobody knows from where, and the light waits for their longest way. What meters have taught is kept while no head
  /// turns.
  void apply(Time now, Look look, LightModel model);

  /// Sets levels and goals by hand. They stay until they are released, through corrections and later plans, within
  /// limits; the rest is solved around them at once, as far as the model knows. Blackout, failures and the safe look
  /// win over them while they last. Before the first look they are only kept for it. All or none: refused with a reason
  /// where one cannot be asked for.
  Result<void> hold(Time now, std::span<const ByHand> wanted);
  /// Levels go back to what they were before, goals to the plan's, and everything is solved again. Returns how many.
  std::size_t release(Time now, std::span<const std::size_t> fixtures, std::span<const std::size_t> points);
  /// As they are held now; `why` is empty (status() has it).
  [[nodiscard]] std::vector<ByHand> by_hand() const;

  /// From here on the rig is this one, which has the same fixtures, outputs, luxmeters and keep-out zones, with heads
  /// as they look now. The light stays until the next apply, which is to follow at once, and goes from there to what
  /// the new limits allow. model: of the rig so. same_light: it gives what it gave, so that what meters taught is kept.
  void exchange_rig(Time now, const Rig& rig, const LightModel& model, bool same_light);

  /// Everything dark at once, whatever else goes on; movement goes on. Lifting it fades back.
  void blackout(Time now, bool on);

  /// Fades to the safe look and stays there until the next apply (a clean stop).
  void go_safe(Time now);

  /// These heads (none named: all that have a place to rest) go dark, then to where they rest, and stay so until the
  /// next apply; other light stays. A desk neither lights nor turns them, but for one in standby, which drives them
  /// itself. Refused for a fixture without such a place, where no head has one, and after go_safe.
  Result<void> park(Time now, std::span<const std::size_t> fixtures);

  /// From now on a lighting desk has a say in these fixtures, by these rules. Returns the index for desk(). Limits hold
  /// for what it wants, too. While it has a say no meter is believed, since the light is not what was worked out. Where
  /// the desk may have the light already (takeover, standby) the first apply waits, in phase idle, until it is known
  /// whether there is one, 5 s at most; what is still not known then stays silent, and comes by fade.
  std::size_t add_desk(const DeskRules& rules, const DeskPart& part);
  void desk(Time now, std::size_t index, const DeskFrame& frame);
  /// Desks that are back and wait to be asked get the light, by fade.
  void hand_back(Time now);

  /// A person wants to see which one it is: the fixture's housing blinks for `how_long`, or nods where that may be, and
  /// is then as it was. Within limits, and dark under a blackout. Asked again, it begins anew. Refused while nothing
  /// has been applied (what is not patched here is nobody's business then), for a duration that is not above 0, and
  /// under a blackout.
  Result<void> identify(Time now, std::size_t fixture, Duration how_long);

  void reading(Time now, const LuxReading& reading);
  void health(Time now, std::span<const Health> devices);

  /// Who runs what takes long, once and on any thread: what it says is taken up by the step after. Without, step() and
  /// what sets something by hand do it themselves: milliseconds, but seconds with hundreds of lamps and limits.
  using Beside = std::function<void(std::function<void()>)>;
  void solve_beside(Beside beside);

  /// Advances the state machine; call at 20 Hz or more.
  void step(Time now);

  /// The levels of the safe look, within limits; a head whose beam could meet a keep-out zone is dark in it. Takes
  /// milliseconds.
  [[nodiscard]] std::vector<double> safe_look(Time now) const;

  /// Hand it to the output thread whenever its revision has changed.
  [[nodiscard]] const OutputProgram& program() const;
  [[nodiscard]] ShowStatus status(Time now) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace luxrig
