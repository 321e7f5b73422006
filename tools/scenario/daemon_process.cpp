#include "tools/scenario/daemon_process.h"

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "tools/luxrigd/guardian/guardian_words.h"
#include "tools/process/clock.h"
#include "tools/process/files.h"
#include "tools/process/status_fields.h"

namespace luxrig::scenario {
namespace {

constexpr auto kAskEvery = std::chrono::milliseconds(50);
constexpr int kStatusWait_s = 5, kAnswerWait_s = 120;  // light of turned heads is computed before an apply is answered

}  // namespace

Result<std::unique_ptr<DaemonProcess>> DaemonProcess::start(const Rig& rig, const std::filesystem::path& ports,
                                                            DaemonPlace place) {
  // The socket that is found is of this daemon, not of the one before.
  std::error_code error;
  std::filesystem::remove_all(place.runtime, error);
  std::filesystem::create_directories(place.runtime, error);
  std::filesystem::permissions(place.runtime, std::filesystem::perms::owner_all, error);
  auto child = ChildProcess::start(
      "luxrigd", {rig.file.string(), "--sim-ports", ports.string(), "--port", "0", "--state", place.state.string()},
      {place.log,
       {{"XDG_RUNTIME_DIR", place.runtime.string()},
        {"NOTIFY_SOCKET", ""},  // of the service that runs the test, if any
        {"WATCHDOG_USEC", ""}}});
  if (!child) return tl::unexpected(child.error());
  return std::unique_ptr<DaemonProcess>(new DaemonProcess(rig, std::move(*child), std::move(place)));
}

DaemonProcess::DaemonProcess(const Rig& rig, ChildProcess child, DaemonPlace place)
    : rig_(rig), child_(std::move(child)), place_(std::move(place)) {
  asks_ = std::jthread([this](const std::stop_token& stop) { ask_status(stop); });
  sends_ = std::jthread([this](const std::stop_token& stop) { send_posts(stop); });
}

DaemonProcess::~DaemonProcess() {
  asks_.request_stop();
  sends_.request_stop();
  child_.kill();  // ends what they wait for
}

void DaemonProcess::end() {
  child_.kill();
  sends_.request_stop();
  if (sends_.joinable()) sends_.join();
  for (Post& post : posts_) {
    post.answer = refusal("the daemon has ended");
    answers_.push_back(std::move(post));
  }
  posts_.clear();
  take_answers();
}

std::optional<HttpPeer> DaemonProcess::peer() const {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(place_.runtime / "luxrig", error))
    if (entry.path().extension() == ".socket") {
      HttpPeer peer;
      peer.socket = entry.path().string();
      return peer;
    }
  return std::nullopt;
}

void DaemonProcess::ask_status(const std::stop_token& stop) {
  Time next = now();
  while (!stop.stop_requested()) {
    const auto daemon = peer();
    const auto answer = daemon ? http_get(*daemon, "/api/status", kStatusWait_s) : std::nullopt;
    if (answer && answer->status == 200) {
      auto status = status_of_json(answer->body, rig_);
      const std::lock_guard lock(mutex_);
      if (status)
        seen_ = std::make_shared<const Seen>(Seen{std::move(*status), now()});
      else
        complaint_ = status.error().detail;
    }
    next = std::max(next + kAskEvery, now());
    sleep_until(next);
  }
}

void DaemonProcess::send_posts(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (posted_.wait(lock, stop, [this] { return !posts_.empty(); })) {
    Post post = std::move(posts_.front());
    posts_.pop_front();
    lock.unlock();
    const auto daemon = peer();
    const auto answer = daemon ? http_post_json(*daemon, post.route, post.body, kAnswerWait_s) : std::nullopt;
    if (!answer) {
      post.answer = refusal("the daemon has not answered");
    } else if (answer->status != 200) {
      const auto json = nlohmann::json::parse(answer->body, nullptr, false);
      post.answer = refusal(json.is_object() ? luxrig::text_of(json, "error") : answer->body);
    }
    lock.lock();
    answers_.push_back(std::move(post));
  }
}

std::shared_ptr<const DaemonProcess::Seen> DaemonProcess::seen() const {
  const std::lock_guard lock(mutex_);
  return seen_;
}

std::string DaemonProcess::complaint() const {
  const std::lock_guard lock(mutex_);
  return complaint_;
}

void DaemonProcess::post(std::string route, std::string body, std::function<void(const Result<void>&)> answered) {
  {
    const std::lock_guard lock(mutex_);
    posts_.push_back({std::move(route), std::move(body), std::move(answered)});
  }
  posted_.notify_one();
}

void DaemonProcess::take_answers() {
  std::deque<Post> answers;
  {
    const std::lock_guard lock(mutex_);
    answers.swap(answers_);
  }
  for (const Post& post : answers) post.answered(post.answer);
}

std::optional<pid_t> guardian_of(const std::filesystem::path& state) {
  const std::string text = read_file(state / "guardian.pid").value_or("");
  const auto pid = static_cast<pid_t>(std::strtol(text.c_str(), nullptr, 10));
  if (pid <= 1) return std::nullopt;
  // Its number may be another process's by now; a zombie has no command line.
  const std::string words = read_file(fmt::format("/proc/{}/cmdline", pid)).value_or("");
  const std::string program = words.substr(0, words.find('\0'));
  if (std::filesystem::path(program).filename() != kGuardianName || words.find(state.string()) == std::string::npos)
    return std::nullopt;
  return pid;
}

}  // namespace luxrig::scenario
