#pragma once
/// After a stall the light goes on from what went out last: the program has moved on meanwhile, and a jump to where it
/// is now would be seen.

#include <span>
#include <vector>

#include "core/output/output_program.h"

namespace luxrig {

class SmoothReturn {
 public:
  /// cycle: between two frames; a pause of more than four of them, or of a tenth of a second, is a stall.
  SmoothReturn(std::size_t fixtures, Duration cycle);

  /// Somebody else sends in our place: what went out last is not known.
  void forget() { sent_ = false; }

  /// level: what the program wants at `now`; what shall go out instead. All lamps go the same share of their way, so
  /// that what is within limits at both ends is within them on the way; the limits in force are applied once more.
  /// What must be dark (blackout, a head at a keep-out zone) is dark at once. Allocates nothing.
  void apply(Time now, const OutputProgram& program, bool dark, std::span<double> level);

  [[nodiscard]] bool returning() const { return returning_; }

 private:
  Duration cycle_, stall_;
  std::vector<double> last_, wanted_;
  Time last_at_{};
  bool sent_ = false, returning_ = false;
};

}  // namespace luxrig
