// Any bytes as a picture: never a crash; a sound picture that is the same when written again, or a reason.
#include <cstdint>

#include "core/check.h"
#include "core/picture/pfm.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto picture = luxrig::picture_from_pfm({reinterpret_cast<const char*>(data), size});
  if (!picture) {
    LUXRIG_CHECK(!picture.error().detail.empty(), "no reason");
    return 0;
  }
  const auto pixels = static_cast<std::size_t>(picture->width_px) * static_cast<std::size_t>(picture->height_px);
  LUXRIG_CHECK(picture->luminance_cd_m2.size() == pixels, "{} of {} pixels", picture->luminance_cd_m2.size(), pixels);
  const auto again = luxrig::picture_from_pfm(luxrig::to_pfm(*picture));
  LUXRIG_CHECK(again && again->luminance_cd_m2 == picture->luminance_cd_m2, "not the same when written again");
  return 0;
}
