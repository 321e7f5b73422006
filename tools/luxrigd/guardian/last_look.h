#pragma once
/// The light to send when the daemon dies, in memory shared with its guardian. There are two copies, one of them whole
/// at every instant: however the writer ends, the reader finds the last look that was put.

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/plan/look.h"
#include "core/result.h"

namespace luxrig {

class LastLookMemory {
 public:
  /// Memory of this process and of those that inherit fd().
  [[nodiscard]] static Result<LastLookMemory> create(std::size_t fixtures);
  /// The same memory, by an inherited descriptor. Cause::invalid if it belongs to another rig or is no such memory.
  [[nodiscard]] static Result<LastLookMemory> open(int fd, std::size_t fixtures);
  ~LastLookMemory();
  LastLookMemory(LastLookMemory&& other) noexcept;
  LastLookMemory& operator=(LastLookMemory&&) = delete;

  /// One writer. Vectors have an entry per fixture. Never blocks, allocates nothing. sends: there is any output at all.
  void put(const LightInForce& light, bool sends);
  /// nullopt before the first put, and while there is no output. Non-finite values become 0 and levels are clamped to
  /// 0…1, as the writer may have corrupted the memory before it died.
  [[nodiscard]] std::optional<LightInForce> take() const;

  /// Heartbeat counters: of the daemon's threads that send, of its control loop, and of the guardian. A count that
  /// stands still means a process or thread that hangs.
  enum class Beat { output, control, guardian };
  void beat(Beat whose);
  [[nodiscard]] std::uint32_t beats(Beat whose) const;

  /// The guardian takes the light from a daemon that hangs; only one of them sends. The daemon takes it back once it
  /// has sent the guardian away.
  void take_the_light();
  void take_the_light_back();
  [[nodiscard]] bool guardian_has_the_light() const;

  /// Orderly end of the daemon: its guardian has nothing to do.
  void end();
  [[nodiscard]] bool ended() const;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  struct Header;
  LastLookMemory(int fd, void* memory, std::size_t bytes, std::size_t fixtures)
      : fd_(fd), memory_(memory), bytes_(bytes), fixtures_(fixtures) {}
  [[nodiscard]] Header& header() const;
  [[nodiscard]] double* copy(std::uint32_t index) const;

  int fd_ = -1;
  void* memory_ = nullptr;
  std::size_t bytes_ = 0, fixtures_ = 0;
};

}  // namespace luxrig
