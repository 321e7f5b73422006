#pragma once
/// Drivers that are broken on purpose, so that the suite of all drivers is itself tested: each must fail the test that
/// is there for its fault.

#include <memory>
#include <span>
#include <string_view>

#include "drivers/driver.h"

namespace luxrig {

/// Set in the environment, it breaks every driver of the registry in that way.
inline constexpr const char* kBreakVariable = "LUXRIG_BREAK_DRIVER";

struct Breakage {
  const char* name;
  const char* driver;        ///< of the registry, that shows it
  const char* failing_test;  ///< of EveryDriver
};
[[nodiscard]] std::span<const Breakage> breakages();

/// The driver with that fault; itself when there is none of that name.
[[nodiscard]] std::unique_ptr<Driver> broken(std::unique_ptr<Driver> whole, std::string_view breakage);

}  // namespace luxrig
