// Any bytes as a photometric file: refused with a place and a remedy, or a distribution whose every value is
// finite and not negative, whose flux is positive, and which is dark outside its cone.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/photometry/ies.h"

namespace {
void require(bool condition) {
  if (!condition) std::abort();
}
}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace luxrig;
  const auto file = parse_ies(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz.ies");
  if (!file) {
    require(!file.error().empty());
    for (const Problem& problem : file.error()) {
      require(!problem.what.empty() && !problem.mend.empty() && problem.line >= 0 && problem.column >= 0);
    }
    return 0;
  }
  const Intensity light = make_intensity(*file);
  require(std::isfinite(light->flux_lm()) && light->flux_lm() > 0);
  const double most_cd = light->max_intensity_cd() * (1 + 1e-9);
  for (int i = 0; i <= 24; ++i) {
    for (int j = -12; j <= 12; ++j) {
      const double gamma = i * kPi / 24;
      const double c = j * kPi / 12;
      const Vec3 direction(std::sin(gamma) * std::cos(c), std::sin(gamma) * std::sin(c), -std::cos(gamma));
      const double intensity_cd = light->intensity_cd(direction);
      require(std::isfinite(intensity_cd) && intensity_cd >= 0 && intensity_cd <= most_cd);
      require(gamma <= 0.5 * light->emission_cone_rad() + 1e-6 || intensity_cd == 0);
    }
  }
  return 0;
}
