#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace luxrig {

/// Identifies this host, the same after a restart: /etc/machine-id, else the host name.
[[nodiscard]] std::string host_id();

/// 128 bits, the same after a restart, different wherever a part differs. FNV-1a, mixed.
[[nodiscard]] std::array<std::uint8_t, 16> hashed_id(std::span<const std::string_view> parts);

}  // namespace luxrig
