#pragma once
/// Who has the light of one part of the rig: a lighting desk, Luxrig, or both. Time is an argument.
///
///   listening ──desk heard──▶ following            takeover and standby begin silent: a desk may have the light
///       └──nobody──▶ own                           from dark, by fade, where Luxrig's light has come on meanwhile
///   own ──desk heard──▶ following (at once or by fade), or waiting until somebody asks
///   following ──desk lost──▶ own: from its last values, by fade
///
/// Every way from one to the other begins at what goes out at that moment, so that nothing flashes. In standby Luxrig
/// falls silent when the way to the desk's values is done.

#include <span>

#include "core/output/desk_blend.h"

namespace luxrig {

enum class DeskPhase { listening, own, waiting, following };
[[nodiscard]] const char* name_of(DeskPhase phase);

struct DeskFollowerSettings {
  DeskRules rules;
  std::vector<std::size_t> fixtures;      ///< of the part, ascending
  std::vector<DimmerCurve> dimmer_curve;  ///< of each: a desk's drive is no level yet
  std::vector<Joints> joints;             ///< of each
  /// Limits of the model hold for heads as Luxrig turns them, so where there are limits a desk cannot turn them.
  bool desk_may_turn = true;
  Duration fade{};
  FadeCurve curve = FadeCurve::s_curve;
};

/// What goes out at this moment, for all fixtures of the rig.
struct PresentLight {
  std::span<const double> level;
  std::span<const Joints> joints;
  std::span<const Joints> own_joints;  ///< where Luxrig alone would have heads look
};

class DeskFollower {
 public:
  explicit DeskFollower(DeskFollowerSettings settings);

  /// Commands for fixtures of other parts are left out; a drive outside 0…1 or not a number counts as its nearest
  /// bound, or 0. True when the blend is another one than before.
  bool hear(Time now, const DeskFrame& frame, const PresentLight& present);
  /// Light is sent already, by somebody whom Luxrig follows: nobody needs to be listened for in silence.
  void have_light(Time now);
  /// Somebody asks that a desk that is back gets the light. Nothing happens unless one waits for it.
  bool hand_back(Time now, const PresentLight& present);
  /// Falls silent when the time has come; call often. True when the blend is another one than before.
  bool step(Time now);

  [[nodiscard]] const DeskBlend& blend() const { return blend_; }
  [[nodiscard]] DeskPhase phase() const { return phase_; }
  [[nodiscard]] Time since() const { return since_; }
  [[nodiscard]] DeskPresence presence() const { return presence_; }
  [[nodiscard]] const std::string& source() const { return source_; }
  [[nodiscard]] DeskMode mode() const { return settings_.rules.mode; }

 private:
  void enter(Time now, DeskPhase phase);
  void begin_own(Time now, const PresentLight& present);
  void begin(Time now, bool to_desk, Duration duration, const PresentLight& present);
  bool take_values(const DeskFrame& frame, const PresentLight& present);
  bool follow_presence(Time now, const PresentLight& present);

  DeskFollowerSettings settings_;
  DeskBlend blend_;
  DeskPhase phase_ = DeskPhase::listening;
  Time since_{};
  DeskPresence presence_ = DeskPresence::unknown;
  std::string source_;
  std::vector<std::uint8_t> joints_known_;  ///< per fixture: desk_joints are the desk's
  std::vector<Joints> own_joints_;          ///< as last seen, to tell whose change was the latest
};

}  // namespace luxrig
