#include "drivers/camera/camera_source.h"

#include <fmt/format.h>

#include "core/check.h"
#include "drivers/camera/v4l2_devices.h"

namespace luxrig {
namespace {

SampleCurve checked_curve_of(const PictureCamera& camera) {
  auto curve = curve_of(camera.taking);
  LUXRIG_CHECK(curve.has_value(), "camera {} was not checked", camera.name);
  return std::move(*curve);
}

}  // namespace

CameraSource::CameraSource(const PictureCamera& camera)
    : camera_(camera), life_(camera.name), curve_(checked_curve_of(camera)) {}

Result<TakenPicture> CameraSource::take(Time now) {
  const auto raw = take_raw(now);
  if (!raw) return tl::unexpected(raw.error());
  return light_of(*raw, curve_, camera_.taking, now);
}

tl::unexpected<Fault> CameraSource::inactive() const {
  return tl::unexpected(Fault{Cause::inactive, camera_.name, "the camera is not active", {}});
}

tl::unexpected<Fault> CameraSource::faulted(Time now, const Fault& fault) {
  life_.faulted(now, fault);
  return tl::unexpected(life_.fault());
}

std::vector<Problem> check_cameras(const Rig& rig) {
  std::vector<Problem> problems;
  const auto add = [&](const PictureCamera& camera, std::string what, std::string mend) {
    problems.push_back(
        {rig.file.string(), camera.in_file.line, camera.in_file.column, std::move(what), std::move(mend)});
  };
  for (const PictureCamera& camera : rig.cameras) {
    if (camera.taking.source == PictureSource::none) continue;
    if (const auto curve = curve_of(camera.taking); !curve)
      add(camera,
          fmt::format("camera \"{}\" has a response_file that is no response: {}", camera.name, curve.error().detail),
          "write it with luxrig camera check");
    if (camera.taking.format == PixelFormat::yuyv && camera.width_px % 2 != 0)
      add(camera, fmt::format("camera \"{}\" has YUYV with {} pixels a line", camera.name, camera.width_px),
          "write an even width_px: two pixels share their colour");
  }
  return problems;
}

std::unique_ptr<CameraSource> make_camera(const Rig& rig, std::size_t camera) {
  const PictureTaking& taking = rig.cameras[camera].taking;
  LUXRIG_CHECK(taking.source != PictureSource::none, "camera {} has no source", rig.cameras[camera].name);
  if (taking.source == PictureSource::files) return make_file_camera(rig, camera);
  return make_video_camera_over(make_v4l2_channel(taking.device), rig, camera);
}

}  // namespace luxrig
