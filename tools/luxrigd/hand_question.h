#pragma once
/// The question of a client that measures by hand: where somebody in the room shall hold a luxmeter, and what it shows
/// there. The page shows it and answers it.

#include <mutex>
#include <optional>
#include <string>

#include "core/geometry.h"
#include "core/result.h"
#include "core/time.h"
#include "tools/luxrig/calibrate/hand_answer.h"

namespace luxrig {

struct HandQuestion {
  std::string id;    ///< of this question alone
  std::string text;  ///< where to hold it, for a person
  Vec3 position_world_m = Vec3::Zero();
  Vec3 normal_world = Vec3::UnitZ();               ///< unit: which way it looks
  std::string fixture{};                           ///< the lamp that is lit; empty = every lamp is dark
  double level = 0;                                ///< of that lamp
  int step = 1, steps = 1;                         ///< of this place, from 1
  int readings = 0;                                ///< taken so far, at all places
  std::optional<double> known_to, known_to_worst;  ///< the light at the goals so far: mean and largest relative error
};

struct AskedQuestion {
  HandQuestion question;
  Time until{};
  std::optional<HandAnswer> answer{};
};

/// The present question. Any thread. It is asked for so long, as levels are held: a client that dies leaves none.
class QuestionBoard {
 public:
  /// In place of the one before. The same id again: it stays for longer, and its answer with it. Its answer so far.
  std::optional<HandAnswer> ask(const HandQuestion& question, Duration for_so_long, Time at);
  /// The first answer counts. Refused: any other afterwards, and one to a question that is not asked now.
  [[nodiscard]] Result<void> answer(const std::string& id, const HandAnswer& answer, Time at);
  /// Does nothing to a question with another id.
  void withdraw(const std::string& id);
  [[nodiscard]] std::optional<AskedQuestion> present(Time at) const;

 private:
  mutable std::mutex mutex_;
  std::optional<AskedQuestion> asked_;
};

}  // namespace luxrig
