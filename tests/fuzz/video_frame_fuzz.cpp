// Any frame in any layout: never a crash; samples within 0 to 1, or a reason.
#include <cstdint>

#include "core/check.h"
#include "drivers/camera/frame_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 4) return 0;
  luxrig::FrameLayout layout;
  layout.format = static_cast<luxrig::PixelFormat>(data[0] % 8);
  layout.width_px = data[1];
  layout.height_px = data[2];
  layout.bytes_per_line = data[1] * luxrig::bytes_per_pixel(layout.format) + data[3] / 4;
  layout.limited_range = (data[3] & 1) != 0;
  layout.bt709 = (data[3] & 2) != 0;
  const auto picture = luxrig::decode_frame(layout, {data + 4, size - 4});
  if (!picture) {
    LUXRIG_CHECK(!picture.error().detail.empty(), "no reason");
    return 0;
  }
  const std::size_t samples = std::size_t{data[1]} * data[2] * static_cast<std::size_t>(picture->channels);
  LUXRIG_CHECK(picture->samples.size() == samples, "{} of {} samples", picture->samples.size(), samples);
  for (const float sample : picture->samples) LUXRIG_CHECK(sample >= 0 && sample <= 1, "sample {}", sample);
  return 0;
}
