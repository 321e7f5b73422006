#include "drivers/camera/video_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr double kExposureUnit_s = 1e-4;    ///< of V4L2_CID_EXPOSURE_ABSOLUTE
constexpr double kExposureKept = 0.02;      ///< relative tolerance
constexpr std::int64_t kManual = 1;         ///< V4L2_EXPOSURE_MANUAL
constexpr std::int64_t kLinearGamma = 100;  ///< USB Video Class 1.5, 4.2.2.3.8: hundredths

/// Values first, then the automatic modes that would choose them.
constexpr VideoControl kGivenBackInOrder[] = {
    VideoControl::exposure,
    VideoControl::gain,
    VideoControl::contrast,
    VideoControl::brightness,
    VideoControl::gamma,
    VideoControl::backlight_compensation,
    VideoControl::autogain,
    VideoControl::auto_white_balance,
    VideoControl::exposure_auto_priority,
    VideoControl::exposure_auto,
};

tl::unexpected<Fault> not_kept(std::string detail) {
  return tl::unexpected(Fault{Cause::refused, {}, std::move(detail), {}});
}

/// Sets the control unless it has that value already, and reads it back.
Result<std::int64_t> keep(VideoChannel& channel, VideoControl control, std::int64_t value, bool& changed) {
  const auto before = channel.get(control);
  if (!before) return before;
  if (*before == value) return before;
  if (auto done = channel.set(control, value); !done) return tl::unexpected(done.error());
  changed = true;
  return channel.get(control);
}

/// For a control that must have exactly this value, if the device has it.
Result<void> keep_exactly(VideoChannel& channel, VideoControl control, std::int64_t value, bool& changed,
                          const char* mend) {
  const auto range = channel.range(control);
  if (!range) return {};
  if (value < range->least || value > range->most)
    return not_kept(fmt::format("the camera has no {} = {}: {}", name_of(control), value, mend));
  const auto kept = keep(channel, control, value, changed);
  if (!kept) return tl::unexpected(kept.error());
  if (*kept != value)
    return not_kept(
        fmt::format("the camera does not keep {} = {} but has {}: {}", name_of(control), value, *kept, mend));
  return {};
}

Result<double> fix_exposure(VideoChannel& channel, const PictureTaking& wanted, bool& changed) {
  const auto range = channel.range(VideoControl::exposure);
  if (!range) {
    if (wanted.exposure_s)
      return not_kept("the camera has no control of its exposure: leave exposure_ms out, and fix it at the camera");
    return 0.0;
  }
  const double unit_ms = 1000 * kExposureUnit_s;
  const std::string span = fmt::format("{:g} to {:g} ms", unit_ms * static_cast<double>(range->least),
                                       unit_ms * static_cast<double>(range->most));
  if (!wanted.exposure_s)
    return not_kept(fmt::format("the camera's exposure is not said: write exposure_ms, within {}", span));
  const auto value = static_cast<std::int64_t>(std::llround(*wanted.exposure_s / kExposureUnit_s));
  if (value < range->least || value > range->most)
    return not_kept(fmt::format("the camera cannot expose for {:g} ms: write exposure_ms within {}",
                                1000 * *wanted.exposure_s, span));
  const auto kept = keep(channel, VideoControl::exposure, value, changed);
  if (!kept) return tl::unexpected(kept.error());
  const double kept_s = kExposureUnit_s * static_cast<double>(*kept);
  if (!(kept_s > 0) || std::abs(kept_s - *wanted.exposure_s) > kExposureKept * *wanted.exposure_s)
    return not_kept(
        fmt::format("the camera exposes for {:g} ms where {:g} ms were set: write an exposure_ms that it "
                    "keeps, or stop what else sets it",
                    1000 * kept_s, 1000 * *wanted.exposure_s));
  return kept_s;
}

}  // namespace

const char* name_of(VideoControl control) {
  switch (control) {
    case VideoControl::exposure_auto:
      return "auto_exposure";
    case VideoControl::exposure_auto_priority:
      return "exposure_dynamic_framerate";
    case VideoControl::exposure:
      return "exposure_time_absolute";
    case VideoControl::autogain:
      return "gain_automatic";
    case VideoControl::gain:
      return "gain";
    case VideoControl::auto_white_balance:
      return "white_balance_automatic";
    case VideoControl::backlight_compensation:
      return "backlight_compensation";
    case VideoControl::gamma:
      return "gamma";
    case VideoControl::brightness:
      return "brightness";
    case VideoControl::contrast:
      return "contrast";
  }
  return "unknown";
}

std::optional<std::pair<double, double>> exposure_range_s(VideoChannel& channel) {
  const auto range = channel.range(VideoControl::exposure);
  if (!range) return std::nullopt;
  return std::pair{kExposureUnit_s * static_cast<double>(std::max<std::int64_t>(1, range->least)),
                   kExposureUnit_s * static_cast<double>(range->most)};
}

FoundSettings settings_found(VideoChannel& channel) {
  FoundSettings found;
  for (const VideoControl control : kGivenBackInOrder) {
    if (!channel.range(control)) continue;
    if (const auto value = channel.get(control)) found.emplace_back(control, *value);
  }
  return found;
}

Result<void> give_back(VideoChannel& channel, const FoundSettings& found) {
  Result<void> outcome;
  for (const auto& [control, value] : found) {
    const auto now = channel.get(control);
    if (now && *now == value) continue;
    auto done = now ? channel.set(control, value) : tl::unexpected(now.error());
    if (!done && outcome) outcome = std::move(done);
    if (!channel.is_open()) break;  // the device is gone
  }
  return outcome;
}

Result<VideoSettings> fix_settings(VideoChannel& channel, const PictureTaking& wanted) {
  VideoSettings out;
  const struct {
    VideoControl control;
    std::int64_t value;
    const char* mend;
  } off[] = {
      {VideoControl::exposure_auto, kManual, "its exposure cannot be fixed, take another camera"},
      {VideoControl::exposure_auto_priority, 0, "switch it off at the camera"},
      {VideoControl::autogain, 0, "its gain cannot be fixed, take another camera"},
      {VideoControl::auto_white_balance, 0, "switch it off at the camera"},
  };
  for (const auto& one : off)
    if (auto done = keep_exactly(channel, one.control, one.value, out.changed, one.mend); !done)
      return tl::unexpected(done.error());
  for (const VideoControl tone :
       {VideoControl::backlight_compensation, VideoControl::gamma, VideoControl::brightness, VideoControl::contrast}) {
    const auto range = channel.range(tone);
    if (!range) continue;
    std::int64_t value = range->fallback;
    if (tone == VideoControl::backlight_compensation) value = range->least;
    if (tone == VideoControl::gamma && range->least <= kLinearGamma && kLinearGamma <= range->most)
      value = kLinearGamma;
    if (auto done = keep_exactly(channel, tone, value, out.changed, "reset the camera, or stop what else sets it");
        !done)
      return tl::unexpected(done.error());
  }
  if (const auto range = channel.range(VideoControl::gain)) {
    const std::int64_t value = wanted.gain.value_or(static_cast<int>(range->fallback));
    const std::string mend = fmt::format("write gain within {} to {}", range->least, range->most);
    if (auto done = keep_exactly(channel, VideoControl::gain, value, out.changed, mend.c_str()); !done)
      return tl::unexpected(done.error());
  } else if (wanted.gain) {
    return not_kept("the camera has no control of its gain: leave gain out");
  }
  const auto exposure = fix_exposure(channel, wanted, out.changed);
  if (!exposure) return tl::unexpected(exposure.error());
  out.exposure_s = *exposure;
  return out;
}

}  // namespace luxrig
