#pragma once
/// A vector in JSON: its x, y and z.

#include <nlohmann/json.hpp>

#include "core/geometry.h"

namespace luxrig {

[[nodiscard]] inline nlohmann::json array_of(const Vec3& v) { return nlohmann::json::array({v.x(), v.y(), v.z()}); }

}  // namespace luxrig
