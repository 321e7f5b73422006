#include "drivers/dmx/desk_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/nearest.h"

namespace luxrig {
namespace {

constexpr std::string_view kInputWords[] = {"none", "merge", "takeover", "standby"};
constexpr std::string_view kHandBackWords[] = {"fade", "at-once", "when-asked"};
constexpr std::string_view kMergeWords[] = {"htp", "ltp"};

}  // namespace

DeskOptions desk_options(const Bus& bus, std::span<const OptionDoc> docs) {
  DeskOptions options;
  const std::string input = string_option(bus, docs, "input"), hand_back = string_option(bus, docs, "input_hand_back");
  if (input != "none") {
    options.rules = DeskRules{input == "merge"      ? DeskMode::merge
                              : input == "takeover" ? DeskMode::takeover
                                                    : DeskMode::standby,
                              hand_back == "fade"      ? HandBack::fade
                              : hand_back == "at-once" ? HandBack::at_once
                                                       : HandBack::when_asked};
  }
  options.offset = static_cast<int>(integer_option(bus, docs, "input_offset"));
  options.port = static_cast<std::uint16_t>(integer_option(bus, docs, "input_port"));
  options.merge = string_option(bus, docs, "input_merge") == "ltp" ? MergeRule::ltp : MergeRule::htp;
  return options;
}

std::vector<Problem> check_desk_options(const Rig& rig, std::size_t bus, std::span<const OptionDoc> docs,
                                        int lowest_universe, int highest_universe) {
  const Bus& entry = rig.buses[bus];
  std::vector<Problem> problems;
  const auto check_word = [&](std::string_view key, std::span<const std::string_view> known) {
    const std::string word = string_option(entry, docs, key);
    if (std::find(known.begin(), known.end(), word) != known.end()) return;
    problems.push_back(problem_at(rig, entry, key, fmt::format("{} = \"{}\" is not known", key, word),
                                  mend_for_unknown(word, known, "leave it out")));
  };
  check_word("input", kInputWords);
  check_word("input_hand_back", kHandBackWords);
  check_word("input_merge", kMergeWords);
  if (string_option(entry, docs, "input") == "none") return problems;
  const auto offset = integer_option(entry, docs, "input_offset");
  for (const Fixture& fixture : rig.fixtures) {
    const auto* patch = std::get_if<DmxPatch>(&fixture.patch);
    if (fixture.bus != bus || patch == nullptr) continue;
    const auto universe = patch->universe + offset;
    if (universe >= lowest_universe && universe <= highest_universe) continue;
    problems.push_back(problem_at(rig, entry, "input_offset",
                                  fmt::format("fixture \"{}\": the desk's universe {} + {} does not exist",
                                              fixture.name, patch->universe, offset),
                                  fmt::format("keep the sum in {}…{}", lowest_universe, highest_universe)));
    break;
  }
  return problems;
}

}  // namespace luxrig
