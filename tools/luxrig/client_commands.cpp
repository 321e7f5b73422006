// status, blackout, apply, park, identify: commands that talk to a running daemon.
#include "tools/luxrig/command.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/http_client.h"
#include "tools/luxrig/status_fields.h"
#include "tools/luxrig/table.h"

namespace luxrig {
namespace {

using nlohmann::json;

int post(const ClientArguments& arguments, const char* route, const std::string& body, const std::string& done,
         int wait_s = 5) {
  const auto answer = http_post_json("127.0.0.1", arguments.port, route, body, wait_s);
  if (!answer) return no_daemon(arguments.port);
  if (answer->status != 200) {
    const json body_json = json::parse(answer->body, nullptr, false);
    const std::string reason = body_json.is_object() ? text_of(body_json, "error") : answer->body;
    fmt::print(stderr, "luxrig: refused by the daemon: {}\n", reason);
    return answer->status == 400 ? kExitBadInput : kExitFailed;
  }
  fmt::print("{}\n", arguments.json ? answer->body : done);
  return kExitOk;
}

void print_status(const json& status) {
  fmt::print("{}: {}{}: {}\n", text_of(status, "rig"), text_of(status, "phase"),
             flag_of(status, "blackout") ? ", BLACKOUT" : "", text_of(status, "detail"));
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
}

}  // namespace

int no_daemon(int port) {
  fmt::print(stderr, "luxrig: no daemon answers on 127.0.0.1:{}: start one with `luxrig run RIG`, or give its --port\n",
             port);
  return kExitFailed;
}

int run_status(const ClientArguments& arguments) {
  const auto answer = http_get("127.0.0.1", arguments.port, "/api/status");
  if (!answer) return no_daemon(arguments.port);
  if (arguments.json) {
    fmt::print("{}\n", answer->body);
    return kExitOk;
  }
  const json status = json::parse(answer->body, nullptr, false);
  if (!status.is_object()) {
    fmt::print(stderr, "luxrig: what answers on port {} is not a Luxrig daemon\n", arguments.port);
    return kExitFailed;
  }
  print_status(status);
  return kExitOk;
}

int run_blackout(const ClientArguments& arguments, bool on) {
  return post(arguments, "/api/blackout", json{{"on", on}}.dump(), on ? "blackout" : "blackout lifted");
}

int run_hand_back(const ClientArguments& arguments) {
  return post(arguments, "/api/hand-back", "{}", "desks that wait for the light get it");
}

int run_park(const ClientArguments& arguments, const std::vector<std::string>& fixtures) {
  return post(arguments, "/api/park", json{{"fixtures", fixtures}}.dump(),
              fixtures.empty()
                  ? "heads go dark and to where they rest, until the next apply"
                  : fmt::format("{} go dark and to where they rest, until the next apply", fmt::join(fixtures, ", ")));
}

int run_identify(const ClientArguments& arguments, const std::string& fixture, double seconds) {
  return post(arguments, "/api/identify", json{{"fixture", fixture}, {"seconds", seconds}}.dump(),
              fmt::format("{} blinks, or nods, for {:g} s", fixture, seconds));
}

int run_apply(const ClientArguments& arguments, const std::filesystem::path& plan) {
  const auto body = read_file(plan);
  if (!body) return report(body.error());
  // Checked here first: the messages then carry the file's name.
  if (const auto parsed = plan_from_json(*body, plan.string()); !parsed) return report(parsed.error());
  // A plan that turns heads waits for the light that it makes to be worked out.
  return post(arguments, "/api/apply", *body, "applied: " + plan.string(), 300);
}

}  // namespace luxrig
