#include "tools/luxrigd/jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "tools/luxrigd/scheduling.h"
#include "tools/process/files.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxWaiting = 8;
constexpr std::size_t kMaxKept = 16;  ///< that have ended, and their plans
constexpr std::size_t kPrefixLength = 8 + 1, kIdLength = kPrefixLength + 6;

std::string daemon_prefix() {
  std::random_device random;
  return fmt::format("{:08x}-", random());
}

/// An id that some daemon gave: no other text becomes a file name.
bool is_job_id(const std::string& id) {
  return id.size() == kIdLength && id.find_first_not_of("0123456789abcdef-") == std::string::npos &&
         id.find('-') == kPrefixLength - 1 && id.rfind('-') == kPrefixLength - 1;
}

bool has_ended(const Job& job) { return job.state != Job::State::waits && job.state != Job::State::runs; }

}  // namespace

const char* name_of(Job::State state) {
  constexpr const char* kNames[] = {"waits", "runs", "done", "failed", "cancelled", "lost"};
  return kNames[static_cast<std::size_t>(state)];
}

Jobs::Jobs(std::optional<std::filesystem::path> folder) : prefix_(daemon_prefix()), folder_(std::move(folder)) {}

Jobs::~Jobs() { stop(); }

std::filesystem::path Jobs::file_of(const std::string& id) const { return *folder_ / (id + ".json"); }

Result<std::string> Jobs::start(const std::string& kind, Work work) {
  const std::lock_guard lock(mutex_);
  if (stopped_) return refusal("the daemon ends");
  const auto waiting = std::count_if(jobs_.begin(), jobs_.end(), [](const auto& one) { return !has_ended(one->job); });
  if (static_cast<std::size_t>(waiting) >= kMaxWaiting)
    return refusal(fmt::format("{} jobs wait or run: cancel one, or wait", waiting));
  const auto one = std::make_shared<Running>();
  one->job.id = fmt::format("{}{:06x}", prefix_, ++count_ & 0xffffffU);
  one->job.kind = kind;
  one->work = std::move(work);
  jobs_.push_back(one);
  forget_old();
  if (!working_) {
    if (thread_.joinable()) thread_.join();  // it has nothing left to do but end
    working_ = true;
    thread_ = std::thread([this] {
      make_background();
      run_all();
    });
  }
  return one->job.id;
}

void Jobs::run_all() {
  while (true) {
    std::shared_ptr<Running> next;
    {
      const std::lock_guard lock(mutex_);
      const auto found =
          std::find_if(jobs_.begin(), jobs_.end(), [](const auto& one) { return one->job.state == Job::State::waits; });
      if (stopped_ || found == jobs_.end()) {
        working_ = false;
        return;
      }
      next = *found;
      next->job.state = Job::State::runs;
    }
    run(next);
  }
}

void Jobs::run(const std::shared_ptr<Running>& one) {
  Watch watch;
  watch.stop = one->stop.get_token();
  watch.tell = [this, one](const Doing& doing) {
    const std::lock_guard lock(mutex_);
    one->job.stage = doing.stage;
    one->job.doing = doing.what;
    one->job.can_be_taken = doing.can_be_taken && !doing.ended;
  };
  auto result = one->work(watch);
  // On disk first: what is said to be done outlives the daemon.
  std::string unsaved;
  if (result && folder_) {
    std::error_code ignored;
    std::filesystem::create_directories(*folder_, ignored);
    if (const auto saved = write_file(file_of(one->job.id), *result); !saved) unsaved = saved.error().detail;
    remove_old_plans();
  }
  const std::lock_guard lock(mutex_);
  Job& job = one->job;
  one->work = {};
  job.stage.clear();
  job.doing.clear();
  job.can_be_taken = false;
  const bool stopped = one->stop.stop_requested();
  if (result) {
    job.state = stopped ? Job::State::cancelled : Job::State::done;
    job.plan_json = std::move(*result);
    if (!unsaved.empty()) job.why = "its plan would be lost with this daemon: " + unsaved;
  } else {
    job.state = stopped ? Job::State::cancelled : Job::State::failed;
    if (!stopped) job.why = result.error().detail;
  }
  forget_old();
}

/// The lock is held.
void Jobs::forget_old() {
  auto ended = std::count_if(jobs_.begin(), jobs_.end(), [](const auto& one) { return has_ended(one->job); });
  for (auto it = jobs_.begin(); it != jobs_.end() && ended > static_cast<std::ptrdiff_t>(kMaxKept);) {
    if (!has_ended((*it)->job)) {
      ++it;
      continue;
    }
    it = jobs_.erase(it);
    --ended;
  }
}

/// The oldest go, those of earlier daemons first.
void Jobs::remove_old_plans() const {
  std::vector<std::pair<std::filesystem::file_time_type, std::filesystem::path>> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(*folder_, error))
    if (is_job_id(entry.path().stem().string()) && entry.path().extension() == ".json")
      files.emplace_back(entry.last_write_time(error), entry.path());
  std::sort(files.begin(), files.end());
  for (std::size_t i = 0; i + kMaxKept < files.size(); ++i) std::filesystem::remove(files[i].second, error);
}

std::optional<Job> Jobs::at(const std::string& id) const {
  if (!is_job_id(id)) return std::nullopt;
  if (id.compare(0, prefix_.size(), prefix_) == 0) {
    const std::lock_guard lock(mutex_);
    for (const auto& one : jobs_)
      if (one->job.id == id) return one->job;
    return std::nullopt;
  }
  Job earlier;
  earlier.id = id;
  earlier.kind = "solve";
  earlier.state = Job::State::lost;
  earlier.why = "the daemon that had it has ended";
  if (!folder_) return earlier;
  if (auto plan = read_file(file_of(id))) {
    earlier.state = Job::State::done;
    earlier.why.clear();
    earlier.plan_json = std::move(*plan);
  }
  return earlier;
}

std::vector<Job> Jobs::all() const {
  const std::lock_guard lock(mutex_);
  std::vector<Job> all;
  for (const auto& one : jobs_) all.push_back(one->job);
  return all;
}

std::optional<Job> Jobs::cancel(const std::string& id) {
  std::stop_source stop(std::nostopstate);
  {
    const std::lock_guard lock(mutex_);
    for (const auto& one : jobs_) {
      if (one->job.id != id || has_ended(one->job)) continue;
      stop = one->stop;
      if (one->job.state == Job::State::waits) {
        one->job.state = Job::State::cancelled;
        one->work = {};
      }
    }
  }
  stop.request_stop();  // without the lock: what it calls may tell
  return at(id);
}

void Jobs::stop() {
  std::thread running;
  std::vector<std::stop_source> stops;
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    for (const auto& one : jobs_) stops.push_back(one->stop);
    running = std::move(thread_);
  }
  for (std::stop_source& stop : stops) stop.request_stop();
  if (running.joinable()) running.join();
}

}  // namespace luxrig
