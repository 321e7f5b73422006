// Any bytes as the product.xml of a GLDF file, with and without a choice: refused with a place and a remedy, or a file
// to read and a flux above 0.
#include <cstdint>
#include <string_view>

#include "core/rig/luminaire_file/gldf_file.h"
#include "tests/fuzz/photometry_properties.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const LuminairePart& part : {LuminairePart{}, LuminairePart{"v10", "indirect"}, LuminairePart{"v15", "down"}}) {
    const auto light = parse_gldf_product(text, "fuzz.xml", part);
    if (!light) {
      fuzz::require_said(light.error());
      continue;
    }
    fuzz::require(!light->rated_lm || *light->rated_lm > 0);
    fuzz::require(!light->input_w || *light->input_w >= 0);
  }
  return 0;
}
