#pragma once
/// A serial line without hardware: a pseudo terminal, whose other end a program opens as its serial port. The path
/// stays when the adapter is pulled out and plugged in again, as names in /dev/serial/by-id do.

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
  /// `path` empty: in a new folder of its own. A link that stands there already is replaced; another file is not. A
  /// missing folder is made.
  static Result<std::unique_ptr<PtyLine>> open(const std::string& path);
  ~PtyLine();
  PtyLine(const PtyLine&) = delete;
  PtyLine& operator=(const PtyLine&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Closed: the adapter is gone, who has it open is hung up on, and the path leads nowhere.
  void set_open(bool open);
  [[nodiscard]] bool is_open() const { return master_.open(); }
  /// What has arrived, perhaps nothing.
  [[nodiscard]] std::vector<std::uint8_t> take();
  /// What finds no room, since nobody reads, is lost.
  void put(std::span<const std::uint8_t> bytes);
  [[nodiscard]] int descriptor() const { return master_.get(); }

 private:
  PtyLine() = default;
  Result<void> plug_in();

  Descriptor master_;
  Descriptor slave_;  ///< held, or reading would fail while nobody has the port open
  std::string path_;
  std::string folder_;  ///< made for it; empty: the path was given
};

}  // namespace luxrig::sim
