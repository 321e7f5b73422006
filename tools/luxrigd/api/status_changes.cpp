#include "tools/luxrigd/api/status_changes.h"

#include <fmt/format.h>

#include <charconv>
#include <random>

#include "tools/luxrigd/api/status_parts.h"

namespace luxrig {
namespace {

std::string dumped(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::uint64_t random_word() {
  std::random_device random;
  return (std::uint64_t{random()} << 32U) | random();
}

}  // namespace

StatusChanges::StatusChanges() : daemon_(random_word()) {}

std::string StatusChanges::prefix() const { return fmt::format("{:016x}-{}-", daemon_, rigs_); }

void StatusChanges::put(Item& item, std::string text) {
  if (item.json == text) return;
  if (!changing_) ++number_;
  changing_ = true;
  item = {std::move(text), number_};
}

void StatusChanges::take(const StatusInput& input) {
  changing_ = false;
  if (input.now < taken_) return;  // of another thread that was slower
  const StatusParts parts(input, StatusParts::Times::instants);
  const auto rest = parts.rest();
  for (auto& [key, item] : rest_)
    if (!rest.contains(key)) put(item, "null");
  for (const auto& [key, value] : rest.items()) put(rest_[key], dumped(value));
  if (input.now == taken_) return;
  taken_ = input.now;
  const auto put_list = [&](const char* key, std::size_t count, auto&& now) {
    std::vector<Item>& items = lists_[key];
    items.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      nlohmann::json entry = now(i);
      entry["index"] = i;
      put(items[i], dumped(entry));
    }
  };
  put_list("fixtures", input.show.fixtures.size(), [&](std::size_t i) { return parts.fixture(i); });
  put_list("points", input.show.points.size(), [&](std::size_t i) { return parts.point(i); });
  put_list("luxmeters", input.rig.luxmeters.size(), [&](std::size_t i) { return parts.luxmeter(i); });
  put_list("devices", input.devices.size(), [&](std::size_t i) { return parts.device(i); });
}

std::string StatusChanges::since(std::string_view version, const StatusInput& input, std::shared_ptr<const void> rig,
                                 std::string_view rig_etag) {
  const std::lock_guard lock(mutex_);
  // Lists get shorter with another rig, or with another set of devices: what is gone has no change to tell it by.
  if (rig != rig_ || input.devices.size() < lists_["devices"].size()) {
    rig_ = std::move(rig);
    ++rigs_;
    rest_.clear();
    lists_.clear();
    taken_ = {};
  }
  take(input);
  const std::string before = prefix();
  std::uint64_t since = 0;
  bool known = version.substr(0, before.size()) == before;
  if (known) {
    const std::string_view digits = version.substr(before.size());
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), since);
    known = error == std::errc() && end == digits.data() + digits.size() && since <= number_;
  }
  if (!known) since = 0;
  std::string out = fmt::format("{{\"version\":\"{}{}\",\"whole\":{},\"time_s\":{:.3f}", before, number_, !known,
                                to_seconds(input.now - input.started));
  if (!rig_etag.empty()) out += fmt::format(",\"rig_etag\":\"{}\"", rig_etag);
  out += ",\"changed\":{";
  const char* comma = "";
  for (const auto& [key, item] : rest_) {
    if (item.changed <= since && known) continue;
    out += fmt::format("{}\"{}\":{}", comma, key, item.json);
    comma = ",";
  }
  out += "}";
  for (const auto& [key, items] : lists_) {
    comma = "";
    std::string entries;
    for (const Item& item : items) {
      if (item.changed <= since && known) continue;
      entries += comma + item.json;
      comma = ",";
    }
    if (!entries.empty() || !known) out += fmt::format(",\"{}\":[{}]", key, entries);
  }
  return out + "}";
}

}  // namespace luxrig
