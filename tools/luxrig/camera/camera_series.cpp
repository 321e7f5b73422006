#include "tools/luxrig/camera/camera_series.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "drivers/camera/file_listing.h"
#include "tools/process/clock.h"

namespace luxrig {
namespace {

constexpr std::size_t kJudgedPixels = 300'000;
constexpr double kDefaultSpan = 16;

Result<std::vector<double>> exposures_for(CameraSource& source, const PictureCamera& camera,
                                          const SeriesWanted& wanted) {
  const auto range = source.exposures_s(now());
  if (!range) return tl::unexpected(range.error());
  if (!*range)
    return tl::unexpected(
        Fault{Cause::refused,
              camera.name,
              "the camera has no control of its exposure: check it by the rig's light with --levels, or "
              "expose by hand, save a picture of each exposure, and check those with source = "
              "\"files\"",
              {}});
  const double middle = camera.taking.exposure_s.value_or(0.01);
  const double shortest =
      std::clamp(wanted.shortest_s.value_or(middle / kDefaultSpan), (*range)->first, (*range)->second);
  const double longest =
      std::clamp(wanted.longest_s.value_or(middle * kDefaultSpan), (*range)->first, (*range)->second);
  if (!(longest > 1.5 * shortest))
    return tl::unexpected(
        Fault{Cause::invalid,
              camera.name,
              fmt::format("exposures from {:g} to {:g} ms are no series: the camera has {:g} to {:g} ms",
                          1000 * shortest, 1000 * longest, 1000 * (*range)->first, 1000 * (*range)->second),
              {}});
  return exposures_between(shortest, longest, wanted.steps);
}

}  // namespace

std::vector<float> judged_samples(const RawPicture& picture) {
  const auto channels = static_cast<std::size_t>(picture.channels);
  const std::size_t pixels = picture.samples.size() / channels;
  const std::size_t stride = (pixels + kJudgedPixels - 1) / kJudgedPixels;
  std::vector<float> samples;
  for (std::size_t p = 0; p < pixels; p += std::max<std::size_t>(1, stride))
    samples.push_back(picture.samples[p * channels + channels / 2]);
  return samples;
}

Result<ExposureSeries> take_series(CameraSource& source, const PictureCamera& camera, const SeriesWanted& wanted,
                                   const Progress& progress) {
  if (auto active = source.activate(now()); !active) return tl::unexpected(active.error());
  const auto exposures = exposures_for(source, camera, wanted);
  if (!exposures) return tl::unexpected(exposures.error());
  ExposureSeries series;
  int done = 0;
  for (const double wanted_s : *exposures) {
    if (auto set = source.set_exposure(wanted_s); !set) return tl::unexpected(set.error());
    ExposureStep step;
    for (int f = 0; f < wanted.frames; ++f) {
      const auto picture = source.take_raw(now());
      if (!picture) return tl::unexpected(picture.error());
      series.full_scale_counts = picture->full_scale_counts;
      step.exposure_s = picture->exposure_s;
      step.frames.push_back(judged_samples(*picture));
      progress(static_cast<double>(++done) / static_cast<double>(wanted.steps * wanted.frames));
    }
    // A camera with few exposure steps may give the same one twice.
    if (series.steps.empty() || step.exposure_s > series.steps.back().exposure_s * 1.001)
      series.steps.push_back(std::move(step));
  }
  source.deactivate(now());
  return series;
}

Result<ExposureSeries> series_of_files(const PictureCamera& camera) {
  const auto files = picture_files(camera.taking.files);
  if (!files) return tl::unexpected(files.error());
  ExposureSeries series;
  std::map<double, std::vector<std::vector<float>>> by_exposure;
  for (const auto& file : *files) {
    const auto picture = read_picture_file(file, camera);
    if (!picture) return tl::unexpected(picture.error());
    if (picture->is_light)
      return tl::unexpected(
          Fault{Cause::refused, camera.name, file.string() + " is light already: it has no response", {}});
    if (!(picture->exposure_s > 0))
      return tl::unexpected(Fault{
          Cause::refused, camera.name, file.string() + " does not say its exposure: name it as wall_12.5ms_1.png", {}});
    if (!by_exposure.empty() && series.full_scale_counts != picture->full_scale_counts)
      return tl::unexpected(
          Fault{Cause::refused, camera.name, file.string() + " has other steps than those before it", {}});
    series.full_scale_counts = picture->full_scale_counts;
    by_exposure[picture->exposure_s].push_back(judged_samples(*picture));
  }
  for (auto& entry : by_exposure) series.steps.push_back({entry.first, std::move(entry.second)});
  return series;
}

}  // namespace luxrig
