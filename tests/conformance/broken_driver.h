#pragma once
/// Drivers that are broken on purpose, to test the suite of all drivers. Each must fail the test for its fault.

#include <memory>
#include <span>
#include <string_view>

#include "drivers/driver.h"

namespace luxrig {

/// This environment variable breaks every driver of the registry in the named way.
inline constexpr const char* kBreakVariable = "LUXRIG_BREAK_DRIVER";

struct Breakage {
  const char* name;
  const char* driver;        ///< driver of the registry that shows the fault
  const char* failing_test;  ///< test of EveryDriver
};
[[nodiscard]] std::span<const Breakage> breakages();

/// The driver with the named fault; unchanged if there is no fault of that name.
[[nodiscard]] std::unique_ptr<Driver> broken(std::unique_ptr<Driver> whole, std::string_view breakage);

}  // namespace luxrig
