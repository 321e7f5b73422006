// Any bytes as an EULUMDAT file: refused with a place and a remedy, or a sound distribution.
#include <cstdint>
#include <string_view>

#include "core/photometry/files/eulumdat.h"
#include "tests/fuzz/photometry_properties.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  const auto file = parse_eulumdat(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz.ldt");
  if (!file) {
    fuzz::require_said(file.error());
    return 0;
  }
  fuzz::require_sound(*make_intensity(*file));
  const LuminousOpening opening = luminous_opening(*file);
  fuzz::require(opening.shape.size_m.allFinite() && opening.shape.size_m.minCoeff() >= 0);
  return 0;
}
