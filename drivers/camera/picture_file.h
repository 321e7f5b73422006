#pragma once
/// Pictures in files, as samples: PNG (8 and 16 bits, grey or colour), PGM and PPM (8 and 16 bits), PFM (light).
/// Sources: PNG specification (read by libpng), netpbm's pgm(5) and ppm(5), P. Debevec's description of PFM.

#include <string_view>

#include "drivers/camera/raw_picture.h"

namespace luxrig {

/// By its first bytes, whatever the file is called. Cause::protocol: another format, sizes outside 1…16384, bytes
/// missing, samples above the largest the file states, light that is negative or no number. Of a PNG with a palette or
/// with transparency the colours count.
[[nodiscard]] Result<RawPicture> decode_picture(std::string_view bytes);

// The formats, each from its first byte on.
[[nodiscard]] Result<RawPicture> decode_pnm(std::string_view bytes);
[[nodiscard]] Result<RawPicture> decode_float_map(std::string_view bytes);
[[nodiscard]] Result<RawPicture> decode_png(std::string_view bytes);

}  // namespace luxrig
