// Any text as a response curve: never a crash; a curve that rises and is the same when written again, or a reason.
#include <cmath>
#include <cstdint>

#include "core/check.h"
#include "core/radiometry/sample_curve.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto curve = luxrig::sample_curve_from_csv({reinterpret_cast<const char*>(data), size});
  if (!curve) {
    LUXRIG_CHECK(!curve.error().detail.empty(), "no reason");
    return 0;
  }
  double last = curve->light(-0.1);
  for (int i = 0; i <= 100; ++i) {
    const double light = curve->light(i / 100.0), slope = curve->slope(i / 100.0);
    LUXRIG_CHECK(std::isfinite(light) && slope >= 0, "light {} slope {}", light, slope);
    LUXRIG_CHECK(light >= last - 1e-9 * std::abs(last), "light falls from {} to {}", last, light);
    last = light;
  }
  return 0;
}
