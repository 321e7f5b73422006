#include "tools/luxrigd/api/recorded.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "tools/http/json_body.h"
#include "tools/luxrigd/state/change_log.h"

namespace luxrig {
namespace {

constexpr std::size_t kMostAsked = 1024;  // bytes of a body in the log

bool changes_something(const ApiRoute& route) {
  // Asked again each second while it is there, and nothing of the rig's.
  if (std::string_view(route.path) == "/api/question") return false;
  return std::string_view(route.method) != "GET" && route.role >= Role::operate;
}

}  // namespace

HttpResponse recorded(const ApiRoute& route, const HttpHandlers& handlers, const HttpRequest& request) {
  if (!handlers.record || !changes_something(route)) return route.handle(handlers, request);
  // Asking for the settings waits for a disk that saves them: an urgent route does so afterwards only.
  const nlohmann::json before = route.urgent ? nlohmann::json() : handlers.settings();
  HttpResponse response = route.handle(handlers, request);
  if (response.status != 200) return response;
  nlohmann::json change = {
      {"who", request.sender.name.empty() ? "this computer's user" : request.sender.name},
      {"role", name_of(static_cast<Role>(std::clamp(request.sender.rank, 0, static_cast<int>(Role::configure))))},
      {"from", request.from},
      {"did", fmt::format("{} {}", request.method, request.path)}};
  if (request.body.size() > kMostAsked)
    change["asked_bytes"] = request.body.size();
  else if (const auto asked = json_body(request.body); asked.is_object() && !asked.empty())
    change["asked"] = asked;
  if (before.is_object()) {
    if (auto changed = changes_between(before, handlers.settings()); !changed.empty()) change["changed"] = changed;
  }
  handlers.record(std::move(change));
  return response;
}

}  // namespace luxrig
