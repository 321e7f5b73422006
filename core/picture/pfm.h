#pragma once
/// Linear pictures as bytes: Portable FloatMap ("PF", three floats a pixel, little-endian, rows from the bottom).
/// Source: P. Debevec, HDRShop's description of the format.

#include <string>
#include <string_view>

#include "core/picture/picture.h"

namespace luxrig {

/// Keeps only luminance_cd_m2.
[[nodiscard]] std::string to_pfm(const Picture& picture);

/// Refuses another format, sizes outside 1…16384, big-endian samples, missing or extra bytes, and values that are
/// negative or not finite.
[[nodiscard]] Result<Picture> picture_from_pfm(std::string_view bytes);

}  // namespace luxrig
