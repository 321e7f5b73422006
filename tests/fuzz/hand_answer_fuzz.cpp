// What a person types and what a meter's program writes: never a reading that is no light.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "tools/luxrig/calibrate/hand_answer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto light = [](double lux) { return std::isfinite(lux) && lux >= 0; };
  if (const auto answer = luxrig::hand_answer(text); answer && !light(answer->lux)) std::abort();
  if (const auto lux = luxrig::last_reading(text); lux && !light(*lux)) std::abort();
  return 0;
}
