#pragma once
/// What the operating system refused, as a Fault.

#include <string>

#include "core/result.h"

namespace luxrig {

/// `error` is an errno. Trouble with the way to the peer is Cause::network, the rest (permission, descriptors, no such
/// interface) Cause::system. The caller adds device and since.
[[nodiscard]] Fault os_fault(const std::string& doing, int error);

}  // namespace luxrig
