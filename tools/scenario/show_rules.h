#pragma once
/// What must hold in every show, without being written. Judged by the truth of the simulated rig and by what was sent.
///
///   1 No output exceeds a limit: of a fixture, or of the light at a point (while the rig can know its lamps' light).
///   2 Light does not jump, unless a person or the loss of the daemon made it.
///   3 The output cycle never waits.
///   4 What was acknowledged survives: blackout and what is held by hand, after every restart.
///   5 A wrong meter cannot drive the light up beyond what the model allows.
///   6 Nothing is called met that is not: while the show holds its look, and no meter lies.
///   7 A blackout is dark, and turns no head.
///   8 What a person holds by hand stays, within limits.
///   9 No beam is lit that meets a keep-out zone.
///  10 A daemon that ends in order leaves the safe look.
///
/// A venue's slack (venue.h) gives room to what it sees late or rounded: levels in 1, 7, 8 and 10 by a step of the wire;
/// light in 2 by frames that arrive together; the silence in 3 by a busy computer; the time until an order counts in 2,
/// 6, 7 and 8 by its way and the age of the status. Nothing else: light at points (1, 5, 6), beams (9) and what
/// survives (4) are judged alike everywhere.

#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/output/keep_out.h"
#include "core/rig/rig.h"
#include "sim/faults/faults.h"
#include "tools/scenario/condition.h"
#include "tools/scenario/outcome.h"
#include "tools/scenario/venue.h"

namespace luxrig::scenario {

class ShowRules {
 public:
  /// The rig must outlive it.
  explicit ShowRules(const Rig& rig, const Slack& slack = {});

  /// A person commanded something, or the daemon has gone or come: light may jump for a moment.
  void disturbed(double at_s);
  /// A lighting desk shares control, or no longer does: it may do as it likes, within limits.
  void desk(double at_s, bool there);
  /// A person commanded something that may turn heads.
  void heads_may_turn(double at_s);
  void blackout(double at_s, bool on);
  void held_by_hand(double at_s, std::size_t fixture, double level, std::optional<double> for_s);
  /// Something is now held by hand, or no longer.
  void by_hand_changed(double at_s) { by_hand_s_ = at_s; }
  /// These fixtures, by name; empty = all.
  void released(const std::vector<std::string>& names);
  /// The wall clock jumps: by it, what is held for a time may end at any restart.
  void clock_stepped();
  /// A person takes these devices out of the show, or puts them back.
  void bypassed(double at_s, const std::vector<std::string>& names, bool on);
  /// From now on, or no longer, this meter does not show its light, for one reason more or less.
  void meter_lies(double at_s, std::size_t luxmeter, bool lies);
  /// The light at the truth's points is not that of lamps and file alone: a person in it, other daylight.
  void light_is_unmodelled(double at_s, bool unmodelled);
  /// A meter that cannot be read: what a person's shade taught stays, until it can.
  void meter_is_mute(double at_s, bool mute);
  /// A bus that is dead, or no longer: its lamps stay as they are, whatever a wrong meter taught before.
  void lamps_are_stuck(double at_s, bool stuck);
  /// A fixture that cannot answer does not get what it is sent: nobody can know its light.
  void fixture_is_deaf(double at_s, bool deaf);
  void daemon_gone(double at_s, const ShowStatus& last);
  void daemon_back(double at_s, const ShowStatus& first);
  void ended_in_order(double at_s, const std::vector<double>& level);

  /// Every instant while a daemon runs. sent: whether each bus has just been written to.
  void look(double at_s, const Instant& instant, const std::vector<bool>& sent);

  /// Every instant while none runs: what limits and zones forbid stays forbidden. guarded: a guardian has the light,
  /// which holds it, then fades; and it keeps a blackout.
  void look_without_daemon(double at_s, const Instant& instant, bool guarded = false);

  /// One per rule.
  [[nodiscard]] std::vector<Judged> end() const { return judged_; }

 private:
  enum Rule { limits, jumps, waits, survives, wrong_meter, met, dark, by_hand, keep_out, safe_at_end, rules };
  void broken(Rule rule, double at_s, std::string found);
  /// A time in which what is wrong is not corrected, for one reason or more.
  struct Pause {
    int reasons = 0;
    double since_s = 0;
    /// Whether what changed then is still as it was.
    [[nodiscard]] bool keeps(double changed_s) const;
  };
  /// One reason more or less. When the last goes, what it kept counts as changed now.
  void pause(Pause& pause, double at_s, bool on);
  /// A desk shares control, or has until a moment ago.
  [[nodiscard]] bool desk_lately(double at_s) const;
  [[nodiscard]] bool deaf_lately(double at_s) const;
  /// A meter there shows something else, or has until a moment ago.
  [[nodiscard]] bool lied_to_lately(std::optional<std::size_t> point, double at_s) const;  ///< none = anywhere
  /// The least that readings can make a lamp be taken for.
  [[nodiscard]] double least_gain() const;
  [[nodiscard]] bool any_lies_lately(double at_s, double for_s) const;
  /// Readings may still be those of light that is not the truth's.
  [[nodiscard]] bool unmodelled_lately(double at_s, double for_s) const;
  [[nodiscard]] bool disturbed_lately(double at_s) const;
  void look_at_limits(double at_s, const Instant& instant);
  void look_at_jumps(double at_s, const Instant& instant);
  void look_at_meters(double at_s, const Instant& instant);
  void look_at_verdicts(double at_s, const Instant& instant);
  void look_at_blackout(double at_s, const Instant& instant);
  void look_at_hands(double at_s, const Instant& instant);
  void look_at_zones(double at_s, const Instant& instant);

  const Rig& rig_;
  Slack slack_;
  KeepOutZones zones_;
  std::vector<Judged> judged_;
  double max_step_ = 0;        ///< in a tick
  double max_rate_per_s_ = 0;  ///< for what is seen later
  std::optional<double> disturbed_s_, dark_since_s_, blackout_s_, unmodelled_s_;
  bool unmodelled_ = false, dark_ = false, desk_ = false;
  int deaf_ = 0;
  std::optional<double> deaf_s_, turning_s_, desk_s_, by_hand_s_, hand_over_s_, safe_look_s_;
  Pause lamps_pause_;                    ///< dark, a bus is dead, a lamp is bypassed: what was taught is not corrected
  Pause meters_pause_;                   ///< a meter is mute
  std::vector<double> before_;           ///< levels of the last instant
  double before_s_ = 0;                  ///< that instant
  std::vector<double> last_sent_s_;      ///< per bus
  std::vector<Joints> dark_joints_;      ///< of heads when it went dark, or when they had arrived
  std::vector<Joints> joints_;           ///< at the last look
  std::optional<double> turned_s_;       ///< when a head last turned
  std::vector<double> lit_lux_;          ///< per point: true light when it last was not dark
  std::set<std::string> bypassed_;
  struct Lie {
    int reasons = 0;
    double changed_s = 0;    ///< when one came or went
    double honest_lx = NAN;  ///< true light at its point when it began; NaN: not seen yet
    double most_lx = 0;      ///< of that, and of the goals and limits there since
  };
  std::map<std::size_t, Lie> lies_;  ///< by luxmeter: all that have lied
  struct Hand {
    double level = 0, since_s = 0;
    std::optional<double> until_s;
    bool end_unknown = false;  ///< its end was a time of day, and the clock was set
  };
  std::map<std::size_t, Hand> hands_;  ///< fixtures
  std::optional<ShowStatus> gone_with_;
  std::map<std::size_t, double> wrong_since_s_;  ///< points called met that are not
};

}  // namespace luxrig::scenario
