#include "tools/luxrig/calibrate/daemon_rig.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <thread>
#include <utility>

#include "core/estimation/calibration.h"
#include "core/output/dimming.h"
#include "tools/luxrig/open_session.h"
#include "tools/process/meeting_place.h"
#include "tools/process/runtime_folder.h"
#include "tools/process/status_fields.h"

namespace luxrig {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// If this program dies, the daemon's look comes back after this.
constexpr double kHeld_s = 45;
constexpr auto kPoll = 100ms;
constexpr auto kLongestWait = 30s;
/// The slowest meters of the field answer this late.
constexpr auto kSettles = 2200ms;
constexpr std::size_t kSamples = 6;
constexpr auto kLongestSampling = 8s;
constexpr double kSameLevel = 1e-3, kSmallestError_lx = 0.02;
/// Samples that still wander by more than this, as a share and in standard errors, are not steady.
constexpr double kWanders = 0.02, kWandersErrors = 4;

std::string calibration_words(const std::string& made) {
  return made.empty() ? "no calibration" : fmt::format("the calibration of {}", made);
}

Fault fault(Cause cause, std::string detail) { return {cause, "", std::move(detail), {}}; }

std::optional<SteadyReading> steady(const std::vector<double>& samples) {
  if (samples.size() < kSamples) return std::nullopt;
  const auto count = static_cast<double>(samples.size());
  double mean = 0, variance = 0, slope = 0, times = 0;
  for (const double lux : samples) mean += lux / count;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double time = static_cast<double>(k) - (count - 1) / 2;
    variance += (samples[k] - mean) * (samples[k] - mean) / (count - 1);
    slope += time * samples[k];
    times += time * time;
  }
  const double error_lx = std::sqrt(variance / count + kSmallestError_lx * kSmallestError_lx);
  const double drift_lx = std::abs(slope / times) * (count - 1);
  if (drift_lx > kWanders * mean && drift_lx > kWandersErrors * error_lx) return std::nullopt;
  return SteadyReading{mean, error_lx};
}

}  // namespace

DaemonRig::DaemonRig(HttpPeer daemon, const Rig& rig, int lock, json held_before)
    : daemon_(std::move(daemon)), rig_(&rig), lock_(lock), held_before_(std::move(held_before)) {}

DaemonRig::DaemonRig(DaemonRig&& other) noexcept
    : daemon_(std::move(other.daemon_)),
      rig_(other.rig_),
      lock_(std::exchange(other.lock_, -1)),
      dimmed_as_(std::move(other.dimmed_as_)),
      held_before_(std::move(other.held_before_)),
      held_(std::move(other.held_)) {}

Result<DaemonRig> DaemonRig::of(const ClientArguments& client, const Rig& rig) {
  auto daemon = daemon_on(client.port, client.token);
  if (!daemon) return tl::unexpected(daemon.error());
  const auto folder = runtime_folder();
  if (!folder) return tl::unexpected(fault(Cause::system, "no folder for this user's lock files can be made"));
  const auto lock_file = *folder / fmt::format("{}.calibrate", client.port);
  const int lock = ::open(lock_file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock < 0) return tl::unexpected(fault(Cause::system, lock_file.string() + " cannot be opened"));
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock);
    return tl::unexpected(
        fault(Cause::invalid, "another luxrig calibrate measures this rig; wait for its end, or stop it"));
  }
  DaemonRig connected(std::move(*daemon), rig, lock, json::array());
  const auto status = connected.status();
  if (!status) return tl::unexpected(no_daemon(client.port));
  if (text_of(*status, "rig") != rig.name)
    return tl::unexpected(fault(Cause::invalid, fmt::format("the daemon lights \"{}\", the file is of \"{}\"",
                                                            text_of(*status, "rig"), rig.name)));
  if (flag_of(*status, "blackout"))
    return tl::unexpected(fault(Cause::invalid, "there is a blackout; lift it first: luxrig blackout off"));
  connected.held_before_ = list_of(*status, "overrides");
  // A calibrated daemon's levels are shares of true light. What is measured is over the rig file.
  auto in_use = with_calibration(rig);
  if (!in_use) return tl::unexpected(fault(Cause::invalid, in_use.error().front().text()));
  if (text_of(*status, "calibrated") != in_use->calibrated)
    return tl::unexpected(
        fault(Cause::invalid, fmt::format("the daemon lights by {}, {} holds {}; restart the daemon, and measure then",
                                          calibration_words(text_of(*status, "calibrated")),
                                          calibration_file(rig).string(), calibration_words(in_use->calibrated))));
  connected.dimmed_as_ = std::move(in_use->fixtures);
  return connected;
}

DaemonRig::~DaemonRig() {
  if (lock_ < 0) return;
  std::vector<std::string> names;
  for (const Fixture& fixture : rig_->fixtures) names.push_back(fixture.name);
  if (const auto released = post("/api/release", {{"names", names}}); !released)
    fmt::print(stderr, "luxrig: {}; the light comes back by itself within {:.0f} s\n", released.error().detail,
               kHeld_s);
  for (const json& held : held_before_) {
    if (text_of(held, "kind") != "level" || flag_of(held, "of_plan")) continue;
    json again = {{"fixtures", {text_of(held, "name")}}, {"level", number_of(held, "level").value_or(0)}};
    if (const auto left_s = number_of(held, "remaining_s")) again["for_s"] = std::max(1.0, *left_s);
    (void)post("/api/level", again);
  }
  ::close(lock_);
}

Result<json> DaemonRig::status() const {
  const auto answer = http_get(daemon_, "/api/status");
  if (!answer || answer->status != 200) return tl::unexpected(fault(Cause::system, "the daemon no longer answers"));
  json status = json::parse(answer->body, nullptr, false);
  if (!status.is_object()) return tl::unexpected(fault(Cause::system, "the daemon's status is no JSON"));
  return status;
}

Result<void> DaemonRig::post(const char* route, const json& body) const {
  const auto answer = http_post_json(daemon_, route, body.dump(-1, ' ', false, json::error_handler_t::replace));
  if (!answer) return tl::unexpected(fault(Cause::system, "the daemon no longer answers"));
  if (answer->status == 200) return {};
  return tl::unexpected(
      fault(Cause::invalid, "refused by the daemon: " + text_of(json::parse(answer->body, nullptr, false), "error")));
}

Result<void> DaemonRig::hold(std::span<const double> level) const {
  if (auto dark = post("/api/level", {{"fixtures", {"*"}}, {"level", 0}, {"for_s", kHeld_s}}); !dark) return dark;
  for (std::size_t f = 0; f < level.size(); ++f) {
    if (!(level[f] > 0)) continue;
    const json one = {{"fixtures", {rig_->fixtures[f].name}}, {"level", level[f]}, {"for_s", kHeld_s}};
    if (auto lit = post("/api/level", one); !lit) return lit;
  }
  return {};
}

Result<std::vector<double>> DaemonRig::light(std::span<const double> level, const std::stop_token& stop) {
  held_.clear();
  for (std::size_t f = 0; f < level.size(); ++f)
    held_.push_back(share_at_level(dimmed_as_[f].measured_curve, level[f]));
  if (auto held = hold(held_); !held) return tl::unexpected(held.error());
  const auto begun = Clock::now();
  auto still_since = begun;
  std::vector<double> sent, before;
  for (;;) {
    if (stop.stop_requested()) return tl::unexpected(fault(Cause::cancelled, "stopped"));
    std::this_thread::sleep_for(kPoll);
    const auto now = status();
    if (!now) return tl::unexpected(now.error());
    if (flag_of(*now, "blackout")) return tl::unexpected(fault(Cause::invalid, "somebody has called a blackout"));
    sent.clear();
    bool arrived = true;
    for (const json& fixture : list_of(*now, "fixtures")) {
      const std::size_t f = sent.size();
      const double is = number_of(fixture, "level").value_or(NAN);
      arrived = arrived && f < held_.size() && is <= held_[f] + kSameLevel &&
                std::abs(is - number_of(fixture, "target_level").value_or(NAN)) < kSameLevel;
      sent.push_back(is);
    }
    if (sent.size() != level.size())
      return tl::unexpected(fault(Cause::invalid, "the daemon's rig has other fixtures than the file"));
    if (!arrived || sent != before) still_since = Clock::now();
    before = sent;
    if (arrived && Clock::now() - still_since >= kSettles) {
      for (std::size_t f = 0; f < sent.size(); ++f) sent[f] = level_of_share(dimmed_as_[f].measured_curve, sent[f]);
      return sent;
    }
    if (Clock::now() - begun > kLongestWait)
      return tl::unexpected(fault(Cause::system, "the light does not come to rest; luxrig status says why"));
  }
}

Result<std::vector<std::optional<SteadyReading>>> DaemonRig::read(const std::stop_token& stop) const {
  // A reading counts once: its age goes back when the next one comes.
  const std::size_t meters = rig_->luxmeters.size();
  std::vector<std::vector<double>> samples(meters);
  std::vector<double> age_s(meters, 0.0);
  const auto begun = Clock::now();
  const auto enough = [&] {
    return std::all_of(samples.begin(), samples.end(), [](const auto& of) { return of.size() >= kSamples; });
  };
  while (!enough() && Clock::now() - begun < kLongestSampling) {
    if (stop.stop_requested()) return tl::unexpected(fault(Cause::cancelled, "stopped"));
    std::this_thread::sleep_for(kPoll);
    const auto now = status();
    if (!now) return tl::unexpected(now.error());
    const json list = list_of(*now, "luxmeters");
    for (std::size_t m = 0; m < std::min(meters, list.size()); ++m) {
      const auto lux = number_of(list[m], "lux"), age = number_of(list[m], "age_s");
      if (lux && age && (samples[m].empty() || *age < age_s[m])) samples[m].push_back(*lux);
      age_s[m] = age.value_or(0);
    }
  }
  std::vector<std::optional<SteadyReading>> readings;
  for (const auto& of_meter : samples) readings.push_back(steady(of_meter));
  return readings;
}

}  // namespace luxrig
