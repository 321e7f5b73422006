#include "tools/luxrigd/api/access_routes.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/plain_text.h"
#include "tools/http/json_body.h"

namespace luxrig {
namespace {

const HttpHeaders kNotKept = {{"Cache-Control", "no-store"}};

HttpResponse told(const nlohmann::json& what) { return {200, "application/json", what.dump(), kNotKept}; }

Role role_of(const HttpSender& sender) {
  return static_cast<Role>(std::clamp(sender.rank, 0, static_cast<int>(Role::configure)));
}

HttpResponse log_in(Access& access, const HttpRequest& request) {
  const auto body = json_body(request.body);
  const auto text_of = [&](const char* key) {
    return body.is_object() && body.contains(key) && body[key].is_string() ? body[key].get<std::string>() : "";
  };
  const std::string name = text_of("name"), password = text_of("password");
  if (!is_account_name(name) || password.empty() || length_in_characters(password) > kMaxPasswordLetters)
    return http_refusal(400, R"(send {"name": "letters, digits and . _ - @", "password": "…"})");
  if (!access.has_accounts())
    return http_refusal(404,
                        "this daemon has no accounts: luxrig page prints an address that opens its page on this "
                        "computer; `accounts` of [daemon] in the rig file names a file with accounts");
  const Access::LoggedIn in = access.log_in(name, password, request.from);
  if (in.wait_s > 0) {
    HttpResponse wait = http_refusal(
        429, fmt::format("too many attempts with a wrong name or password: wait {} s before the next", in.wait_s));
    wait.headers.emplace_back("Retry-After", std::to_string(in.wait_s));
    return wait;
  }
  if (in.session.empty()) return http_refusal(401, "wrong name or password");
  HttpResponse open = told({{"name", name}, {"role", name_of(in.role)}});
  open.headers.emplace_back("Set-Cookie", access.cookie(in.session, request.secure));
  return open;
}

}  // namespace

void add_access_handlers(HttpHandlers& handlers, Access& access, std::function<std::string()> problem) {
  handlers.session = [&access, problem = std::move(problem)](const HttpRequest& request) {
    // The route is for anybody, so the server has asked who it is, but not whether they may.
    const bool open = request.sender.rank > 0;
    nlohmann::json answer = {{"open", open}, {"login", access.has_accounts()}};
    if (open) {
      answer["name"] = request.sender.name.empty() ? kLocalUser : request.sender.name;
      answer["role"] = name_of(role_of(request.sender));
      if (const std::string why = problem(); !why.empty() && role_of(request.sender) == Role::configure)
        answer["problem"] = why;
    }
    return told(answer);
  };
  handlers.login = [&access](const HttpRequest& request) { return log_in(access, request); };
  handlers.logout = [&access](const HttpRequest& request) {
    access.log_out(request.sender);
    HttpResponse out = told({{"logged_out", true}});
    out.headers.emplace_back("Set-Cookie", access.cookie("", request.secure));
    return out;
  };
}

HttpResponse not_for_sender(const HttpSender& sender, int needed_rank, bool has_accounts) {
  if (sender.rank > 0) {
    return http_refusal(403, fmt::format("{} may {}, and this is for those who may {}", sender.name,
                                         name_of(role_of(sender)), name_of(static_cast<Role>(needed_rank))));
  }
  return http_refusal(401, has_accounts
                               ? "the daemon does not know who asks: log in on its page; a script sends "
                                 "Authorization: Bearer and a token that luxrig accounts made"
                               : "the daemon does not know who asks: open its page with the address that luxrig page "
                                 "prints; a program sends Authorization: Bearer and the daemon's token");
}

}  // namespace luxrig
