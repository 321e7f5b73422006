#include "tools/luxrigd/state/change_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "core/fingerprint.h"
#include "tools/process/utc_time.h"

namespace luxrig {
namespace {

using nlohmann::json;

constexpr std::size_t kNewest = 200, kMostWaiting = 500;

std::string line_of(const json& change) { return change.dump(-1, ' ', false, json::error_handler_t::replace); }

}  // namespace

json settings_of(const JournalState& state) {
  json out = {{"blackout", state.blackout},
              {"held", json::object()},
              {"goals", json::object()},
              {"parked", state.parked},
              {"bypassed", state.bypassed}};
  for (const SavedByHand& one : state.by_hand) out[one.goal ? "goals" : "held"][one.name] = one.value;
  if (!state.plan_json.empty()) {
    Fingerprint fingerprint;
    fingerprint.add(state.plan_json);
    out["plan"] = fmt::format("{:016x}", fingerprint.value());
  }
  return out;
}

json changes_between(const json& before, const json& after) {
  json out = json::object();
  const auto at = [](const json& in, const std::string& key) { return in.contains(key) ? in[key] : json(); };
  const auto compare = [&](const json& was, const json& is, const std::string& prefix) {
    for (const json* one : {&was, &is})
      for (const auto& [key, value] : one->items())
        if (!(prefix.empty() && value.is_object()) && at(was, key) != at(is, key))
          out[prefix + key] = json::array({at(was, key), at(is, key)});
  };
  if (!before.is_object() || !after.is_object()) return out;
  compare(before, after, "");
  for (const char* by_name : {"held", "goals"}) {
    const json was = at(before, by_name), is = at(after, by_name);
    compare(was.is_object() ? was : json::object(), is.is_object() ? is : json::object(), std::string(by_name) + " ");
  }
  return out;
}

ChangeLog::ChangeLog(std::optional<std::filesystem::path> folder, std::size_t most_bytes)
    : folder_(std::move(folder)), most_bytes_(most_bytes) {
  if (!folder_) return;
  read_newest();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

ChangeLog::~ChangeLog() = default;

void ChangeLog::read_newest() {
  std::error_code error;
  for (const char* name : {"changes.1.jsonl", "changes.jsonl"}) {
    std::ifstream in(*folder_ / name, std::ios::binary);
    for (std::string line; std::getline(in, line);) {
      if (!json::parse(line, nullptr, false).is_object()) continue;  // cut short by a power cut
      if (newest_.size() >= kNewest) newest_.pop_front();
      newest_.push_back(line);
    }
  }
}

void ChangeLog::add(json change) {
  change["at"] = utc_now();
  {
    const std::lock_guard lock(mutex_);
    if (left_out_ > 0 && waiting_.size() < kMostWaiting / 2) {
      change["left_out_before"] = left_out_;
      left_out_ = 0;
    }
    std::string line = line_of(change);
    if (newest_.size() >= kNewest) newest_.pop_front();
    newest_.push_back(line);
    if (!folder_) return;
    if (waiting_.size() >= kMostWaiting) {
      waiting_.pop_front();
      ++left_out_;
    }
    waiting_.push_back(std::move(line));
  }
  wake_.notify_one();
}

std::string ChangeLog::newest() const {
  const std::lock_guard lock(mutex_);
  std::string list;
  for (const std::string& line : newest_) list += (list.empty() ? "" : ",\n") + line;
  return "[" + list + "]";
}

void ChangeLog::flush() {
  std::unique_lock lock(mutex_);
  written_.wait(lock, [this] { return waiting_.empty() && !writing_; });
}

void ChangeLog::write(const std::string& lines) {
  std::error_code error;
  std::filesystem::create_directories(*folder_, error);
  const auto file = *folder_ / "changes.jsonl";
  struct stat about {};
  if (::stat(file.c_str(), &about) == 0 && static_cast<std::size_t>(about.st_size) + lines.size() > most_bytes_)
    std::filesystem::rename(file, *folder_ / "changes.1.jsonl", error);
  const int to = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (to < 0) return;  // the journal's alarm says what is wrong with the folder
  // A line that a power cut has left unfinished must not take the next one with it.
  char last = '\n';
  const int from = about.st_size > 0 ? ::open(file.c_str(), O_RDONLY | O_CLOEXEC) : -1;
  if (from >= 0 && ::lseek(from, -1, SEEK_END) >= 0) (void)!::read(from, &last, 1);
  if (from >= 0) ::close(from);
  const std::string text = (last == '\n' ? "" : "\n") + lines;
  (void)!::write(to, text.data(), text.size());
  ::close(to);
}

void ChangeLog::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, stop, [this] { return !waiting_.empty(); });
    if (waiting_.empty()) return;
    std::string lines;
    for (const std::string& line : waiting_) lines += line + "\n";
    waiting_.clear();
    writing_ = true;
    lock.unlock();
    write(lines);
    lock.lock();
    writing_ = false;
    written_.notify_all();
  }
}

}  // namespace luxrig
