#pragma once
/// A running daemon's rig, for measuring: levels held by hand, and readings once the light stands still.

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/calibration/lamp_steps.h"
#include "core/calibration/meter_timing.h"
#include "core/rig/rig.h"
#include "tools/http/client.h"
#include "tools/process/client.h"

namespace luxrig {

/// While it lives, no second one measures the same daemon's rig. Levels are held with an expiry: if this program dies, the
/// daemon goes back to its look by itself.
class DaemonRig {
 public:
  /// A fault without a daemon, for another rig's, for one that lights by another calibration than the file beside the rig
  /// file, or while another program measures. rig: as in its file; levels below are in its terms.
  [[nodiscard]] static Result<DaemonRig> of(const ClientArguments& client, const Rig& rig);
  /// Gives the light back as it was: what this held is released, what a person held is held again.
  ~DaemonRig();
  DaemonRig(DaemonRig&&) = default;
  DaemonRig& operator=(DaemonRig&&) = delete;

  /// Holds these levels, and waits until they are sent and the light stands still. Per fixture, as sent: a limit may leave
  /// less than is asked for.
  [[nodiscard]] Result<std::vector<double>> light(std::span<const double> level, const std::stop_token& stop);
  /// Holds the same levels for longer. Call it every kHoldAgain while a person is waited for.
  [[nodiscard]] Result<void> hold_again() const { return hold(held_); }
  /// If this program dies, the daemon's look comes back after this.
  static constexpr double kHeld_s = 45;
  /// From one light to the next, and back at the end; else kQuickFade_s, and as the rig's looks.
  void fade_in(double step_s, double back_s) {
    fade_s_ = step_s;
    release_fade_s_ = back_s;
  }
  static constexpr std::chrono::seconds kHoldAgain{15};
  /// Nobody is there to be dazzled by a rig that goes on and off, lamp by lamp.
  static constexpr double kQuickFade_s = 0.2;
  /// Turns a head to where these joints take it, in the rig file's terms, its lamp at this share of full light. It is
  /// there once it has had the time. Lasts as long as a held level. from: the side that each joint comes from.
  [[nodiscard]] Result<void> aim(std::size_t fixture, const Joints& sent, const Approach& from, double level) const;
  /// The same joints in the daemon's terms.
  [[nodiscard]] Joints in_its_terms(std::size_t fixture, const Joints& sent, const Approach& from) const;
  /// The rig's fixtures as the daemon has them.
  [[nodiscard]] const std::vector<Fixture>& fixtures_in_use() const { return dimmed_as_; }
  /// The daemon turns its heads by a calibration already.
  [[nodiscard]] bool turns_as_found(std::size_t fixture) const { return dimmed_as_[fixture].joint_map.has_value(); }
  [[nodiscard]] const HttpPeer& daemon() const { return daemon_; }
  /// Where the daemon's simulated rig gives pictures; none = its rig is real.
  [[nodiscard]] const std::optional<HttpPeer>& sim_control() const { return sim_control_; }

  struct Read {
    std::vector<double> sent;                            ///< per fixture
    std::vector<std::optional<SteadyReading>> readings;  ///< per luxmeter; none = not steady, or gone
  };
  /// Sets one light after the other (levels of all fixtures) and reads all luxmeters. Before the first of them, all lamps go
  /// on to `together`, which shows how late each meter is; if that is empty, each is taken to be as late as any.
  /// tell: steps so far. goes_on: asked after each step with what was sent; false ends it, with that step the last.
  [[nodiscard]] Result<std::vector<Read>> measure(std::span<const std::vector<double>> plan,
                                                  std::span<const double> together,
                                                  const std::function<void(std::size_t done)>& tell,
                                                  const std::stop_token& stop,
                                                  const std::function<bool(const Read& step)>& goes_on = {});
  /// The same for lights that the caller sets: set(k) returns when the k-th stands still, false if it is the last. Per
  /// light, per luxmeter.
  [[nodiscard]] Result<std::vector<std::vector<std::optional<SteadyReading>>>> read_lights(
      std::size_t count, const std::function<Result<bool>(std::size_t light)>& set, const std::stop_token& stop);
  /// Readings seen since forget_samples() or the last light that was set to be read; times are those of clock_s().
  [[nodiscard]] const std::vector<TimedLux>& samples(std::size_t luxmeter) const { return samples_[luxmeter]; }
  void forget_samples();
  [[nodiscard]] static double clock_s();
  /// How late a luxmeter is; none = not measured, or it did not see the light then.
  [[nodiscard]] std::optional<MeterTiming> timing(std::size_t luxmeter) const {
    return timing_ ? (*timing_)[luxmeter] : std::nullopt;
  }
  /// Keeps looking for so long.
  [[nodiscard]] Result<void> watch(double seconds, const std::stop_token& stop);
  /// Until the show holds its light and dims no lamp to find a fault; a fault if that takes long.
  [[nodiscard]] Result<void> wait_until_steady(const std::stop_token& stop);
  /// As sent now, per fixture.
  [[nodiscard]] Result<std::vector<double>> levels_now();

 private:
  using Timings = std::vector<std::optional<MeterTiming>>;

  DaemonRig(HttpPeer daemon, const Rig& rig, std::shared_ptr<int> lock);
  [[nodiscard]] Result<nlohmann::json> status() const;
  /// The status now. Readings that are new are kept as samples.
  [[nodiscard]] Result<nlohmann::json> look();
  [[nodiscard]] Result<Timings> learn_timing(std::span<const double> together, const std::stop_token& stop);
  [[nodiscard]] Result<void> hold(std::span<const double> level) const;
  [[nodiscard]] Result<void> post(const char* route, const nlohmann::json& body) const;

  HttpPeer daemon_;
  const Rig* rig_;
  std::shared_ptr<int> lock_;                             ///< of a locked file; null = moved from
  std::vector<Fixture> dimmed_as_{};                      ///< by the calibration in use
  nlohmann::json held_before_ = nlohmann::json::array();  ///< "overrides" of the status
  std::vector<double> held_{};
  double held_at_s_ = 0;     ///< when the daemon had taken all of them
  double arrived_at_s_ = 0;  ///< when its light was first seen to be there
  double fade_s_ = kQuickFade_s;
  std::optional<double> release_fade_s_{};
  std::vector<std::vector<TimedLux>> samples_{};  ///< per luxmeter
  std::optional<Timings> timing_{};
  std::optional<HttpPeer> sim_control_{};
};

}  // namespace luxrig
