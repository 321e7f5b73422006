#pragma once
/// The body of a request as JSON, when it is such, and not deeper than a command needs.

#include <nlohmann/json.hpp>
#include <string>

namespace luxrig {

/// Discarded (`is_discarded()`) for anything else, and when it is nested deeper than 16.
[[nodiscard]] nlohmann::json json_body(const std::string& body);

}  // namespace luxrig
