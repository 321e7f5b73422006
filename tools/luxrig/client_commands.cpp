// status, page, blackout, apply, level, goal, release, bypass, reload, park, identify: commands that talk to a running
// daemon.
#include <charconv>
#include <cmath>

#include "tools/luxrig/command.h"
#include "tools/luxrig/commands.h"
#include "tools/luxrig/status_fields.h"
#include "tools/luxrig/table.h"
#include "tools/luxrigd/meeting_place.h"

namespace luxrig {
namespace {

using nlohmann::json;

/// Without the name of the cause, which says no more than the text.
int report_unreachable(const Fault& fault) {
  fmt::print(stderr, "luxrig: {}\n", fault.detail);
  return fault.cause == Cause::invalid ? kExitBadInput : kExitFailed;
}

int post(const ClientArguments& arguments, const char* route, const std::string& body, const std::string& done,
         int wait_s = 5) {
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

/// The value behind the names; nothing when there is none.
std::optional<double> value_of(const std::string& text, bool percent) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  if (rest == end) return value;
  return percent && std::string_view(rest, end) == "%" ? std::optional(value / 100) : std::nullopt;
}

int hold(const ClientArguments& arguments, std::vector<std::string> words, const std::string& for_text, bool level) {
  const std::optional<double> value = words.size() < 2 ? std::nullopt : value_of(words.back(), level);
  if (!value) {
    fmt::print(stderr, "luxrig: {}\n",
               level ? "give names and then a level: luxrig level spot-1 0.05"
                     : "give names and then a goal in lux: luxrig goal desk 150");
    return kExitBadInput;
  }
  words.pop_back();
  json body = {{level ? "fixtures" : "points", words}, {level ? "level" : "goal_lux", *value}};
  if (!for_text.empty()) {
    const auto for_s = seconds_of(for_text);
    if (!for_s) {
      fmt::print(stderr, "luxrig: --for {} is no duration: give 90s, 10min or 2h\n", for_text);
      return kExitBadInput;
    }
    body["for_s"] = *for_s;
  }
  return post(arguments, level ? "/api/level" : "/api/goal", body.dump(-1, ' ', false, json::error_handler_t::replace),
              "");
}

void print_status(const json& status) {
  fmt::print("{}: {}{}{}: {}\n", text_of(status, "rig"), text_of(status, "phase"),
             flag_of(status, "blackout") ? ", BLACKOUT" : "", flag_of(status, "plan_waits") ? ", a plan waits" : "",
             text_of(status, "detail"));
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

}  // namespace

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

int run_blackout(const ClientArguments& arguments, bool on) {
  return post(arguments, "/api/blackout", json{{"on", on}}.dump(), on ? "blackout" : "blackout lifted");
}

int run_page(const ClientArguments& arguments) {
  const auto daemon = daemon_on(arguments.port, arguments.token);
  if (!daemon) return report_unreachable(daemon.error());
  const auto answer = http_post_json(*daemon, "/api/session", "{}");
  const std::string address = answer ? text_of(json::parse(answer->body, nullptr, false), "address") : "";
  if (address.empty()) return report_unreachable(no_daemon(arguments.port));
  fmt::print("{}\n", arguments.json ? answer->body : address);
  return kExitOk;
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

std::optional<double> seconds_of(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || !std::isfinite(value) || value <= 0) return std::nullopt;
  const std::string_view unit(rest, end);
  constexpr std::pair<std::string_view, double> kUnits[] = {{"", 1}, {"s", 1}, {"min", 60}, {"h", 3600}};
  for (const auto& [name, seconds] : kUnits)
    if (unit == name) return value * seconds;
  return std::nullopt;
}

int run_level(const ClientArguments& arguments, const std::vector<std::string>& names_and_level,
              const std::string& for_text) {
  return hold(arguments, names_and_level, for_text, true);
}

int run_goal(const ClientArguments& arguments, const std::vector<std::string>& names_and_lux,
             const std::string& for_text) {
  return hold(arguments, names_and_lux, for_text, false);
}

int run_release(const ClientArguments& arguments, const std::vector<std::string>& names) {
  const bool all = names == std::vector<std::string>{"all"};
  const json body = all ? json{{"all", true}} : json{{"names", names}};
  return post(arguments, "/api/release", body.dump(-1, ' ', false, json::error_handler_t::replace), "");
}

int run_bypass(const ClientArguments& arguments, const std::vector<std::string>& names, bool undo) {
  const json body = {{"names", names}, {"on", !undo}};
  return post(arguments, "/api/bypass", body.dump(-1, ' ', false, json::error_handler_t::replace), "");
}

int run_reload(const ClientArguments& arguments) {
  // The rig is solved before anything changes.
  return post(arguments, "/api/reload", "{}", "", 300);
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
