#pragma once
/// The daemon's side of its guardian, a small process (tools/luxrig-guardian) that waits for the daemon to die, or to
/// hang. Then it holds the last look, fades to the safe look and goes on sending that, until the daemon, or one that is
/// started anew, sends it away.

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
  std::filesystem::path state_folder;         ///< where it says which process it is
  std::vector<int> claims{};                  ///< it holds them, too (claims.h)
};

class Guardian {
 public:
  /// Starts luxrig-guardian, found beside this program. The memory must outlive it.
  [[nodiscard]] static Result<Guardian> start(GuardianSettings settings, LastLookMemory& memory, Time now);
  ~Guardian();
  Guardian(Guardian&& other) noexcept;
  Guardian& operator=(Guardian&&) = delete;

  /// False: it has ended, or hung and was ended: nobody would look after the light.
  [[nodiscard]] bool alive(Time now);
  /// It has begun to look.
  [[nodiscard]] bool looks() const { return looks_; }
  /// It was sent away: it is waited for, and ended if need be.
  void leave();
  /// The daemon ends in order, after its drivers have said goodbye.
  void end();

 private:
  Guardian(GuardianSettings settings, LastLookMemory& memory, Time now)
      : settings_(std::move(settings)), memory_(&memory), beat_at_(now), beats_(memory.beats(kBeat)) {}
  Result<void> launch();
  void wait_for_its_end();

  static constexpr LastLookMemory::Beat kBeat = LastLookMemory::Beat::guardian;
  GuardianSettings settings_;
  LastLookMemory* memory_;
  Time beat_at_;  ///< when the count was seen to change last
  std::uint32_t beats_;
  bool looks_ = false;
  pid_t pid_ = -1;
  int alive_fd_ = -1;  ///< our end of a pipe that closes when we die
};

/// A guardian that a dead daemon of the same state folder left behind stops sending, without a goodbye: a daemon is
/// about to go on from there. Returns what it sent last; nothing when there was none, or it could not say.
[[nodiscard]] std::optional<LightInForce> send_guardian_away(const std::filesystem::path& state_folder,
                                                             std::size_t fixtures);

}  // namespace luxrig
