#pragma once
/// All errors are one of two kinds. `Problem`: a mistake in a person's file. `Fault`: a failure of the outside world. A
/// bug of our own is an assertion (core/check.h).

#include <string>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "core/time.h"

namespace luxrig {

/// Something a person can mend in their file. Printed as `file:line:column: what: mend`. Lines and columns count from
/// 1; 0 = the whole file.
struct Problem {
  std::string file;
  int line = 0;
  int column = 0;
  std::string what;  ///< what is wrong, in words the person knows
  std::string mend;  ///< how to mend it; never empty

  [[nodiscard]] std::string text() const {
    return file + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + what + ": " + mend;
  }
};

/// A value, or all problems found on the way to it (not only the first).
template <class T>
using Checked = tl::expected<T, std::vector<Problem>>;

/// Why something did not work.
enum class Cause {
  network,    ///< no route, refused, reset, interface gone
  timeout,    ///< no answer within the stated bound
  protocol,   ///< an answer that breaks the protocol (garbled, wrong length, bad checksum)
  refused,    ///< the device understood and said no (Modbus exception, NACK)
  invalid,    ///< our own setpoint cannot be sent (NaN, out of range, wrong length)
  inactive,   ///< the driver is not active
  cancelled,  ///< stopped on request
  system      ///< the operating system refused (descriptor, permission)
};
[[nodiscard]] const char* name_of(Cause cause);

/// A failure of the outside world, with figures: "reply took 312 ms, bound 100 ms, 4 of the last 50".
struct Fault {
  Cause cause = Cause::system;
  std::string device;  ///< name in the rig file; empty if no device is concerned
  std::string detail;  ///< what happened, with figures
  Time since{};        ///< controller time at which it began
};

template <class T>
using Result = tl::expected<T, Fault>;

/// The request cannot be met as it stands. No device is at fault.
[[nodiscard]] inline tl::unexpected<Fault> refusal(std::string detail) {
  return tl::unexpected(Fault{Cause::invalid, "", std::move(detail), {}});
}

}  // namespace luxrig
