#pragma once
/// Logging in and out, and what a sender is told who may not.

#include "tools/http/server.h"
#include "tools/luxrigd/api/access.h"
#include "tools/luxrigd/api/command_routes.h"

namespace luxrig {

/// Sets the handlers for the session, login and logout. problem: why the newest accounts or certificate are not used;
/// empty if they are.
void add_access_handlers(HttpHandlers& handlers, Access& access, std::function<std::string()> problem);

/// 401 for a stranger, else 403 with the role that the route needs.
[[nodiscard]] HttpResponse not_for_sender(const HttpSender& sender, int needed_rank, bool has_accounts);

}  // namespace luxrig
