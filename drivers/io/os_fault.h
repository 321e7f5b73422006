#pragma once
/// An error of the operating system as a Fault.

#include <string>

#include "core/result.h"

namespace luxrig {

/// `error` is an errno. Trouble on the way to the peer is Cause::network. The rest (permission, descriptors, no such
/// interface) is Cause::system. The caller adds device and since.
[[nodiscard]] Fault os_fault(const std::string& doing, int error);

}  // namespace luxrig
