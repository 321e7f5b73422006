#pragma once
/// A serial line without hardware: a pseudo terminal whose other end a program opens as its serial port. The path stays
/// the same when the adapter is unplugged and plugged in again, like names in /dev/serial/by-id.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "sim/wire/sockets.h"

namespace luxrig::sim {

class PtyLine {
 public:
  /// `path` empty: in a new folder of its own. Replaces an existing link, but no other file. Creates a missing folder.
  static Result<std::unique_ptr<PtyLine>> open(const std::string& path);
  ~PtyLine();
  PtyLine(const PtyLine&) = delete;
  PtyLine& operator=(const PtyLine&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Closed: the adapter is unplugged, programs that have it open are hung up on, and the path is invalid.
  void set_open(bool open);
  [[nodiscard]] bool is_open() const { return master_.open(); }
  /// Bytes received; may be empty.
  [[nodiscard]] std::vector<std::uint8_t> take();
  /// Bytes without room, as no program reads, are lost.
  void put(std::span<const std::uint8_t> bytes);
  [[nodiscard]] int descriptor() const { return master_.get(); }

 private:
  PtyLine() = default;
  Result<void> plug_in();

  Descriptor master_;
  Descriptor slave_;  ///< kept open, or reads would fail while no program has the port open
  std::string path_;
  std::string folder_;  ///< created for it; empty = the path was given
};

}  // namespace luxrig::sim
