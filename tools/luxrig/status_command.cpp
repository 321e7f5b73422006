// status: phase, goals and devices of the running daemon.
#include <fmt/format.h>

#include <memory>

#include "tools/luxrig/commands.h"
#include "tools/process/client.h"
#include "tools/process/meeting_place.h"
#include "tools/process/status_fields.h"
#include "tools/terminal/command.h"
#include "tools/terminal/table.h"

namespace luxrig {
namespace {

using nlohmann::json;

void print_status(const json& status) {
  fmt::print("{}: {}{}{}: {}\n", text_of(status, "rig"), text_of(status, "phase"),
             flag_of(status, "blackout") ? ", BLACKOUT" : "", flag_of(status, "plan_waits") ? ", a plan waits" : "",
             text_of(status, "detail"));
  if (const std::string made = text_of(status, "calibrated"); !made.empty()) fmt::print("as calibrated {}\n", made);
  for (const json& alarm : list_of(status, "alarms")) {
    fmt::print("{}  {} ({} s ago)\n", flag_of(alarm, "severe") ? "ALARM  " : "warning", text_of(alarm, "text"),
               shown(number_of(alarm, "since_s"), "{:.1f}"));
  }
  Table devices({"device", "state", ">last ok s ago", ">sent", ">received", ">errors", "detail"});
  for (const json& d : list_of(status, "devices")) {
    devices.row({text_of(d, "name"), text_of(d, "life"), shown(number_of(d, "last_ok_s"), "{:.2f}"),
                 shown(number_of(d, "sent"), "{:.0f}"), shown(number_of(d, "received"), "{:.0f}"),
                 shown(number_of(d, "errors"), "{:.0f}"), text_of(d, "detail")});
  }
  Table fixtures({"fixture", "bus", ">level", ">drive", ">gain", ">± se"});
  for (const json& f : list_of(status, "fixtures")) {
    const bool known = !f.contains("level_known") || flag_of(f, "level_known");
    fixtures.row({text_of(f, "name"), text_of(f, "bus"), shown(number_of(f, "level"), known ? "{:.3f}" : "{:.3f}?"),
                  shown(number_of(f, "drive"), "{:.3f}"), shown(number_of(f, "gain"), "{:.3f}"),
                  shown(number_of(f, "gain_standard_error"), "{:.3f}")});
  }
  Table points(
      {"point", ">goal lx", ">predicted", ">± se", ">measured", ">age s", ">error", "goal", ">max lx", "limit", "why"});
  for (const json& p : list_of(status, "points")) {
    const auto error = number_of(p, "error");
    points.row({text_of(p, "name"), shown(number_of(p, "goal_lux"), "{:g}"),
                shown(number_of(p, "predicted_lux"), "{:.1f}"), shown(number_of(p, "standard_error_lux"), "{:.1f}"),
                shown(number_of(p, "measured_lux"), "{:.1f}"), shown(number_of(p, "measured_age_s"), "{:.1f}"),
                error ? fmt::format("{:+.1f} %", 100 * *error) : "-", text_of(p, "verdict"),
                shown(number_of(p, "max_lux"), "{:g}"), text_of(p, "limit"),
                text_of(p, "limit_reason").empty() ? text_of(p, "reason") : text_of(p, "limit_reason")});
  }
  fmt::print("\n{}\n{}\n{}", devices.text(), fixtures.text(), points.text());
  if (!list_of(status, "uniformities").empty()) {
    Table even({"surface goal", ">uniformity", ">from", ">to", ">wanted", "verdict"});
    for (const json& u : list_of(status, "uniformities"))
      even.row({text_of(u, "surface_goal"), shown(number_of(u, "uniformity"), "{:.2f}"),
                shown(number_of(u, "low"), "{:.2f}"), shown(number_of(u, "high"), "{:.2f}"),
                shown(number_of(u, "wanted"), "{:g}"), text_of(u, "verdict")});
    fmt::print("\n{}", even.text());
  }
  if (!list_of(status, "bypassed").empty()) {
    Table bypassed({"bypassed", ">for s", "risk"});
    for (const json& b : list_of(status, "bypassed"))
      bypassed.row({text_of(b, "name"), shown(number_of(b, "age_s"), "{:.0f}"), text_of(b, "risk")});
    fmt::print("\n{}", bypassed.text());
  }
  if (list_of(status, "overrides").empty()) return;
  Table by_hand({"by hand", ">set to", ">for s", "until", "at present"});
  for (const json& o : list_of(status, "overrides")) {
    const auto level = number_of(o, "level"), remaining_s = number_of(o, "remaining_s");
    by_hand.row({text_of(o, "name"), level ? shown(level, "{:.3f}") : shown(number_of(o, "goal_lux"), "{:.4g} lx"),
                 shown(number_of(o, "age_s"), "{:.0f}"),
                 flag_of(o, "of_plan") ? "the next plan"
                 : remaining_s         ? fmt::format("in {:.0f} s", *remaining_s)
                                       : "luxrig release",
                 text_of(o, "why").empty() ? "so" : text_of(o, "why")});
  }
  fmt::print("\n{}", by_hand.text());
}

int run_status(const ClientArguments& arguments) {
  const auto daemon = daemon_on(arguments.port, arguments.token);
  if (!daemon) return report_unreachable(daemon.error());
  const auto answer = http_get(*daemon, "/api/status");
  if (!answer) return report_unreachable(no_daemon(arguments.port));
  const json status = json::parse(answer->body, nullptr, false);
  if (answer->status != 200 && status.is_object()) {
    fmt::print(stderr, "luxrig: refused by the daemon: {}\n", text_of(status, "error"));
    return kExitFailed;
  }
  if (!status.is_object()) {
    fmt::print(stderr, "luxrig: what answers on port {} is not a Luxrig daemon\n", arguments.port);
    return kExitFailed;
  }
  if (arguments.json) {
    fmt::print("{}\n", answer->body);
  } else {
    print_status(status);
  }
  return kExitOk;
}

Action declare_status(CLI::App& command) {
  const auto client = std::make_shared<ClientArguments>();
  add_client(command, *client);
  return [client] { return run_status(*client); };
}

}  // namespace

const Command kStatusCommand{"status", command_group::kRun, "what the running daemon does and how its devices are",
                             declare_status};

}  // namespace luxrig
