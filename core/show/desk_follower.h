#pragma once
/// Who controls the light of one part of the rig: a lighting desk, Luxrig, or both. Time is an argument.
///
///   listening ──desk heard──▶ following   takeover and standby start silent: a desk may already have the light
///       └──no desk──▶ own                 fades in from dark if Luxrig's light has come on since
///   own ──desk heard──▶ following         at once or by fade; or `waiting` until a person asks
///   following ──desk lost──▶ own          fades from the desk's last values
///
/// Every change starts at the light that goes out at that moment, so nothing flashes. In standby Luxrig falls silent
/// when the fade to the desk's values is done.

#include <span>

#include "core/output/desk_blend.h"
#include "core/rig/equipment.h"

namespace luxrig {

enum class DeskPhase { listening, own, waiting, following };
[[nodiscard]] const char* name_of(DeskPhase phase);

struct DeskFollowerSettings {
  DeskRules rules;
  std::vector<std::size_t> fixtures;      ///< of the part, ascending
  std::vector<DimmerCurve> dimmer_curve;  ///< per fixture; converts a desk's drive to a level
  std::vector<MeasuredCurve> measured_curve{};  ///< the same; empty = nothing is measured
  std::vector<Joints> joints;             ///< per fixture
  /// The model's limits hold for heads as Luxrig aims them. Where there are limits, a desk cannot turn heads; one that is
  /// aimed by hand is dimmed so far that its light is within them wherever it looks (turned_heads.h).
  bool desk_may_turn = true;
  Duration fade{};
  FadeCurve curve = FadeCurve::s_curve;
};

/// The light that goes out now, for all fixtures of the rig.
struct PresentLight {
  std::span<const double> level;
  std::span<const Joints> joints;
  std::span<const Joints> own_joints;  ///< aim by Luxrig alone
};

class DeskFollower {
 public:
  explicit DeskFollower(DeskFollowerSettings settings);

  /// Ignores commands for fixtures of other parts. A drive outside 0…1 counts as the nearest bound, NaN as 0. True if
  /// the blend has changed.
  bool hear(Time now, const DeskFrame& frame, const PresentLight& present);
  /// Luxrig takes over light that is already being sent, so it need not listen for a desk in silence.
  void have_light(Time now);
  /// Gives the light to a desk that is back, by fade. Does nothing unless one waits for it.
  bool hand_back(Time now, const PresentLight& present);
  /// In standby, falls silent when the fade to the desk is done. Call often. True if the blend has changed.
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
  std::vector<std::uint8_t> joints_known_;  ///< per fixture, 1: desk_joints came from the desk
  std::vector<Joints> own_joints_;          ///< as last seen, to find whose change was the latest
};

}  // namespace luxrig
