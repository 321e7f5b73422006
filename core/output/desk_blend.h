#pragma once
/// How a lighting desk and Luxrig share the fixtures of one part of the rig, as a pure function of time: DeskFollower
/// makes one, OutputProgram evaluates it.

#include <cstdint>
#include <span>
#include <vector>

#include "core/output/devices.h"
#include "core/rig/rig.h"

namespace luxrig {

struct DeskBlend {
  std::vector<std::size_t> fixtures;
  DeskMode mode = DeskMode::merge;
  bool to_desk = false;  ///< else Luxrig alone has the light, from the end of the fade on
  Time start{};
  Duration duration{};  ///< 0: at once
  FadeCurve curve = FadeCurve::s_curve;
  bool silent = false;  ///< nothing is sent: the desk drives the lamps itself
  // Per fixture of the part.
  std::vector<double> from_level;      ///< what went out at `start`
  std::vector<double> desk_level;      ///< what the desk wants, or wanted last
  std::vector<std::uint8_t> desk_has;  ///< 1: the desk has a say there
  std::vector<Joints> from_joints, desk_joints;
  std::vector<std::uint8_t> desk_turns;  ///< 1: desk_joints count

  /// Luxrig alone has the light, and no fade to that is going on.
  [[nodiscard]] bool is_own(Time now) const { return !to_desk && now >= start + duration; }
  /// `level`, `joints`: of all fixtures of the rig, as Luxrig wants them; those of the part are changed. Levels are
  /// within 0…1; limits are the caller's.
  /// `kept`: fixtures of the rig that a desk has no say in just now, as 1; may be empty.
  void apply(Time now, std::span<const std::uint8_t> kept, std::span<double> level) const;
  void turn(Time now, std::span<Joints> joints) const;

 private:
  [[nodiscard]] double share(Time now) const;
};

}  // namespace luxrig
