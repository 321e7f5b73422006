#pragma once
/// Tells a person, and waits for nobody: a pipe that nobody reads, a terminal that hung up or a full disk must not stop
/// what lights. Lines go through a thread of its own.

#include <memory>
#include <string>

#include "core/time.h"

namespace luxrig {

class Teller {
 public:
  /// Writes to this descriptor, which it does not close.
  explicit Teller(int fd);
  ~Teller();  ///< waits a second for what is still to be written, no longer
  Teller(const Teller&) = delete;
  Teller& operator=(const Teller&) = delete;

  /// Returns at once. What cannot be written is lost; of a reader that is too slow the oldest lines, and how many is
  /// said when it reads again.
  void tell(std::string text);
  /// False: not all has been written, or lost for an error, within `at_most`.
  bool flush(Duration at_most);

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  ///< with the thread, which may be stuck in a write for ever
};

}  // namespace luxrig
