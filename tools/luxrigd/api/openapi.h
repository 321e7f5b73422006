#pragma once
/// The HTTP API as an OpenAPI 3.1 file.

#include <string>

namespace luxrig {

/// From the table of routes; indented, with a newline at the end. openapi.json beside this folder is this text.
[[nodiscard]] std::string openapi_json();

}  // namespace luxrig
