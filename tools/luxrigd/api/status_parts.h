#pragma once
/// The parts of a status as JSON: what a rig is, which only a reload changes, and how it is now.

#include <nlohmann/json.hpp>

#include "tools/luxrigd/api/status_json.h"

namespace luxrig {

/// What a rig is: names, addresses, places, limits.
[[nodiscard]] nlohmann::json fixed_of(const Rig& rig, const Fixture& fixture);
[[nodiscard]] nlohmann::json fixed_of(const Rig& rig, const Point& point);
[[nodiscard]] nlohmann::json fixed_of(const Rig& rig, const Luxmeter& luxmeter);

class StatusParts {
 public:
  /// How times are told: as ages, `since_s` seconds ago; or as instants, `since_at_s` seconds after the daemon's start,
  /// which stay as they are while nothing happens.
  enum class Times { ages, instants };
  /// input: must outlive this.
  StatusParts(const StatusInput& input, Times times) : input_(input), times_(times) {}

  /// How a fixture, point, luxmeter or device is now, by its place in the rig's or the input's list.
  [[nodiscard]] nlohmann::json fixture(std::size_t index) const;
  [[nodiscard]] nlohmann::json point(std::size_t index) const;
  [[nodiscard]] nlohmann::json luxmeter(std::size_t index) const;
  [[nodiscard]] nlohmann::json device(std::size_t index) const;
  /// All else of the status, by key; without `time_s`.
  [[nodiscard]] nlohmann::json rest() const;

 private:
  void put_time(nlohmann::json& object, const char* age_key, const char* instant_key, Time at) const;
  [[nodiscard]] nlohmann::json asked(const AskedQuestion& question) const;
  [[nodiscard]] nlohmann::json alarms() const;
  [[nodiscard]] nlohmann::json overrides() const;
  [[nodiscard]] nlohmann::json bypassed() const;
  [[nodiscard]] nlohmann::json desks() const;

  const StatusInput& input_;
  Times times_;
};

}  // namespace luxrig
