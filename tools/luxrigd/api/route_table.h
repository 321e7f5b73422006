#pragma once
/// The one table of the daemon's HTTP routes. The server dispatches by it, and openapi.json is written from it.

#include <cstddef>
#include <string>
#include <vector>

#include "tools/luxrigd/api/command_routes.h"
#include "tools/luxrigd/api/role.h"
#include "tools/luxrigd/api/schema.h"

namespace luxrig {

struct ApiAnswer {
  int status = 200;
  const char* what = "";
  schema::Schema body;                            ///< null: none, or bytes of another type than JSON
  const char* content_type = "application/json";  ///< null: no body
};

/// In the query; may be left out.
struct ApiParameter {
  const char* name;
  const char* what;
};

struct ApiRoute {
  const char* method;
  const char* path;
  Role role;            ///< the least that may use it
  const char* does;     ///< in one line
  schema::Schema body;  ///< of the request; null if none is read
  /// Those of its own. Each route has the refusals of common_refusals(), too.
  std::vector<ApiAnswer> answers;
  HttpResponse (*handle)(const HttpHandlers& handlers, const HttpRequest& request);
  std::size_t max_body_bytes = 16u << 10;
  bool urgent = false;  ///< never queues behind other requests
  bool events = false;  ///< a stream of server-sent events
  std::vector<ApiParameter> parameters{};
  bool kept = false;     ///< has an ETag, and 304 for If-None-Match
  bool slow = false;     ///< HttpRoute::slow
  bool matched = false;  ///< heeds If-Match, with 412
};

[[nodiscard]] const std::vector<ApiRoute>& route_table();

/// Refusals by the server itself, with a body {"error"}: this route's.
[[nodiscard]] std::vector<ApiAnswer> common_refusals(const ApiRoute& route);

/// The table for the server. The handlers are copied.
[[nodiscard]] std::vector<HttpRoute> http_routes(HttpHandlers handlers);

}  // namespace luxrig
