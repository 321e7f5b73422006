#pragma once
/// Devices that a person has taken out of the show because they failed.

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "core/rig/rig.h"
#include "core/time.h"

namespace luxrig {

class BypassList {
 public:
  using Since = std::vector<std::optional<Time>>;

  explicit BypassList(const Rig& rig) : lamps_(rig.fixtures.size()), meters_(rig.luxmeters.size()) {}

  /// Return those that changed.
  std::vector<std::size_t> set_lamps(Time now, std::span<const std::size_t> fixtures, bool on) {
    return set(lamps_, now, fixtures, on);
  }
  std::vector<std::size_t> set_meters(Time now, std::span<const std::size_t> luxmeters, bool on) {
    return set(meters_, now, luxmeters, on);
  }

  [[nodiscard]] bool lamp(std::size_t fixture) const { return lamps_[fixture].has_value(); }
  [[nodiscard]] bool meter(std::size_t luxmeter) const { return meters_[luxmeter].has_value(); }
  [[nodiscard]] bool any_lamp() const {
    return std::any_of(lamps_.begin(), lamps_.end(), [](const auto& since) { return since.has_value(); });
  }
  [[nodiscard]] const Since& lamps() const { return lamps_; }    ///< per fixture
  [[nodiscard]] const Since& meters() const { return meters_; }  ///< per luxmeter

 private:
  static std::vector<std::size_t> set(Since& all, Time now, std::span<const std::size_t> which, bool on) {
    std::vector<std::size_t> changed;
    for (const std::size_t i : which) {
      if (all.at(i).has_value() == on) continue;
      all[i] = on ? std::optional(now) : std::nullopt;
      changed.push_back(i);
    }
    return changed;
  }

  Since lamps_, meters_;
};

}  // namespace luxrig
