#include "tools/luxrigd/journal.h"

#include <cctype>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tools/luxrig/commands.h"

namespace luxrig {
namespace {

/// Nothing when it is damaged: the rest of the state is worth more than a complaint.
std::optional<SavedByHand> by_hand_of(const nlohmann::json& entry) {
  const auto has = [&](const char* key, auto is) { return entry.contains(key) && (entry[key].*is)(); };
  using Json = nlohmann::json;
  if (!entry.is_object() || !has("goal", &Json::is_boolean) || !has("name", &Json::is_string) ||
      !has("value", &Json::is_number) || !has("since_unix_s", &Json::is_number))
    return std::nullopt;
  SavedByHand saved{entry["goal"], entry["name"], entry["value"], entry["since_unix_s"], std::nullopt};
  if (has("until_unix_s", &Json::is_number)) saved.until_unix_s = entry["until_unix_s"].get<double>();
  return saved;
}

}  // namespace

Result<void> Journal::save(const JournalState& state) const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    return tl::unexpected(Fault{Cause::system, {}, "cannot make " + folder_.string() + ": " + error.message(), {}});
  }
  nlohmann::json by_hand = nlohmann::json::array();
  for (const SavedByHand& one : state.by_hand) {
    nlohmann::json entry = {
        {"goal", one.goal}, {"name", one.name}, {"value", one.value}, {"since_unix_s", one.since_unix_s}};
    if (one.until_unix_s) entry["until_unix_s"] = *one.until_unix_s;
    by_hand.push_back(std::move(entry));
  }
  const nlohmann::json out = {
      {"luxrig_state", 1},      {"plan", state.plan_json},          {"blackout", state.blackout},
      {"parked", state.parked}, {"plan_of_rig", state.plan_of_rig}, {"by_hand", std::move(by_hand)}};
  return write_file(file(), out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
}

Checked<std::optional<JournalState>> Journal::load() const {
  std::error_code error;
  if (!std::filesystem::exists(file(), error)) return std::nullopt;
  const auto text = read_file(file());
  if (!text) return tl::unexpected(text.error());
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  if (!json.is_object() || json.value("luxrig_state", 0) != 1 || !json.contains("plan") || !json["plan"].is_string() ||
      !json.contains("blackout") || !json["blackout"].is_boolean()) {
    return tl::unexpected(std::vector<Problem>{
        {file().string(), 0, 0, "is not a saved state of this program", "move it away to start without it"}});
  }
  JournalState state{json["plan"].get<std::string>(), json["blackout"].get<bool>(), {}};
  // Older versions did not write it.
  if (json.contains("parked") && json["parked"].is_array()) {
    for (const auto& one : json["parked"]) {
      if (one.is_string()) state.parked.push_back(one.get<std::string>());
    }
  }
  if (json.contains("plan_of_rig") && json["plan_of_rig"].is_boolean()) state.plan_of_rig = json["plan_of_rig"];
  if (json.contains("by_hand") && json["by_hand"].is_array()) {
    for (const auto& one : json["by_hand"]) {
      if (auto saved = by_hand_of(one)) state.by_hand.push_back(std::move(*saved));
    }
  }
  return state;
}

std::filesystem::path default_state_folder(const std::string& rig_name) {
  std::string name;
  for (const char c : rig_name) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '-';
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state != nullptr && *state != '\0') return std::filesystem::path(state) / "luxrig" / name;
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home != nullptr ? home : "/var/lib") / ".local/state/luxrig" / name;
}

}  // namespace luxrig
