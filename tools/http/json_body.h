#pragma once
/// The body of a request as JSON, if it is JSON and not nested deeper than a command needs.

#include <nlohmann/json.hpp>
#include <string>

namespace luxrig {

/// Discarded (`is_discarded()`) if it is not JSON, or is nested deeper than 16.
[[nodiscard]] nlohmann::json json_body(const std::string& body);

}  // namespace luxrig
