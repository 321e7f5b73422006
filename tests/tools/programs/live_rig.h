#pragma once
/// A daemon on a simulator that a test can kill, cut and restart.

#include <nlohmann/json.hpp>

#include "tests/tools/programs/process.h"
#include "tools/process/meeting_place.h"

namespace luxrig::testing {

using nlohmann::json;

/// The printed JSON, after the progress lines of a slow machine.
inline json json_in(const Ran& ran) {
  const auto begin = ran.output.find("{\n");
  return begin == std::string::npos ? json() : json::parse(ran.output.substr(begin), nullptr, false);
}

inline bool has_alarm(const json& status, const std::string& text) {
  for (const json& alarm : status.value("alarms", json::array()))
    if (alarm["text"].get<std::string>().find(text) != std::string::npos) return true;
  return false;
}

/// Level of a fixture in a status; -1 if it is not there.
inline double level_of(const json& status, const std::string& fixture) {
  for (const json& one : status.value("fixtures", json::array()))
    if (one["name"] == fixture) return one.value("level", -1.0);
  return -1;
}

class LiveRig {
 public:
  explicit LiveRig(std::string rig, std::vector<std::string> options = {}, std::vector<std::string> sim_options = {})
      : rig_(std::move(rig)), options_(std::move(options)), sim_options_(std::move(sim_options)) {
    start_sim();
    start_daemon();
  }
  /// Also ends the guardian, which outlives a daemon that the test kills.
  ~LiveRig() {
    daemon_.reset();
    for (int i = 0; i < 10; ++i) {
      const pid_t guardian = guardian_pid();
      if (guardian <= 1 || !runs(guardian)) break;
      ::kill(guardian, SIGTERM);
      std::this_thread::sleep_for(100ms);
    }
  }
  LiveRig(const LiveRig&) = delete;
  LiveRig& operator=(const LiveRig&) = delete;

  void start_daemon() {
    port_ = 0;
    std::filesystem::remove(folder_ / "daemon.log");  // it contains the last daemon's port
    std::vector<std::string> words = {program("luxrig"),
                                      "run",
                                      rig_,
                                      "--sim-ports",
                                      ports().string(),
                                      "--port",
                                      "0",
                                      "--max-error",
                                      "0.02",
                                      "--state",
                                      (folder_ / "state").string()};
    words.insert(words.end(), options_.begin(), options_.end());
    daemon_ = std::make_unique<Process>(std::move(words), folder_ / "daemon.log");
  }

  /// Process id of the guardian; 0 if there is none.
  [[nodiscard]] pid_t guardian_pid() const {
    const std::string text = text_of(folder_ / "state" / "guardian.pid");
    return text.empty() ? 0 : std::atoi(text.c_str());
  }

  void start_sim() {
    std::vector<std::string> words = {program("luxrig-sim"), rig_,          "--seed", "3", "--ports-file",
                                      ports().string(),      "--max-error", "0.02"};
    words.insert(words.end(), sim_options_.begin(), sim_options_.end());
    sim_ = std::make_unique<Process>(std::move(words), folder_ / "sim.log");
    ASSERT_TRUE(wait_for([&] { return sim_->output().find("ready") != std::string::npos; }, 60s)) << sim_->output();
  }
  void kill_sim() { sim_.reset(); }

  /// Status of the daemon; null if it does not answer.
  json status() {
    if (port_ == 0) find_port();
    if (port_ == 0) return {};
    const auto daemon = daemon_on(port_);
    const auto answer = daemon ? http_get(*daemon, "/api/status") : std::nullopt;
    return answer ? json::parse(answer->body, nullptr, false) : json();
  }
  bool wait_status(const std::function<bool(const json&)>& wanted, std::chrono::milliseconds bound) {
    return wait_for(
        [&] {
          last_ = status();
          return last_.is_object() && last_.contains("phase") && wanted(last_);
        },
        bound);
  }
  bool wait_phase(const std::string& phase, std::chrono::milliseconds bound) {
    return wait_status([&](const json& s) { return s["phase"] == phase; }, bound);
  }
  bool has_severe_alarm() const {
    for (const json& alarm : last_.value("alarms", json::array())) {
      if (alarm.value("severe", false)) return true;
    }
    return false;
  }
  void fault(const std::string& device, const std::string& name, bool on, double value = 0) {
    const auto control = json::parse(text_of(ports()))["control"];
    const json body = {{"device", device}, {"fault", name}, {"on", on}, {"value", value}};
    const auto answer = http_post_json({"127.0.0.1", control["port"]}, "/fault", body.dump());
    ASSERT_TRUE(answer && answer->status == 200) << (answer ? answer->body : "no answer");
  }
  /// Restarts the peaks of the truth.
  void reset_peaks() {
    const auto control = json::parse(text_of(ports()))["control"];
    const auto answer = http_post_json({"127.0.0.1", control["port"]}, "/reset_peaks", "{}");
    ASSERT_TRUE(answer && answer->status == 200);
  }
  /// Port of a bus of the simulated rig.
  [[nodiscard]] int bus_port(const std::string& bus) const {
    return json::parse(text_of(ports()))["buses"][bus]["port"];
  }
  json truth() {
    const auto control = json::parse(text_of(ports()))["control"];
    const auto answer = http_get({"127.0.0.1", control["port"]}, "/truth");
    return answer ? json::parse(answer->body, nullptr, false) : json();
  }
  double level_sum() const {
    double sum = 0;
    for (const json& f : last_.value("fixtures", json::array())) sum += f.value("level", 0.0);
    return sum;
  }
  [[nodiscard]] const json& last() const { return last_; }
  [[nodiscard]] int port() const { return port_; }
  Process& daemon() { return *daemon_; }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }

 private:
  std::filesystem::path ports() const { return folder_ / "ports.json"; }
  void find_port() {
    const std::string log = daemon_->output();
    const std::string mark = "http://127.0.0.1:";
    const auto at = log.find(mark);
    if (at != std::string::npos && log.find('/', at + mark.size()) != std::string::npos) {
      port_ = std::atoi(log.c_str() + at + mark.size());
    }
  }

  Folder folder_;
  std::string rig_;
  std::vector<std::string> options_;      ///< of the daemon
  std::vector<std::string> sim_options_;  ///< of the simulated rig
  std::unique_ptr<Process> sim_, daemon_;
  int port_ = 0;
  json last_;
};

}  // namespace luxrig::testing
