#include "tools/process/client.h"

#include <fmt/format.h>

#include <cstdio>

#include "tools/command_line/completion.h"
#include "tools/process/meeting_place.h"
#include "tools/process/status_fields.h"
#include "tools/terminal/command.h"

namespace luxrig {

void add_client_without_json(CLI::App& command, ClientArguments& client) {
  command.add_option("--port", client.port, "port of the daemon's page")->check(CLI::Range(1, 65535));
  command.add_option("--token", client.token, "file with the daemon's token, if it is another user's")
      ->check(offers_files());
}

void add_client(CLI::App& command, ClientArguments& client) {
  add_client_without_json(command, client);
  command.add_flag("--json", client.json, "print what the daemon answers");
}

int report_unreachable(const Fault& fault) {
  fmt::print(stderr, "luxrig: {}\n", fault.detail);
  return fault.cause == Cause::invalid ? kExitBadInput : kExitFailed;
}

int post(const ClientArguments& arguments, const char* route, const std::string& body, const std::string& done,
         int wait_s) {
  using nlohmann::json;
  const auto daemon = daemon_on(arguments.port, arguments.token);
  if (!daemon) return report_unreachable(daemon.error());
  const auto answer = http_post_json(*daemon, route, body, wait_s);
  if (!answer) return report_unreachable(no_daemon(arguments.port));
  if (answer->status != 200) {
    const json body_json = json::parse(answer->body, nullptr, false);
    const std::string reason = body_json.is_object() ? text_of(body_json, "error") : answer->body;
    fmt::print(stderr, "luxrig: refused by the daemon: {}\n", reason);
    return answer->status == 400 || answer->status == 413 ? kExitBadInput : kExitFailed;
  }
  const std::string told = text_of(json::parse(answer->body, nullptr, false), "text");
  fmt::print("{}\n", arguments.json ? answer->body : done.empty() ? told : told.empty() ? done : done + "\n" + told);
  return kExitOk;
}

}  // namespace luxrig
