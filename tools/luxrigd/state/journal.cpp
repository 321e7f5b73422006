#include "tools/luxrigd/state/journal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

#include "tools/process/files.h"

namespace luxrig {
namespace {

/// nullopt if it is damaged: the rest of the state is worth more than a complaint.
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

/// Finds "blackout": true anywhere in a text that is not JSON. (A regular expression on a long hostile text ends the
/// program.)
bool asks_for_blackout(std::string_view text) {
  constexpr std::string_view kKey = "\"blackout\"";
  const auto space_skipped = [](std::string_view rest) {
    return rest.substr(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
  };
  // The quote that ends one find may begin the next one.
  for (auto at = text.find(kKey); at != std::string_view::npos; at = text.find(kKey, at + kKey.size() - 1)) {
    std::string_view rest = space_skipped(text.substr(at + kKey.size()));
    if (!rest.starts_with(':')) continue;
    rest.remove_prefix(1);
    if (space_skipped(rest).starts_with("true")) return true;
  }
  return false;
}

}  // namespace

std::string state_text(const JournalState& state) {
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
  return out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace);
}

LegibleState legible_state_of(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  LegibleState legible;
  JournalState& state = legible.state;
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
    // Torn by a failing disk: the key may still be legible, and dark was the last order.
    state.blackout = asks_for_blackout(text);
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
  if (!missing.empty()) legible.damage = json.is_discarded() ? "no JSON" : "without " + missing;
  return legible;
}

Result<void> Journal::make_folder() {
  const auto failed = [&](const std::string& why) {
    return tl::unexpected(Fault{Cause::system, {}, "cannot make " + folder_->string() + ": " + why, {}});
  };
  std::error_code error;
  const auto whole = std::filesystem::absolute(*folder_, error).lexically_normal();
  std::vector<std::filesystem::path> holders;
  for (auto at = whole; !error && !std::filesystem::exists(at, error) && !error; at = at.parent_path())
    holders.push_back(at.parent_path());
  if (error) return failed(error.message());
  std::filesystem::create_directories(whole, error);
  if (error) return failed(error.message());
  unsynced_.insert(unsynced_.end(), holders.begin(), holders.end());
  for (; !unsynced_.empty(); unsynced_.pop_back())
    if (!sync_folder(unsynced_.back())) return failed(std::strerror(errno));
  return {};
}

Result<void> Journal::save(const JournalState& state) {
  if (!folder_) return {};
  if (auto made = make_folder(); !made) return made;
  return write_file(file(), state_text(state));
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
  if (auto saved = save(next); !saved) {
    // Only syncing the folder may have failed, with the refused state on disk already.
    if (read_file(file()).value_or("") == state_text(next)) tell(save(state_));
    return saved;
  }
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
  if (!folder_ || (!std::filesystem::exists(file(), error) && !error)) return left;
  const auto text = read_file(file());
  if (!text) {
    left.complaints.push_back(text.error().front().text() + keep_aside());
    return left;
  }
  auto legible = legible_state_of(*text);
  left.state = std::move(legible.state);
  if (!legible.damage.empty())
    left.complaints.push_back(fmt::format(
        "{}: the saved state is damaged ({}); {}{}", file().string(), legible.damage,
        left.state->blackout ? "the blackout that was in force holds" : "what is legible of it holds", keep_aside()));
  return left;
}

std::string Journal::keep_aside() const {
  const std::filesystem::path aside = file().string() + ".damaged";
  std::error_code error;
  std::filesystem::remove(aside, error);
  std::filesystem::create_hard_link(file(), aside, error);
  return error ? std::string() : ", the file is kept as " + aside.filename().string();
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
