#include "tools/scenario/status_of_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text/plain_text.h"

namespace luxrig::scenario {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxList = 100'000;

class StatusReader {
 public:
  StatusReader(const json& root, const Rig& rig) : root_(root), rig_(rig) {}

  Result<DaemonStatus> read() {
    if (!root_.is_object()) return refusal("the daemon's status is no JSON object");
    ShowStatus& show = status_.show;
    read_phase();
    show.blackout = flag(root_, "blackout", true);
    show.plan_waits = flag(root_, "plan_waits", false);
    status_.time_s = number(root_, "time_s");
    read_goals();
    read_named("points", rig_.points, [&](const json& entry) {
      PointStatus point;
      if (entry.contains("goal_lux")) point.goal_lx = number(entry, "goal_lux");
      if (entry.contains("verdict")) point.verdict = verdict_named(text(entry, "verdict"));
      if (entry.contains("verdict") && !point.verdict) wrong("verdict");
      show.points.push_back(std::move(point));
    });
    read_named("fixtures", rig_.fixtures, [&](const json& entry) {
      FixtureStatus fixture;
      if (entry.contains("level")) fixture.level = number(entry, "level");
      show.fixtures.push_back(fixture);
    });
    for (const json& entry : list("alarms"))
      show.alarms.push_back({flag(entry, "severe", true), text(entry, "device"), text(entry, "text"), {}});
    for (const json& entry : list("overrides")) read_by_hand(entry);
    read_sent();
    read_silent();
    if (!wrong_.empty()) return refusal(fmt::format("the daemon's status has no good \"{}\"", wrong_));
    return std::move(status_);
  }

 private:
  void wrong(const char* key) {
    if (wrong_.empty()) wrong_ = key;
  }
  const json* member(const json& object, const char* key) {
    if (!object.is_object()) return nullptr;
    const auto it = object.find(key);
    return it == object.end() ? nullptr : &*it;
  }
  double number(const json& object, const char* key) {
    const json* value = member(object, key);
    if (value != nullptr && value->is_number() && std::isfinite(value->get<double>())) return value->get<double>();
    wrong(key);
    return 0;
  }
  int count(const json& object, const char* key) {
    const double value = number(object, key);
    if (value >= 0 && value <= 1e6) return static_cast<int>(value);
    wrong(key);
    return 0;
  }
  bool flag(const json& object, const char* key, bool must) {
    const json* value = member(object, key);
    if (value == nullptr && !must) return false;
    if (value != nullptr && value->is_boolean()) return value->get<bool>();
    wrong(key);
    return false;
  }
  /// As it may be shown to a person.
  std::string text(const json& object, const char* key) {
    const json* value = member(object, key);
    if (value != nullptr && value->is_string()) return made_plain(value->get_ref<const std::string&>());
    wrong(key);
    return {};
  }
  const json& list(const char* key) {
    static const json none = json::array();
    const json* value = member(root_, key);
    if (value != nullptr && value->is_array() && value->size() <= kMaxList) return *value;
    wrong(key);
    return none;
  }

  void read_phase() {
    const std::string name = text(root_, "phase");
    for (int phase = 0; phase <= static_cast<int>(Phase::safe); ++phase) {
      status_.show.phase = static_cast<Phase>(phase);
      if (name == luxrig::name_of(status_.show.phase)) return;
    }
    wrong("phase");
  }

  void read_goals() {
    const json* goals = member(root_, "goals");
    if (goals == nullptr) return wrong("goals");
    VerdictCounts& counts = status_.show.goals;
    counts.met = count(*goals, "met");
    counts.missed = count(*goals, "missed");
    counts.unknown = count(*goals, "unknown");
  }

  /// The list of these items of the rig, each once and in the rig's order.
  template <class Items, class Take>
  void read_named(const char* key, const Items& items, const Take& take) {
    const json& entries = list(key);
    if (entries.size() != items.size()) return wrong(key);
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (text(entries[i], "name") != made_plain(items[i].name)) return wrong(key);
      take(entries[i]);
    }
  }

  template <class Items>
  std::size_t index_in(const Items& items, const std::string& name) {
    for (std::size_t i = 0; i < items.size(); ++i)
      if (made_plain(items[i].name) == name) return i;
    wrong("overrides");
    return 0;
  }

  void read_by_hand(const json& entry) {
    ByHand held;
    const std::string kind = text(entry, "kind"), name = text(entry, "name");
    const bool level = kind == "level";
    if (!level && kind != "goal") return wrong("overrides");
    held.what = level ? ByHand::What::level : ByHand::What::goal;
    held.index = level ? index_in(rig_.fixtures, name) : index_in(rig_.points, name);
    held.value = number(entry, level ? "level" : "goal_lux");
    held.of_plan = flag(entry, "of_plan", false);
    if (entry.is_object() && entry.contains("remaining_s")) {
      const double remaining_s = number(entry, "remaining_s");
      if (!(remaining_s >= 0 && remaining_s <= 1e9)) return wrong("remaining_s");
      held.until = Time{} + from_seconds(std::clamp(status_.time_s, 0.0, 1e9) + remaining_s);
    }
    status_.show.by_hand.push_back(held);
  }

  void read_sent() {
    status_.sent.assign(rig_.buses.size(), 0);
    status_.sends.assign(rig_.buses.size(), false);
    for (const json& entry : list("devices")) {
      const std::string name = text(entry, "name");
      for (std::size_t b = 0; b < rig_.buses.size(); ++b) {
        if (made_plain(rig_.buses[b].name) != name) continue;
        const json* sent = member(entry, "sent");
        if (sent == nullptr || !sent->is_number_unsigned()) return wrong("sent");
        status_.sent[b] = sent->get<std::uint64_t>();
        status_.sends[b] = text(entry, "life") == luxrig::name_of(Life::active);
      }
    }
  }

  /// A desk's part is called by its bus and universe. In idle, the first plan waits for a desk.
  void read_silent() {
    for (const json& entry : list("desks")) {
      const std::string name = text(entry, "name");
      if (!flag(entry, "silent", true)) continue;
      for (std::size_t b = 0; b < rig_.buses.size(); ++b)
        if (name.starts_with(made_plain(rig_.buses[b].name))) status_.sends[b] = false;
    }
    if (status_.show.phase == Phase::idle) status_.sends.assign(rig_.buses.size(), false);
  }

  const json& root_;
  const Rig& rig_;
  DaemonStatus status_;
  std::string wrong_;  ///< the first key that is wrong
};

/// Nested deeper than a status ever is.
bool too_deep(int depth, json::parse_event_t, json&) { return depth <= 16; }

}  // namespace

Result<DaemonStatus> status_of_json(std::string_view text, const Rig& rig) {
  const json root = json::parse(text, too_deep, false);
  return StatusReader(root, rig).read();
}

}  // namespace luxrig::scenario
