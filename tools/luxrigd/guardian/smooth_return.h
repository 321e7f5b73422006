#pragma once
/// After a stall the light starts from the last frame sent. The program has moved on during the stall, and a jump to
/// its present level would be visible.

#include <span>
#include <vector>

#include "core/output/output_program.h"

namespace luxrig {

class SmoothReturn {
 public:
  /// cycle: between two frames. A pause of more than four cycles, or of a tenth of a second if that is longer, is a
  /// stall.
  SmoothReturn(std::size_t fixtures, Duration cycle);

  /// Another process sends in our place: the last frame sent is unknown.
  void forget() { sent_ = false; }

  /// level: in, the program's levels at `now`; out, the levels to send. All lamps move by the same share of their way:
  /// if both ends are within limits, so is each step. The limits in force are applied once more. Fixtures that must be
  /// dark (blackout, a head at a keep-out zone) go dark at once. Allocates nothing.
  void apply(Time now, const OutputProgram& program, bool dark, std::span<double> level);

  [[nodiscard]] bool returning() const { return returning_; }

 private:
  Duration cycle_, stall_;
  std::vector<double> last_, wanted_;
  Time last_at_{};
  bool sent_ = false, returning_ = false;
};

}  // namespace luxrig
