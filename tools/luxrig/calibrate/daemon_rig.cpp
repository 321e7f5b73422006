#include "tools/luxrig/calibrate/daemon_rig.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
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

constexpr auto kPoll = 100ms;
/// After so long without a look, the machine is busy with other things: what was seen then may be late.
constexpr double kStalled_s = 0.5;
constexpr double kLongestWait_s = 30;
/// A rig that may be measured from its safe look leaves it within this.
constexpr double kLeavesSafe_s = 1.5;
/// Less than was asked for, for so long, is all there will be.
constexpr double kLimitStands_s = 2;
/// The light stands still if the levels are the same in two looks.
constexpr double kSameLevel = 1e-3;
/// How long all is dark before the luxmeters' delay is measured, and lit after it. The slowest of the field answer 2 s late.
constexpr double kDark_s = 3, kLit_s = 4;
constexpr double kSteadyDark_s = 1;
/// Two readings of a meter are farther apart than the status of one is late.
constexpr double kSameReading_s = 0.03;
/// How late a meter is taken to be where that cannot be tried, and how seldom it is read.
constexpr double kSlowestMeter_s = 2.2, kSlowestPeriod_s = 0.25;
/// No light stays for less, so that a sample of each meter is never a matter of luck.
constexpr double kShortestDwell_s = 0.4;

std::string calibration_words(const std::string& made) {
  return made.empty() ? "no calibration" : fmt::format("the calibration of {}", made);
}

Fault fault(Cause cause, std::string detail) { return {cause, "", std::move(detail), {}}; }

double now_s() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

Fault stopped() { return fault(Cause::cancelled, "stopped"); }

}  // namespace

DaemonRig::DaemonRig(HttpPeer daemon, const Rig& rig, std::shared_ptr<int> lock)
    : daemon_(std::move(daemon)), rig_(&rig), lock_(std::move(lock)), samples_(rig.luxmeters.size()) {}

void DaemonRig::forget_samples() {
  // The last one stays, so that it is not taken for a new one.
  for (auto& samples : samples_)
    if (!samples.empty()) samples.erase(samples.begin(), samples.end() - 1);
}

double DaemonRig::clock_s() { return now_s(); }

Result<DaemonRig> DaemonRig::of(const ClientArguments& client, const Rig& rig) {
  auto daemon = daemon_on(client.port, client.token);
  if (!daemon) return tl::unexpected(daemon.error());
  const auto folder = runtime_folder();
  if (!folder) return tl::unexpected(fault(Cause::system, "no folder for this user's lock files can be made"));
  const auto lock_file = *folder / fmt::format("{}.calibrate", client.port);
  const int file = ::open(lock_file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (file < 0) return tl::unexpected(fault(Cause::system, lock_file.string() + " cannot be opened"));
  std::shared_ptr<int> lock(new int(file), [](const int* locked) {
    ::close(*locked);
    delete locked;
  });
  if (::flock(file, LOCK_EX | LOCK_NB) != 0)
    return tl::unexpected(
        fault(Cause::invalid, "another luxrig calibrate measures this rig; wait for its end, or stop it"));
  DaemonRig connected(std::move(*daemon), rig, std::move(lock));
  const auto status = connected.status();
  if (!status) return tl::unexpected(no_daemon(client.port));
  if (text_of(*status, "rig") != rig.name)
    return tl::unexpected(fault(Cause::invalid, fmt::format("the daemon lights \"{}\", the file is of \"{}\"",
                                                            text_of(*status, "rig"), rig.name)));
  if (flag_of(*status, "blackout"))
    return tl::unexpected(fault(Cause::invalid, "there is a blackout; lift it first: luxrig blackout off"));
  connected.held_before_ = list_of(*status, "overrides");
  if (const auto control = status->find("sim_control"); control != status->end() && control->is_object())
    connected.sim_control_ =
        HttpPeer{text_of(*control, "host"), static_cast<int>(number_of(*control, "port").value_or(0)), {}, {}};
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
  if (!lock_) return;
  std::vector<std::string> names;
  for (const Fixture& fixture : rig_->fixtures) names.push_back(fixture.name);
  json back = {{"names", names}};
  if (release_fade_s_) back["fade_s"] = *release_fade_s_;
  if (const auto released = post("/api/release", back); !released)
    fmt::print(stderr, "luxrig: {}; the light comes back by itself within {:.0f} s\n", released.error().detail,
               kHeld_s);
  for (const json& held : held_before_) {
    if (text_of(held, "kind") != "level" || flag_of(held, "of_plan")) continue;
    json again = {{"fixtures", {text_of(held, "name")}}, {"level", number_of(held, "level").value_or(0)}};
    if (const auto left_s = number_of(held, "remaining_s")) again["for_s"] = std::max(1.0, *left_s);
    (void)post("/api/level", again);
  }
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
  // All at the same instant: around some that are held, the show would solve the others anew.
  json levels = json::object();
  for (std::size_t f = 0; f < level.size(); ++f) levels[rig_->fixtures[f].name] = std::max(0.0, level[f]);
  return post("/api/level", {{"levels", levels}, {"for_s", kHeld_s}, {"fade_s", fade_s_}, {"measuring", true}});
}

Joints DaemonRig::in_its_terms(std::size_t fixture, const Joints& sent, const Approach& from) const {
  const Fixture& in_use = dimmed_as_[fixture];
  return in_use.joint_map ? in_use.joint_map->reached_by(sent, from) : sent;
}

Result<void> DaemonRig::aim(std::size_t fixture, const Joints& sent, const Approach& from, double level) const {
  const Fixture& in_use = dimmed_as_[fixture];
  const Joints turned = in_its_terms(fixture, sent, from);
  return post("/api/aim", {{"fixture", in_use.name},
                           {"pan_deg", deg_from_rad(turned.pan_rad)},
                           {"tilt_deg", deg_from_rad(turned.tilt_rad)},
                           {"level", share_at_level(in_use.measured_curve, level)},
                           {"for_s", kHeld_s}});
}

Result<json> DaemonRig::look() {
  auto now = status();
  if (!now) return now;
  const json list = list_of(*now, "luxmeters");
  for (std::size_t m = 0; m < std::min(samples_.size(), list.size()); ++m) {
    // One lamp alone is not what the model expects where the rig file is wrong, so the show may not believe it.
    const auto lux = number_of(list[m], "shown_lux"), age_s = number_of(list[m], "shown_age_s");
    if (!lux || !age_s) continue;
    // The same reading again has the same time, but for the way of the status.
    const double at_s = now_s() - *age_s;
    if (samples_[m].empty() || at_s > samples_[m].back().at_s + kSameReading_s) samples_[m].push_back({at_s, *lux});
  }
  return now;
}

Result<void> DaemonRig::watch(double seconds, const std::stop_token& stop) {
  for (const double end_s = now_s() + seconds; now_s() < end_s;) {
    if (stop.stop_requested()) return tl::unexpected(stopped());
    std::this_thread::sleep_for(kPoll);
    if (const auto now = look(); !now) return tl::unexpected(now.error());
  }
  return {};
}

Result<std::vector<double>> DaemonRig::light(std::span<const double> level, const std::stop_token& stop) {
  held_.clear();
  for (std::size_t f = 0; f < level.size(); ++f)
    held_.push_back(share_at_level(dimmed_as_[f].measured_curve, level[f]));
  if (auto held = hold(held_); !held) return tl::unexpected(held.error());
  held_at_s_ = now_s();
  const double begun_s = now_s();
  arrived_at_s_ = begun_s;
  std::vector<double> sent, before;
  for (double looked_s = begun_s;;) {
    if (stop.stop_requested()) return tl::unexpected(stopped());
    std::this_thread::sleep_for(kPoll);
    const auto now = look();
    if (!now) return tl::unexpected(now.error());
    if (text_of(*now, "phase").starts_with("safe") && now_s() - begun_s > kLeavesSafe_s)
      return tl::unexpected(fault(Cause::system, "the rig is in its safe look: " + text_of(*now, "detail")));
    if (flag_of(*now, "blackout")) return tl::unexpected(fault(Cause::invalid, "somebody has called a blackout"));
    sent.clear();
    // The daemon solves around what is held, so its targets follow a little later. A limit may leave less than is asked for.
    bool arrived = true, as_asked = true;
    for (const json& fixture : list_of(*now, "fixtures")) {
      const std::size_t f = sent.size();
      const double is = number_of(fixture, "level").value_or(NAN);
      arrived = arrived && f < held_.size() && is <= held_[f] + kSameLevel &&
                std::abs(is - number_of(fixture, "target_level").value_or(NAN)) < kSameLevel;
      as_asked = as_asked && arrived && is >= held_[f] - kSameLevel;
      sent.push_back(is);
    }
    if (sent.size() != level.size())
      return tl::unexpected(fault(Cause::invalid, "the daemon's rig has other fixtures than the file"));
    const bool stalled = now_s() - looked_s > kStalled_s;
    looked_s = now_s();
    if (!arrived || sent != before || stalled) arrived_at_s_ = now_s();
    if (arrived && sent == before && !stalled && (as_asked || now_s() - arrived_at_s_ >= kLimitStands_s)) {
      for (std::size_t f = 0; f < sent.size(); ++f) sent[f] = level_of_share(dimmed_as_[f].measured_curve, sent[f]);
      return sent;
    }
    before = sent;
    if (now_s() - begun_s > kLongestWait_s)
      return tl::unexpected(fault(Cause::system, "the light does not come to rest; luxrig status says why"));
  }
}

Result<DaemonRig::Timings> DaemonRig::learn_timing(std::span<const double> together, const std::stop_token& stop) {
  const std::vector<double> dark(together.size(), 0.0);
  if (auto sent = light(dark, stop); !sent) return tl::unexpected(sent.error());
  const double dark_s = now_s();
  if (auto watched = watch(kDark_s, stop); !watched) return tl::unexpected(watched.error());
  const double begun_s = now_s();
  if (auto sent = light(together, stop); !sent) return tl::unexpected(sent.error());
  if (auto watched = watch(kLit_s, stop); !watched) return tl::unexpected(watched.error());
  Timings timing;
  for (const auto& samples : samples_) {
    // What was read before the last second of darkness may be the light before.
    const auto first = std::find_if(samples.begin(), samples.end(),
                                    [&](const TimedLux& s) { return s.at_s > dark_s + kDark_s - kSteadyDark_s; });
    timing.push_back(timing_of({first, samples.end()}, begun_s, arrived_at_s_));
    // The last lamp that went on may be the one that this meter sees.
    if (timing.back()) timing.back()->delay_s = std::max(0.0, timing.back()->delay_s - (held_at_s_ - begun_s));
  }
  return timing;
}

Result<std::vector<DaemonRig::Read>> DaemonRig::measure(std::span<const std::vector<double>> plan,
                                                        std::span<const double> together,
                                                        const std::function<void(std::size_t)>& tell,
                                                        const std::stop_token& stop,
                                                        const std::function<bool(const Read&)>& goes_on) {
  if (!together.empty() && !timing_) {
    auto learnt = learn_timing(together, stop);
    if (!learnt) return tl::unexpected(learnt.error());
    timing_ = std::move(*learnt);
  }
  std::vector<Read> read;
  auto readings = read_lights(
      plan.size(),
      [&](std::size_t light_number) -> Result<bool> {
        if (tell) tell(light_number);
        auto sent = light(plan[light_number], stop);
        if (!sent) return tl::unexpected(sent.error());
        read.push_back({std::move(*sent), {}});
        return !goes_on || goes_on(read.back());
      },
      stop);
  if (!readings) return tl::unexpected(readings.error());
  for (std::size_t k = 0; k < read.size(); ++k) read[k].readings = std::move((*readings)[k]);
  return read;
}

Result<std::vector<std::vector<std::optional<SteadyReading>>>> DaemonRig::read_lights(
    std::size_t count, const std::function<Result<bool>(std::size_t)>& set, const std::stop_token& stop) {
  const Timings timing = timing_.value_or(Timings(samples_.size(), MeterTiming{0, kSlowestMeter_s, kSlowestPeriod_s}));
  const double dwell = std::max(kShortestDwell_s, dwell_s(timing));
  for (auto& samples : samples_) samples.clear();
  ReadingLog log(timing);
  for (std::size_t k = 0; k < count; ++k) {
    arrived_at_s_ = 0;
    const auto goes_on = set(k);
    if (!goes_on) return tl::unexpected(goes_on.error());
    // light() knows when its levels were first seen to be there.
    const double arrived_s = arrived_at_s_ > 0 ? arrived_at_s_ : now_s();
    if (const auto watched = watch(arrived_s + dwell - now_s(), stop); !watched) return tl::unexpected(watched.error());
    log.light(arrived_s, now_s());
    if (!*goes_on) break;
  }
  if (const auto watched = watch(log.whole_at_s() - now_s(), stop); !watched) return tl::unexpected(watched.error());
  for (std::size_t m = 0; m < samples_.size(); ++m)
    for (const TimedLux& sample : samples_[m]) log.sample(m, sample);
  return log.readings();
}

Result<void> DaemonRig::wait_until_steady(const std::stop_token& stop) {
  for (const double begun_s = now_s();;) {
    const auto now = look();
    if (!now) return tl::unexpected(now.error());
    bool steady = text_of(*now, "phase") == "holding" && !flag_of(*now, "blackout");
    for (const json& fixture : list_of(*now, "fixtures"))
      steady = steady && !flag_of(fixture, "dipped") &&
               std::abs(number_of(fixture, "level").value_or(0) - number_of(fixture, "target_level").value_or(0)) <
                   kSameLevel;
    if (steady) return {};
    if (stop.stop_requested()) return tl::unexpected(stopped());
    if (now_s() - begun_s > kLongestWait_s)
      return tl::unexpected(fault(Cause::system, "the show does not hold its light: " + text_of(*now, "detail")));
    std::this_thread::sleep_for(kPoll);
  }
}

Result<std::vector<double>> DaemonRig::levels_now() {
  const auto now = look();
  if (!now) return tl::unexpected(now.error());
  std::vector<double> level;
  for (const json& fixture : list_of(*now, "fixtures")) {
    if (level.size() == dimmed_as_.size()) break;
    level.push_back(level_of_share(dimmed_as_[level.size()].measured_curve, number_of(fixture, "level").value_or(0)));
  }
  if (level.size() == dimmed_as_.size()) return level;
  return tl::unexpected(fault(Cause::invalid, "the daemon's rig has other fixtures than the file"));
}

}  // namespace luxrig
