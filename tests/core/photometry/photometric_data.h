#pragma once
/// The shipped photometric files, and directions in their angles.

#include <cmath>
#include <filesystem>
#include <string>

#include "core/geometry.h"
#include "tests/folders.h"

namespace luxrig {

inline std::filesystem::path data_file(const std::string& name) {
  return test::source_folder() / "tests/data/photometry" / name;
}

inline Vec3 direction(double gamma_deg, double c_deg) {
  const double gamma = rad_from_deg(gamma_deg);
  const double c = rad_from_deg(c_deg);
  return {std::sin(gamma) * std::cos(c), std::sin(gamma) * std::sin(c), -std::cos(gamma)};
}

}  // namespace luxrig
