#pragma once
/// Prints lines for a person without ever blocking: an unread pipe, a hung-up terminal or a full disk must not stop the
/// light. A thread of its own writes the lines.

#include <memory>
#include <string>

#include "core/time.h"

namespace luxrig {

class Teller {
 public:
  /// fd: written to, not closed.
  explicit Teller(int fd);
  ~Teller();  ///< waits at most one second for pending lines
  Teller(const Teller&) = delete;
  Teller& operator=(const Teller&) = delete;

  /// Returns at once. A line that cannot be written is lost. If the reader is too slow, the oldest lines are lost;
  /// their number is printed when it reads again.
  void tell(std::string text);
  /// False if lines are still pending after `at_most`. Lines lost to a write error do not count.
  bool flush(Duration at_most);

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  ///< with the thread, which may hang in a write for ever
};

}  // namespace luxrig
