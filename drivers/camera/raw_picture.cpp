#include "drivers/camera/raw_picture.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

namespace luxrig {
namespace {

constexpr std::uintmax_t kMaxCurveBytes = 4u << 20;

}  // namespace

Result<SampleCurve> curve_of(const PictureTaking& taking) {
  if (taking.curve_file.empty()) {
    switch (taking.curve) {
      case PixelCurve::linear:
        return SampleCurve::linear(taking.dark_share);
      case PixelCurve::srgb:
        return SampleCurve::srgb(taking.dark_share);
      case PixelCurve::bt709:
        return SampleCurve::bt709(taking.dark_share);
    }
  }
  std::error_code error;
  const auto size = std::filesystem::file_size(taking.curve_file, error);
  if (error || size > kMaxCurveBytes)
    return refusal(fmt::format("{} {}", taking.curve_file.string(),
                               error ? "cannot be read: " + error.message() : "is too large for a response curve"));
  std::ifstream in(taking.curve_file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), {});
  auto curve = sample_curve_from_csv(text);
  if (!curve) return refusal(taking.curve_file.string() + ": " + curve.error().detail);
  return curve;
}

TakenPicture light_of(const RawPicture& raw, const SampleCurve& curve, const PictureTaking& taking, Time taken) {
  TakenPicture out;
  out.width_px = raw.width_px;
  out.height_px = raw.height_px;
  out.exposure_s = raw.exposure_s;
  out.taken = taken;
  out.calibrated = raw.is_light || taking.full_scale_cd_m2.has_value();
  const double full = taking.full_scale_cd_m2.value_or(1);
  const auto saturated = static_cast<float>(curve.points().back().first - 0.5 / raw.full_scale_counts);
  const auto pixels = static_cast<std::size_t>(raw.width_px) * static_cast<std::size_t>(raw.height_px);
  const auto channels = static_cast<std::size_t>(raw.channels);
  out.light.reserve(pixels);
  std::size_t full_pixels = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    Vec3f pixel;
    bool is_full = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const float sample = raw.samples[p * channels + (channels == 3 ? c : 0)];
      is_full |= !raw.is_light && sample >= saturated;
      const double light = raw.is_light ? static_cast<double>(sample) : full * curve.light(static_cast<double>(sample));
      pixel[static_cast<Eigen::Index>(c)] = static_cast<float>(light);
    }
    full_pixels += is_full;
    out.light.push_back(pixel);
  }
  out.saturated_share = pixels > 0 ? static_cast<double>(full_pixels) / static_cast<double>(pixels) : 0;
  return out;
}

}  // namespace luxrig
