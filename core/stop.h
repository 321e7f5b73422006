#pragma once
/// How a long computation is watched and stopped.

#include <functional>
#include <stop_token>

namespace luxrig {

/// Called now and then from the calling thread with the share done, 0…1, and never after return.
using Progress = std::function<void(double done)>;

struct Watch {
  std::stop_token stop;  ///< when requested, the computation returns Cause::cancelled soon
  Progress progress;     ///< may be empty
};

}  // namespace luxrig
