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

#include "core/calibration/meter_run.h"
#include "core/rig/rig.h"
#include "tools/http/client.h"
#include "tools/process/client.h"

namespace luxrig {

/// While it lives, no second one measures the same daemon's rig. Levels are held with an expiry: if this program dies, the
/// daemon goes back to its look by itself.
class DaemonRig {
 public:
  /// A fault without a daemon, for another rig's, or while another program measures.
  [[nodiscard]] static Result<DaemonRig> of(const ClientArguments& client, const Rig& rig);
  /// Gives the light back as it was: what this held is released, what a person held is held again.
  ~DaemonRig();
  DaemonRig(DaemonRig&& other) noexcept;
  DaemonRig& operator=(DaemonRig&&) = delete;

  struct Seen {
    std::vector<double> level;  ///< per fixture, as sent
    std::vector<std::optional<SteadyReading>> readings;
  };
  /// When the calibration was made by which the daemon dims; empty = it has none.
  [[nodiscard]] const std::string& calibrated() const { return calibrated_; }

  /// Holds these levels, waits until they are sent and every meter stands still, and reads.
  [[nodiscard]] Result<Seen> measure(std::span<const double> level, const std::stop_token& stop);

 private:
  DaemonRig(HttpPeer daemon, const Rig& rig, int lock, nlohmann::json held_before);
  [[nodiscard]] Result<nlohmann::json> status() const;
  [[nodiscard]] Result<void> post(const char* route, const nlohmann::json& body) const;

  HttpPeer daemon_;
  const Rig* rig_;
  int lock_ = -1;               ///< a locked file
  std::string calibrated_{};
  nlohmann::json held_before_;  ///< "overrides" of the status
};

}  // namespace luxrig
