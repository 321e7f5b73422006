#pragma once
/// What `luxrig monitor` shows, as text: universes as they go out, heads, dimmers and meters.

#include <nlohmann/json.hpp>
#include <string>

namespace luxrig {

/// status, universes: as GET /api/status and /api/universes give them; what is missing or of another type is left out.
/// width: columns of the terminal, 40 and more; fewer count as 40. Lines end in \n.
[[nodiscard]] std::string monitor_picture(const nlohmann::json& status, const nlohmann::json& universes, int width);

}  // namespace luxrig
