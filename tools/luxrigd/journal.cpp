#include "tools/luxrigd/journal.h"

#include <fmt/format.h>

#include <cctype>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>

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
  if (!folder_) return {};
  std::error_code error;
  std::filesystem::create_directories(*folder_, error);
  if (error)
    return tl::unexpected(Fault{Cause::system, {}, "cannot make " + folder_->string() + ": " + error.message(), {}});
  nlohmann::json by_hand = nlohmann::json::array();
  for (const SavedByHand& one : state.by_hand) {
    nlohmann::json entry = {
        {"goal", one.goal}, {"name", one.name}, {"value", one.value}, {"since_unix_s", one.since_unix_s}};
    if (one.until_unix_s) entry["until_unix_s"] = *one.until_unix_s;
    by_hand.push_back(std::move(entry));
  }
  const nlohmann::json out = {
      {"luxrig_state", 1},         {"plan", state.plan_json},          {"blackout", state.blackout},
      {"parked", state.parked},    {"plan_of_rig", state.plan_of_rig}, {"by_hand", std::move(by_hand)},
      {"bypassed", state.bypassed}};
  return write_file(file(), out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
}

void Journal::tell(const Result<void>& saved) {
  const std::lock_guard lock(told_mutex_);
  unsaved_ = saved ? std::nullopt : std::optional(saved.error().detail);
}

JournalState Journal::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::optional<std::string> Journal::unsaved() const {
  const std::lock_guard lock(told_mutex_);
  return unsaved_;
}

Result<void> Journal::save_first(const Change& change) {
  const std::lock_guard lock(mutex_);
  JournalState next = state_;
  change(next);
  if (auto saved = save(next); !saved) return saved;
  state_ = std::move(next);
  tell({});
  return {};
}

Result<void> Journal::keep(const Change& change) {
  const std::lock_guard lock(mutex_);
  change(state_);
  const auto saved = save(state_);
  tell(saved);
  return saved;
}

Journal::Left Journal::load() const {
  Left left;
  std::error_code error;
  if (!folder_ || !std::filesystem::exists(file(), error)) return left;
  const auto text = read_file(file());
  if (!text) {
    left.complaints.push_back(text.error().front().text());
    return left;
  }
  const auto json = nlohmann::json::parse(*text, nullptr, false);
  JournalState state;
  std::string missing;
  const auto want = [&](const char* key, auto is) {
    const bool there = json.is_object() && json.contains(key) && (json[key].*is)();
    if (!there) missing += fmt::format("{}{}", missing.empty() ? "" : ", ", key);
    return there;
  };
  using Json = nlohmann::json;
  if (want("blackout", &Json::is_boolean)) {
    state.blackout = json["blackout"];
  } else {
    // Torn by a failing disk: the word may still stand there, and dark is what was asked for last.
    state.blackout = std::regex_search(*text, std::regex("\"blackout\"\\s*:\\s*true"));
  }
  if (want("plan", &Json::is_string)) state.plan_json = json["plan"].get<std::string>();
  if (!want("luxrig_state", &Json::is_number_integer) || json["luxrig_state"] != 1) {
    if (missing.empty()) missing = "luxrig_state";
  }
  if (json.is_object()) {
    // Older versions did not write these.
    const auto names = [&](const char* key, std::vector<std::string>& into) {
      if (!json.contains(key) || !json[key].is_array()) return;
      for (const auto& one : json[key])
        if (one.is_string()) into.push_back(one.get<std::string>());
    };
    names("parked", state.parked);
    names("bypassed", state.bypassed);
    if (json.contains("plan_of_rig") && json["plan_of_rig"].is_boolean()) state.plan_of_rig = json["plan_of_rig"];
    if (json.contains("by_hand") && json["by_hand"].is_array())
      for (const auto& one : json["by_hand"])
        if (auto saved = by_hand_of(one)) state.by_hand.push_back(std::move(*saved));
  }
  left.state = std::move(state);
  if (missing.empty()) return left;
  const std::filesystem::path aside = file().string() + ".damaged";
  std::filesystem::rename(file(), aside, error);
  left.complaints.push_back(
      fmt::format("{}: the saved state is damaged ({}); {}{}", file().string(),
                  json.is_discarded() ? std::string("no JSON") : "without " + missing,
                  left.state->blackout ? "the blackout that was in force holds" : "what is legible of it holds",
                  error ? std::string() : ", the file is kept as " + aside.filename().string()));
  return left;
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
