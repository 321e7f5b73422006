// level, goal, release: settings by hand while the daemon runs.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "tools/luxrig/commands.h"
#include "tools/process/client.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

using nlohmann::json;

/// The value behind the names; nothing if there is none.
std::optional<double> parsed_value(const std::string& text, bool percent) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  if (rest == end) return value;
  return percent && std::string_view(rest, end) == "%" ? std::optional(value / 100) : std::nullopt;
}

/// "90s", "10min", "2h", "90" (seconds) in seconds; nothing for other text, or if not above 0.
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

struct HeldArguments {
  ClientArguments client;
  std::vector<std::string> words;  ///< names (with * and ? for several), then the value
  std::string for_text;            ///< "10min"; empty = until released
};

int hold(const HeldArguments& arguments, bool level) {
  std::vector<std::string> words = arguments.words;
  const std::optional<double> value = words.size() < 2 ? std::nullopt : parsed_value(words.back(), level);
  if (!value) {
    fmt::print(stderr, "luxrig: {}\n",
               level ? "give names and then a level: luxrig level spot-1 0.05"
                     : "give names and then a goal in lux: luxrig goal desk 150");
    return kExitBadInput;
  }
  words.pop_back();
  json body = {{level ? "fixtures" : "points", words}, {level ? "level" : "goal_lux", *value}};
  if (!arguments.for_text.empty()) {
    const auto for_s = seconds_of(arguments.for_text);
    if (!for_s) {
      fmt::print(stderr, "luxrig: --for {} is no duration: give 90s, 10min or 2h\n", arguments.for_text);
      return kExitBadInput;
    }
    body["for_s"] = *for_s;
  }
  return post(arguments.client, level ? "/api/level" : "/api/goal",
              body.dump(-1, ' ', false, json::error_handler_t::replace), "");
}

Action declare_held(CLI::App& command, const char* names, const char* told, bool level) {
  const auto held = std::make_shared<HeldArguments>();
  command.add_option(names, held->words, told)->required();
  command.add_option("--for", held->for_text, "for how long: 90s, 10min, 2h (else until luxrig release)");
  add_client(command, held->client);
  return [held, level] { return hold(*held, level); };
}

Action declare_level(CLI::App& command) {
  return declare_held(command, "FIXTURE..LEVEL", "names (* and ? for several), then 0…1 or 0%…100%", true);
}

Action declare_goal(CLI::App& command) {
  return declare_held(command, "POINT..LUX", "names (* and ? for several), then the goal in lux", false);
}

Action declare_release(CLI::App& command) {
  const auto held = std::make_shared<HeldArguments>();
  command.add_option("NAME", held->words, "fixtures and points (* and ? for several), or all")->required();
  add_client(command, held->client);
  return [held] {
    const bool all = held->words == std::vector<std::string>{"all"};
    const json body = all ? json{{"all", true}} : json{{"names", held->words}};
    return post(held->client, "/api/release", body.dump(-1, ' ', false, json::error_handler_t::replace), "");
  };
}

}  // namespace

const Command kLevelCommand{"level", command_group::kRun, "hold fixtures at a level by hand, until they are released",
                            declare_level};
const Command kGoalCommand{"goal", command_group::kRun, "hold points at another goal by hand, until they are released",
                           declare_goal};
const Command kReleaseCommand{"release", command_group::kRun, "what was set by hand goes back to the plan",
                              declare_release};

}  // namespace luxrig
