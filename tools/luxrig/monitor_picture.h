#pragma once
/// The text of `luxrig monitor`: universes as they go out, heads, dimmers and meters.

#include <nlohmann/json.hpp>
#include <string>

namespace luxrig {

/// status, universes: as GET /api/status and /api/universes give them. Missing values and values of another type are
/// left out.
/// width: columns of the terminal, at least 40; fewer count as 40. Every line ends with a newline.
[[nodiscard]] std::string monitor_picture(const nlohmann::json& status, const nlohmann::json& universes, int width);

}  // namespace luxrig
