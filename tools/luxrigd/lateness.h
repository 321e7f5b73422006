#pragma once
/// How late our own threads wake up. This is no device failure, and is reported as what it is: a busy computer.

#include <algorithm>
#include <mutex>
#include <optional>

#include "core/time.h"

namespace luxrig {

class Lateness {
 public:
  static constexpr Duration kWorthSaying = std::chrono::milliseconds(250);
  static constexpr Duration kRemembered = std::chrono::minutes(1);  ///< after the last late wake-up

  struct Spell {
    Time since{}, last{};
    Duration most{};
  };

  /// The thread was due at `due` and woke at `woke`.
  void record(Time due, Time woke) {
    if (woke - due < kWorthSaying) return;
    const std::lock_guard lock(mutex_);
    if (!spell_ || woke - spell_->last > kRemembered) spell_ = Spell{woke, woke, {}};
    spell_->last = woke;
    spell_->most = std::max(spell_->most, woke - due);
  }

  /// nullopt if it has been on time for a minute.
  [[nodiscard]] std::optional<Spell> spell(Time now) const {
    const std::lock_guard lock(mutex_);
    return spell_ && now - spell_->last <= kRemembered ? spell_ : std::nullopt;
  }

 private:
  mutable std::mutex mutex_;
  std::optional<Spell> spell_;
};

}  // namespace luxrig
