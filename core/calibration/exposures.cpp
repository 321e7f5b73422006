#include "core/calibration/exposures.h"

#include <algorithm>
#include <functional>

#include "core/check.h"

namespace luxrig {

namespace {
/// Of an exposure's brightest sample: above, samples may be full.
constexpr float kFull = 0.95f;
/// Where samples are cut, at least so many have the largest value, and so many times as many as the next smaller one. At
/// the end of a tail there are fewer.
constexpr std::size_t kPlateau = 12, kOverNext = 3;

float brightest_sample(const Picture& picture) {
  float brightest = 0;
  for (const Vec3f& pixel : picture.luminance_cd_m2) brightest = std::max(brightest, pixel.maxCoeff());
  return brightest;
}

}  // namespace

Picture merged_exposures(std::span<const Picture> longest_first) {
  LUXRIG_CHECK(!longest_first.empty(), "no exposure");
  Picture merged = longest_first.back();
  for (auto exposure = longest_first.rbegin(); exposure != longest_first.rend(); ++exposure) {
    LUXRIG_CHECK(exposure->width_px == merged.width_px && exposure->height_px == merged.height_px,
                 "exposures of {} × {} and {} × {} pixels", exposure->width_px, exposure->height_px, merged.width_px,
                 merged.height_px);
    const float full = brightest_sample(*exposure);
    for (std::size_t i = 0; i < merged.luminance_cd_m2.size(); ++i)
      if (exposure->luminance_cd_m2[i].maxCoeff() <= kFull * full)
        merged.luminance_cd_m2[i] = exposure->luminance_cd_m2[i];
  }
  return merged;
}

double MergedPicture::full_share() const {
  return full.empty()
             ? 0
             : static_cast<double>(std::count(full.begin(), full.end(), true)) / static_cast<double>(full.size());
}

MergedPicture merged_with_full(std::span<const Picture> longest_first, std::size_t full_pixels) {
  MergedPicture merged{merged_exposures(longest_first), {}};
  if (full_pixels == 0) return merged;
  const std::vector<Vec3f>& shortest = longest_first.back().luminance_cd_m2;
  std::vector<float> samples;
  for (const Vec3f& pixel : shortest) samples.push_back(pixel.maxCoeff());
  std::vector<float> sorted = samples;
  const auto dimmest = sorted.begin() + static_cast<std::ptrdiff_t>(std::min(full_pixels, sorted.size()) - 1);
  std::nth_element(sorted.begin(), dimmest, sorted.end(), std::greater<>());
  for (const float sample : samples) merged.full.push_back(sample >= *dimmest);
  return merged;
}

std::size_t cut_pixels(const Picture& picture) {
  const float brightest = brightest_sample(picture);
  if (!(brightest > 0)) return 0;
  float next = 0;
  for (const Vec3f& pixel : picture.luminance_cd_m2)
    if (const float sample = pixel.maxCoeff(); sample < brightest) next = std::max(next, sample);
  std::size_t same = 0, of_next = 0, near = 0;
  for (const Vec3f& pixel : picture.luminance_cd_m2) {
    const float sample = pixel.maxCoeff();
    same += sample == brightest;
    of_next += sample == next;
    near += sample > kFull * brightest;
  }
  return same >= kPlateau && same > kOverNext * of_next ? near : 0;
}

}  // namespace luxrig
