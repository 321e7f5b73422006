#pragma once
/// Routes that change something leave a line in the log of changes.

#include "tools/luxrigd/api/route_table.h"

namespace luxrig {

/// The route's answer. If it has changed something, record() gets
/// {"who","role","from","did":"POST /api/level","asked": the body,"changed":{what: [old, new]}}.
[[nodiscard]] HttpResponse recorded(const ApiRoute& route, const HttpHandlers& handlers, const HttpRequest& request);

}  // namespace luxrig
