#include "drivers/can/cia402/set_point.h"

#include <utility>

#include "drivers/can/cia402/drive_state.h"

namespace luxrig::cia402 {

std::uint16_t SetPointHandshake::step(Time now, std::uint16_t statusword, bool fresh, bool may_offer) {
  const bool acknowledged = (statusword & kSetPointAcknowledged) != 0;
  constexpr std::uint16_t kRest = kEnableOperation | kChangeImmediately;
  switch (phase_) {
    case Phase::idle:
      if (!pending_) return kRest;
      current_ = std::exchange(pending_, std::nullopt);
      phase_ = Phase::prepared;
      return kRest;
    case Phase::prepared:
      if (acknowledged || !may_offer) return kRest;  // still for the last one: the drive would see no edge
      phase_ = Phase::offered;
      since_ = now;
      return kRest | kNewSetPoint;
    case Phase::offered:
      if (fresh && acknowledged) {
        phase_ = Phase::acknowledged;
        return kRest;
      }
      if (now - since_ < kPatience) return kRest | kNewSetPoint;
      phase_ = Phase::prepared;
      return kRest;
    case Phase::acknowledged:
      if (fresh && !acknowledged) phase_ = Phase::idle;
      return kRest;
  }
  return kRest;
}

}  // namespace luxrig::cia402
