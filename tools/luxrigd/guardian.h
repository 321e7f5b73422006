#pragma once
/// The daemon's side of its guardian, a small process (tools/luxrig-guardian) that waits for the daemon to die. Then it
/// holds the last look, fades to the safe look and goes on sending that, until a daemon that is started anew sends it
/// away.

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "core/control/show_controller.h"
#include "drivers/registry.h"
#include "tools/luxrigd/last_look.h"

namespace luxrig {

struct GuardianSettings {
  std::filesystem::path rig_file;
  std::size_t fixtures = 0;
  std::map<std::string, Redirect> redirects;  ///< by bus name
  std::filesystem::path state_folder;         ///< where it says which process it is
};

class Guardian {
 public:
  /// Starts luxrig-guardian, found beside this program.
  [[nodiscard]] static Result<Guardian> start(GuardianSettings settings);
  ~Guardian();
  Guardian(Guardian&& other) noexcept;
  Guardian& operator=(Guardian&&) = delete;

  void put(const LastLook& look) { memory_.put(look); }
  /// False: it has ended, and nobody would look after the light.
  [[nodiscard]] bool alive();
  /// The daemon ends in order, after its drivers have said goodbye.
  void end();

 private:
  Guardian(GuardianSettings settings, LastLookMemory memory)
      : settings_(std::move(settings)), memory_(std::move(memory)) {}
  Result<void> launch();

  GuardianSettings settings_;
  LastLookMemory memory_;
  pid_t pid_ = -1;
  int alive_fd_ = -1;  ///< our end of a pipe that closes when we die
};

/// A guardian that a dead daemon of the same state folder left behind stops sending, without a goodbye: a daemon is
/// about to go on from there. Returns what it sent last; nothing when there was none, or it could not say.
[[nodiscard]] std::optional<LightInForce> send_guardian_away(const std::filesystem::path& state_folder,
                                                             std::size_t fixtures);

}  // namespace luxrig
