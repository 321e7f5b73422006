#pragma once
#include <string>

namespace luxrig {

/// What tells this host from others and stays over restarts: /etc/machine-id, else the host name.
[[nodiscard]] std::string host_id();

}  // namespace luxrig
