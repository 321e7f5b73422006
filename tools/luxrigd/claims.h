#pragma once
/// Resources that only one Luxrig may hold at a time: its state folder and each output it sends to. A claim is an
/// abstract Unix socket. Its name is valid in one network namespace, as the networks that carry the light are. A claim
/// ends with the last process that holds it, whatever kills that process, and leaves no file behind.

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/rig/rig.h"
#include "core/time.h"
#include "drivers/registry.h"

namespace luxrig {

class Claims {
 public:
  Claims() = default;
  ~Claims() { release(); }
  Claims(const Claims&) = delete;
  Claims& operator=(const Claims&) = delete;

  /// Cause::refused, naming the holder. wait: how long to wait for a holder that is just ending.
  [[nodiscard]] Result<void> take(const std::string& what, Duration wait = {});
  /// Descriptors that a child may inherit; it then holds the claims too.
  [[nodiscard]] const std::vector<int>& descriptors() const { return descriptors_; }
  void release();

 private:
  std::vector<int> descriptors_;
};

/// The rig's outputs in words, each once: "sacn universe 1", "modbus_tcp 192.168.1.20:502 unit 3".
[[nodiscard]] std::vector<std::string> outputs_of(const Rig& rig, const std::map<std::string, Redirect>& redirects);

}  // namespace luxrig
