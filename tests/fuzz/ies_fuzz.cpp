// Any bytes as a photometric file: refused with a place and a remedy, or a sound distribution.
#include <cstdint>
#include <string>
#include <string_view>

#include "core/photometry/files/ies.h"
#include "tests/fuzz/photometry_properties.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  // Bytes after the first NUL are the tilt file, if the file asks for one.
  const std::size_t nul = text.find('\0');
  const TiltFiles tilt_files = [&](std::string_view) -> std::optional<std::string> {
    if (nul == std::string_view::npos) return std::nullopt;
    return std::string(text.substr(nul + 1));
  };
  const auto file = parse_ies(text, "fuzz.ies", tilt_files);
  if (!file) {
    fuzz::require_said(file.error());
    return 0;
  }
  fuzz::require_sound(*make_intensity(*file));
  const LuminousOpening opening = luminous_opening(*file);
  fuzz::require(opening.shape.size_m.allFinite() && opening.shape.size_m.minCoeff() >= 0);
  if (file->tilt) {
    for (int deg = 0; deg <= 180; deg += 15) {
      const double factor = file->tilt->over_upright(rad_from_deg(deg));
      fuzz::require(std::isfinite(factor) && factor > 0);
    }
  }
  return 0;
}
