// Any bytes as a picture file: never a crash; a sound picture, or a reason.
#include <cmath>
#include <cstdint>

#include "core/check.h"
#include "drivers/camera/picture_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto picture = luxrig::decode_picture({reinterpret_cast<const char*>(data), size});
  if (!picture) {
    LUXRIG_CHECK(!picture.error().detail.empty(), "no reason");
    return 0;
  }
  const auto samples = static_cast<std::size_t>(picture->width_px) * static_cast<std::size_t>(picture->height_px) *
                       static_cast<std::size_t>(picture->channels);
  LUXRIG_CHECK(picture->samples.size() == samples, "{} of {} samples", picture->samples.size(), samples);
  for (const float sample : picture->samples)
    LUXRIG_CHECK(std::isfinite(sample) && sample >= 0 && (picture->is_light || sample <= 1), "sample {}", sample);
  return 0;
}
