// apply, page, log, reload, blackout, hand-back, park, bypass, identify: commands that only send a request to a running
// daemon.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "core/plan/plan.h"
#include "tools/command_line/choice.h"
#include "tools/command_line/completion.h"
#include "tools/luxrig/commands.h"
#include "tools/process/client.h"
#include "tools/process/files.h"
#include "tools/process/meeting_place.h"
#include "tools/process/status_fields.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

using nlohmann::json;

/// Before a plan that turns heads is applied, its light is computed. Before a reload changes anything, the rig is
/// solved.
constexpr int kWaitForSolving_s = 300;

struct TellArguments {
  ClientArguments client;
  std::filesystem::path plan;
  std::vector<std::string> names;
  std::string name, state;
  double seconds = 5;
  bool undo = false;
};
using Told = std::shared_ptr<TellArguments>;

Action declare_apply(CLI::App& command) {
  const Told told = std::make_shared<TellArguments>();
  command.add_option("PLAN", told->plan, "plan file (JSON)")->required()->check(offers_files());
  add_client(command, told->client);
  return [told] {
    const auto body = read_file(told->plan);
    if (!body) return report(body.error());
    // Checked here first: the messages then carry the file's name.
    if (const auto parsed = plan_from_json(*body, told->plan.string()); !parsed) return report(parsed.error());
    return post(told->client, "/api/apply", *body, "applied: " + told->plan.string(), kWaitForSolving_s);
  };
}

int print_page(const ClientArguments& arguments) {
  const auto daemon = daemon_on(arguments.port, arguments.token);
  if (!daemon) return report_unreachable(daemon.error());
  const auto answer = http_post_json(*daemon, "/api/session", "{}");
  const std::string address = answer ? text_of(json::parse(answer->body, nullptr, false), "address") : "";
  if (address.empty()) return report_unreachable(no_daemon(arguments.port));
  fmt::print("{}\n", arguments.json ? answer->body : address);
  return kExitOk;
}

Action declare_page(CLI::App& command) {
  const Told told = std::make_shared<TellArguments>();
  add_client(command, told->client);
  return [told] { return print_page(told->client); };
}

/// One line for each change: when, who, from where, what, old -> new.
std::string line_of_change(const json& change) {
  std::string line = fmt::format("{}  {}", text_of(change, "at"), text_of(change, "who"));
  if (const std::string from = text_of(change, "from"); !from.empty() && from != "socket") line += " (" + from + ")";
  line += "  " + text_of(change, "did");
  const auto dumped = [](const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); };
  if (const auto changed = change.find("changed"); changed != change.end() && changed->is_object()) {
    for (const auto& [what, pair] : changed->items())
      if (pair.is_array() && pair.size() == 2)
        line += fmt::format("  {} {} -> {}", what, dumped(pair[0]), dumped(pair[1]));
  } else if (const auto asked = change.find("asked"); asked != change.end()) {
    line += "  " + dumped(*asked);
  }
  return line;
}

int print_log(const ClientArguments& arguments) {
  const auto daemon = daemon_on(arguments.port, arguments.token);
  if (!daemon) return report_unreachable(daemon.error());
  const auto answer = http_get(*daemon, "/api/changes");
  if (!answer || answer->status != 200) return report_unreachable(no_daemon(arguments.port));
  if (arguments.json) {
    fmt::print("{}\n", answer->body);
    return kExitOk;
  }
  const auto changes = json::parse(answer->body, nullptr, false);
  if (!changes.is_array() || changes.empty()) fmt::print("nothing was changed yet\n");
  if (changes.is_array())
    for (const json& change : changes)
      if (change.is_object()) fmt::print("{}\n", line_of_change(change));
  return kExitOk;
}

Action declare_log(CLI::App& command) {
  const Told told = std::make_shared<TellArguments>();
  add_client(command, told->client);
  return [told] { return print_log(told->client); };
}

Action declare_blackout(CLI::App& command) {
  const Told told = std::make_shared<TellArguments>();
  command.add_option("STATE", told->state, "on if left out")->check(one_of({"on", "off"}));
  command.add_flag("--off", told->undo, "lift the blackout");
  add_client(command, told->client);
  return [told] {
    const bool on = !told->undo && told->state != "off";
    return post(told->client, "/api/blackout", json{{"on", on}}.dump(), on ? "blackout" : "blackout lifted");
  };
}

Action declare_hand_back(CLI::App& command) {
  const Told told = std::make_shared<TellArguments>();
  add_client(command, told->client);
  return [told] { return post(told->client, "/api/hand-back", "{}", "desks that wait for the light get it"); };
}

Action declare_park(CLI::App& command) {
  const Told told = std::make_shared<TellArguments>();
  command.add_option("FIXTURE", told->names, "these heads (else all that have a place to rest)");
  add_client(command, told->client);
  return [told] {
    const std::string which = told->names.empty() ? "heads" : fmt::format("{}", fmt::join(told->names, ", "));
    return post(told->client, "/api/park", json{{"fixtures", told->names}}.dump(),
                which + " go dark and to where they rest, until the next apply");
  };
}

Action declare_bypass(CLI::App& command) {
  const Told told = std::make_shared<TellArguments>();
  command.add_option("NAME", told->names, "fixtures and luxmeters (* and ? for several)")->required();
  command.add_flag("--undo", told->undo, "it is mended: take it back");
  add_client(command, told->client);
  return [told] {
    const json body = {{"names", told->names}, {"on", !told->undo}};
    return post(told->client, "/api/bypass", body.dump(-1, ' ', false, json::error_handler_t::replace), "");
  };
}

Action declare_reload(CLI::App& command) {
  const Told told = std::make_shared<TellArguments>();
  add_client(command, told->client);
  return [told] { return post(told->client, "/api/reload", "{}", "", kWaitForSolving_s); };
}

Action declare_identify(CLI::App& command) {
  const Told told = std::make_shared<TellArguments>();
  command.add_option("FIXTURE", told->name, "its name in the rig file")->required();
  command.add_option("--seconds", told->seconds, "for how long")->check(CLI::Range(0.5, 60.0));
  add_client(command, told->client);
  return [told] {
    return post(told->client, "/api/identify", json{{"fixture", told->name}, {"seconds", told->seconds}}.dump(),
                fmt::format("{} blinks, or nods, for {:g} s", told->name, told->seconds));
  };
}

}  // namespace

const Command kApplyCommand{"apply", command_group::kRun, "have the running daemon fade to a plan", declare_apply};
const Command kPageCommand{"page", command_group::kRun, "an address that opens the daemon's page in one browser, once",
                           declare_page};
const Command kLogCommand{"log", command_group::kRun, "who changed what, from where, and what it was before",
                          declare_log};
const Command kReloadCommand{"reload", command_group::kRun,
                             "have the daemon read its rig file again, whole or not at all", declare_reload};
const Command kBlackoutCommand{"blackout", command_group::kRun, "all light off at once; `blackout off` lifts it",
                               declare_blackout};
const Command kHandBackCommand{"hand-back", command_group::kRun,
                               "lighting desks that are back and wait for it get the light", declare_hand_back};
const Command kParkCommand{"park", command_group::kRun, "heads go dark and to where they rest, until the next apply",
                           declare_park};
const Command kBypassCommand{"bypass", command_group::kRun, "do without a failed fixture or luxmeter; the risk is said",
                             declare_bypass};
const Command kIdentifyCommand{"identify", command_group::kDevices,
                               "which one is it? it blinks, or nods, and is then as it was", declare_identify};

}  // namespace luxrig
