#pragma once
/// The handshake of profile position mode (CiA 402-2, 10.3.2). Target and limits go first. Then the controlword's bit 4
/// rises until the drive acknowledges (statusword bit 12), and falls until the drive clears that bit. Bit 5 is set, so
/// a new target replaces the one under way. Pure; one step() a cycle.

#include <optional>

#include "core/time.h"

namespace luxrig::cia402 {

struct SetPoint {
  std::int32_t position = 0;                  ///< counts
  std::uint32_t speed = 1, acceleration = 1;  ///< counts/s, counts/s²; also deceleration
  bool operator==(const SetPoint&) const = default;
};

class SetPointHandshake {
 public:
  /// Without an answer for this long the set-point is offered again.
  static constexpr Duration kPatience = std::chrono::milliseconds(500);

  /// Replaces an order that has not been offered yet.
  void order(const SetPoint& set_point) { pending_ = set_point; }
  void forget() { *this = SetPointHandshake(); }
  /// The drive has the last order, or there is none.
  [[nodiscard]] bool idle() const { return phase_ == Phase::idle && !pending_; }

  /// statusword: the newest; `fresh`: it arrived since the last call; may_offer: bit 4 may rise. Returns the
  /// controlword.
  [[nodiscard]] std::uint16_t step(Time now, std::uint16_t statusword, bool fresh, bool may_offer = true);
  /// Data of the PDOs beside it; empty before the first order.
  [[nodiscard]] const std::optional<SetPoint>& current() const { return current_; }
  /// An order waits that is not current() yet.
  [[nodiscard]] bool pending() const { return pending_.has_value(); }
  /// current() will be offered next.
  [[nodiscard]] bool prepared() const { return phase_ == Phase::prepared; }
  /// Speed and acceleration must reach the drive before bit 4 rises.
  [[nodiscard]] bool limits_due() const { return phase_ == Phase::prepared || phase_ == Phase::offered; }

 private:
  enum class Phase { idle, prepared, offered, acknowledged };
  Phase phase_ = Phase::idle;
  Time since_{};
  std::optional<SetPoint> pending_, current_;
};

}  // namespace luxrig::cia402
