#pragma once
/// Position of one device in its life cycle, with the counters of its health report.

#include <optional>
#include <string>
#include <utility>

#include "core/output/devices.h"

namespace luxrig {

class LifeRecord {
 public:
  explicit LifeRecord(std::string device) { health_.device = std::move(device); }

  void configured(Time now) { enter(Life::configured, now, {}); }
  /// remark: worth knowing although all is well; may be empty.
  void active(Time now, std::string remark = {}) { enter(Life::active, now, std::move(remark)); }
  /// `since` stays if it is faulted already; the text is always the newest. Counts an error if `is_new`; false is for
  /// an old error whose figures have grown.
  void faulted(Time now, const Fault& fault, bool is_new = true) {
    if (is_new) ++health_.errors;
    enter(Life::faulted, now, std::string(name_of(fault.cause)) + ": " + fault.detail);
    cause_ = fault.cause;
  }

  void count_sent() { ++health_.sent; }
  void count_received(Time now) {
    ++health_.received;
    health_.last_ok = now;
  }
  /// A success in a protocol without answers.
  void mark_ok(Time now) { health_.last_ok = now; }
  void count_error() { ++health_.errors; }

  [[nodiscard]] Life life() const { return health_.life; }
  [[nodiscard]] const Health& health() const { return health_; }
  /// requires life() == Life::faulted.
  [[nodiscard]] Fault fault() const { return {cause_, health_.device, health_.detail, health_.since}; }

 private:
  void enter(Life life, Time now, std::string detail) {
    if (health_.life != life) health_.since = now;
    health_.life = life;
    health_.detail = std::move(detail);
  }

  Health health_;
  Cause cause_ = Cause::system;
};

}  // namespace luxrig
