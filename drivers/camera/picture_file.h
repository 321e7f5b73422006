#pragma once
/// Decodes picture files to samples: PNG (8 and 16 bits, grey or colour), PGM and PPM (8 and 16 bits), PFM (light).
/// Sources: PNG specification (read by libpng), netpbm's pgm(5) and ppm(5), P. Debevec's description of PFM.

#include <string_view>

#include "drivers/camera/raw_picture.h"

namespace luxrig {

/// The format follows from the first bytes, not the file's name. Cause::protocol: another format, sizes outside
/// 1…16384, missing bytes, samples above the stated maximum, light that is negative or not a number. Of a PNG with a
/// palette or with transparency the colours count.
[[nodiscard]] Result<RawPicture> decode_picture(std::string_view bytes);

// One decoder per format; `bytes` is the whole file.
[[nodiscard]] Result<RawPicture> decode_pnm(std::string_view bytes);
[[nodiscard]] Result<RawPicture> decode_float_map(std::string_view bytes);
[[nodiscard]] Result<RawPicture> decode_png(std::string_view bytes);

}  // namespace luxrig
