#pragma once
/// Who shares control of the light with the show: lighting desks, and housings that identify themselves, which act like
/// a desk for a while. Each has one entry in OutputProgram::desks, which this part keeps.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/output/output_program.h"
#include "core/show/desk_follower.h"
#include "core/show/identify.h"
#include "core/show/show_controller.h"

namespace luxrig {

class SharedControl {
 public:
  /// name: empty for a housing that identifies itself. Returns its index.
  std::size_t add(OutputProgram& program, DeskFollowerSettings settings, const std::string& name);
  [[nodiscard]] bool empty() const { return followers_.empty(); }

  void hear(OutputProgram& program, Time now, std::size_t index, const DeskFrame& frame);
  /// Takes over light that is already on, except from desks that may drive some of it: `silent` of these fixtures.
  void have_light(OutputProgram& program, Time now, const std::vector<std::uint8_t>& silent);
  void hand_back(OutputProgram& program, Time now);

  /// Whether somebody shared control at the last step, and does now.
  struct Change {
    bool was = false, is = false;
  };
  /// turns_back: a head that was aimed by hand is not back yet, so that the light is not the look's.
  Change step(OutputProgram& program, Time now, bool turns_back = false);
  /// As of the last step.
  [[nodiscard]] bool shared() const { return shared_; }

  /// It is not known yet whether a desk has our light.
  [[nodiscard]] bool listens_in_silence() const;
  /// A first look waits for desks to be heard, for a bounded time from the first such question.
  [[nodiscard]] bool listens_still(Time now);

  /// An identification of these fixtures that is not over: it goes on until then. False: there is none.
  bool prolong(Time now, const std::vector<std::size_t>& fixtures, Time until);
  /// settings: of a desk for these fixtures, used the first time.
  void identify(OutputProgram& program, Time now, DeskFollowerSettings settings, IdentifyPattern pattern);

  /// Ends the aims by hand of any of these fixtures. Returns how many there were.
  std::size_t release(OutputProgram& program, Time now, std::span<const std::size_t> fixtures);

  /// Who shares control, in words; requires shared().
  [[nodiscard]] std::string who(const Rig& rig, const OutputProgram& program, Time now) const;
  void tell(ShowStatus& status, Time now) const;

 private:
  struct Identification {
    std::size_t desk = 0;
    IdentifyPattern pattern;
  };
  void put(OutputProgram& program, std::size_t index);
  std::vector<DeskFollower> followers_;  ///< one for each of the program's desks
  std::vector<std::string> names_;
  std::vector<Identification> identified_;  ///< a housing keeps its place among the desks
  std::optional<Time> listens_until_;
  bool shared_ = false;
};

}  // namespace luxrig
