#pragma once
/// A question on the daemon's page: somebody who stands in the room answers it there.

#include <memory>
#include <optional>
#include <string>

#include "tools/http/client.h"
#include "tools/luxrigd/hand_question.h"

namespace luxrig {

/// While it lives, its last question stays on the page. If this program dies, the daemon takes it off by itself.
class PageQuestion {
 public:
  /// for_s: how long a question stays if nothing follows.
  PageQuestion(HttpPeer daemon, double for_s);
  ~PageQuestion();
  PageQuestion(const PageQuestion&) = delete;
  PageQuestion& operator=(const PageQuestion&) = delete;

  /// The next question, in place of the one before. Its id is set here.
  void put(HandQuestion question);
  /// Keeps it there. The answer that the page has given, if it has.
  [[nodiscard]] std::optional<HandAnswer> look();
  /// An answer given elsewhere, which the page then shows. What counts: an answer of the page, if that was first.
  [[nodiscard]] HandAnswer settle(const HandAnswer& here);
  /// Why the page does not ask; empty if it does, or nothing was put yet.
  [[nodiscard]] const std::string& why_not() const { return why_not_; }

 private:
  HttpPeer daemon_;
  double for_s_;
  std::string name_;  ///< of this program, random
  int number_ = 0;
  HandQuestion question_;
  std::string why_not_;
};

}  // namespace luxrig
