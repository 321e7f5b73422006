#include "tools/luxrigd/hand_question.h"

namespace luxrig {

std::optional<HandAnswer> QuestionBoard::ask(const HandQuestion& question, Duration for_so_long, Time at) {
  const std::lock_guard lock(mutex_);
  if (!asked_ || asked_->question.id != question.id) asked_.emplace();
  asked_->question = question;
  asked_->until = at + for_so_long;
  // An answer that was taken is never lost, even if the client asks again late.
  return asked_->answer;
}

Result<void> QuestionBoard::answer(const std::string& id, const HandAnswer& answer, Time at) {
  const std::lock_guard lock(mutex_);
  if (!asked_ || asked_->question.id != id || asked_->until <= at) return refusal("this is not asked any more");
  if (asked_->answer && *asked_->answer != answer) return refusal("this has been answered already");
  asked_->answer = answer;
  return {};
}

void QuestionBoard::withdraw(const std::string& id) {
  const std::lock_guard lock(mutex_);
  if (asked_ && asked_->question.id == id) asked_.reset();
}

std::optional<AskedQuestion> QuestionBoard::present(Time at) const {
  const std::lock_guard lock(mutex_);
  return asked_ && at < asked_->until ? asked_ : std::nullopt;
}

}  // namespace luxrig
