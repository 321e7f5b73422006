#pragma once
/// Instants as text: 2026-11-28T06:12:00Z.

#include <cstdint>
#include <string>

namespace luxrig {

[[nodiscard]] std::string utc_text(std::int64_t unix_s);
[[nodiscard]] std::string utc_now();

/// Hours from an instant to now; infinite if the text is no instant, or one that is yet to come.
[[nodiscard]] double hours_since(const std::string& instant, std::int64_t now_unix_s);
[[nodiscard]] double hours_since(const std::string& instant);

}  // namespace luxrig
