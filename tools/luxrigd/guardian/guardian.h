#pragma once
/// The daemon's side of its guardian, a small process (tools/luxrig-guardian) that waits for the daemon to die or hang.
/// Then it holds the last look, fades to the safe look and keeps sending that, until this daemon or a restarted one
/// sends it away.

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/show/show_controller.h"
#include "drivers/registry.h"
#include "tools/luxrigd/guardian/last_look.h"

namespace luxrig {

struct GuardianSettings {
  std::filesystem::path rig_file;
  std::size_t fixtures = 0;
  std::map<std::string, Redirect> redirects;  ///< by bus name
  std::filesystem::path state_folder;         ///< where it writes its process id
  std::vector<int> claims{};                  ///< it holds them too (claims.h)
};

class Guardian {
 public:
  /// Starts luxrig-guardian from this program's folder. The memory must outlive it.
  [[nodiscard]] static Result<Guardian> start(GuardianSettings settings, LastLookMemory& memory, Time now);
  ~Guardian();
  Guardian(Guardian&& other) noexcept;
  Guardian& operator=(Guardian&&) = delete;

  /// False if it has ended, or hung and was killed: no guardian is left.
  [[nodiscard]] bool alive(Time now);
  /// Whether it has begun to watch.
  [[nodiscard]] bool looks() const { return looks_; }
  /// Kills a guardian that hangs or was sent away, and reaps it.
  void leave();
  /// Orderly end of the daemon, after its drivers' goodbyes.
  void end();

 private:
  Guardian(GuardianSettings settings, LastLookMemory& memory, Time now)
      : settings_(std::move(settings)), memory_(&memory), beat_at_(now), beats_(memory.beats(kBeat)) {}
  Result<void> launch();
  void wait_for_its_end();

  static constexpr LastLookMemory::Beat kBeat = LastLookMemory::Beat::guardian;
  GuardianSettings settings_;
  LastLookMemory* memory_;
  Time beat_at_;  ///< when its heartbeat count last changed
  std::uint32_t beats_;
  bool looks_ = false;
  pid_t pid_ = -1;
  int alive_fd_ = -1;  ///< our end of a pipe; it closes when we die
};

/// Stops the guardian that a dead daemon of the same state folder left behind. It sends no goodbye, as a daemon goes on
/// from its light. Returns the light it sent last; nullopt if there was no guardian, or it could not report.
[[nodiscard]] std::optional<LightInForce> send_guardian_away(const std::filesystem::path& state_folder,
                                                             std::size_t fixtures);

}  // namespace luxrig
