#pragma once
/// What the light shall do when the daemon dies, in memory that it shares with its guardian. Two copies, of which one
/// is whole at every instant: however the writer ends, the reader finds the last look that was put.

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/plan/look.h"
#include "core/result.h"

namespace luxrig {

class LastLookMemory {
 public:
  /// Of this process and those that inherit fd().
  [[nodiscard]] static Result<LastLookMemory> create(std::size_t fixtures);
  /// The same, by a descriptor that somebody inherited; Cause::invalid when it is another rig's, or no such memory.
  [[nodiscard]] static Result<LastLookMemory> open(int fd, std::size_t fixtures);
  ~LastLookMemory();
  LastLookMemory(LastLookMemory&& other) noexcept;
  LastLookMemory& operator=(LastLookMemory&&) = delete;

  /// One writer. Vectors have an entry per fixture. Never blocks, allocates nothing. sends: something goes out at all.
  void put(const LightInForce& light, bool sends);
  /// Nothing before the first, and while nothing goes out. Values that are no numbers are 0, and levels are within 0…1:
  /// the writer may have died while it wrote wildly.
  [[nodiscard]] std::optional<LightInForce> take() const;

  /// Who lives counts, here: the daemon's threads that send, its control loop, and the guardian. A count that stands
  /// still is a process, or a thread, that hangs.
  enum class Beat { output, control, guardian };
  void beat(Beat whose);
  [[nodiscard]] std::uint32_t beats(Beat whose) const;

  /// The guardian takes the light from a daemon that hangs; only one of them sends. The daemon that has sent it away
  /// takes it back.
  void take_the_light();
  void take_the_light_back();
  [[nodiscard]] bool guardian_has_the_light() const;

  /// The daemon ends in order: its guardian has nothing to do.
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
