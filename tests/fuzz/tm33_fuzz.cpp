// Any bytes as a TM-33 file: refused with a place and a remedy, or a sound distribution.
#include <cstdint>
#include <string_view>

#include "core/rig/luminaire_file/tm33_file.h"
#include "tests/fuzz/photometry_properties.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto file = parse_tm33(text, "fuzz.xml", std::nullopt);
  if (file) {
    fuzz::require_sound(*file->intensity);
  } else {
    fuzz::require_said(file.error());
  }
  const auto chosen = parse_tm33(text, "fuzz.xml", "down");
  if (!chosen) fuzz::require_said(chosen.error());
  return 0;
}
