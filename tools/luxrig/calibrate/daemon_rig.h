#pragma once
/// A running daemon's rig, for measuring: levels held by hand, and readings once the light stands still.

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/calibration/lamp_steps.h"
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
  DaemonRig(DaemonRig&& other) noexcept;
  DaemonRig& operator=(DaemonRig&&) = delete;

  /// Holds these levels, and waits until they are sent and the light stands still. Per fixture, as sent: a limit may leave
  /// less than is asked for.
  [[nodiscard]] Result<std::vector<double>> light(std::span<const double> level, const std::stop_token& stop);
  /// Holds the same levels for longer. Call it every kHoldAgain while a person is waited for.
  [[nodiscard]] Result<void> hold_again() const { return hold(held_); }
  static constexpr std::chrono::seconds kHoldAgain{15};
  /// Per luxmeter: none = not steady, or gone.
  [[nodiscard]] Result<std::vector<std::optional<SteadyReading>>> read(const std::stop_token& stop) const;

 private:
  DaemonRig(HttpPeer daemon, const Rig& rig, int lock, nlohmann::json held_before);
  [[nodiscard]] Result<nlohmann::json> status() const;
  [[nodiscard]] Result<void> hold(std::span<const double> level) const;
  [[nodiscard]] Result<void> post(const char* route, const nlohmann::json& body) const;

  HttpPeer daemon_;
  const Rig* rig_;
  int lock_ = -1;               ///< a locked file
  std::vector<Fixture> dimmed_as_{};  ///< by the calibration in use
  nlohmann::json held_before_;  ///< "overrides" of the status
  std::vector<double> held_{};
};

}  // namespace luxrig
