#pragma once
/// How a lighting desk and Luxrig share the fixtures of one part of the rig, as a pure function of time. DeskFollower
/// makes one, OutputProgram evaluates it.

#include <cstdint>
#include <span>
#include <vector>

#include "core/output/devices.h"
#include "core/rig/brief.h"

namespace luxrig {

struct DeskBlend {
  std::vector<std::size_t> fixtures;
  DeskMode mode = DeskMode::merge;
  bool to_desk = false;  ///< false = Luxrig alone has control once the fade has ended
  Time start{};
  Duration duration{};  ///< 0 = at once
  FadeCurve curve = FadeCurve::s_curve;
  bool silent = false;  ///< nothing is sent: the desk drives the lamps itself
  // Per fixture of the part.
  std::vector<double> from_level;      ///< levels sent at `start`
  std::vector<double> desk_level;      ///< levels from the desk, current or last received
  std::vector<std::uint8_t> desk_has;  ///< 1 = the desk controls it
  std::vector<Joints> from_joints, desk_joints;
  std::vector<std::uint8_t> desk_turns;  ///< 1 = desk_joints applies

  /// Luxrig alone has control, and the fade to it has ended.
  [[nodiscard]] bool is_own(Time now) const { return !to_desk && now >= start + duration; }
  /// `level`, `joints`: for all fixtures of the rig, as Luxrig wants them. Changes those of the part. Levels are within
  /// 0…1; the caller applies limits. `kept`: per fixture of the rig, 1 = no desk controls it at present; may be empty.
  void apply(Time now, std::span<const std::uint8_t> kept, std::span<double> level) const;
  void turn(Time now, std::span<Joints> joints) const;

 private:
  [[nodiscard]] double share(Time now) const;
};

}  // namespace luxrig
