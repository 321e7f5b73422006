#pragma once
/// A [[camera]] with a source, as a driver with the life cycle, bounds and health of drivers/driver.h. One serves one
/// camera. It has no bus; its only capability is to take pictures.

#include "drivers/camera/raw_picture.h"
#include "drivers/camera/video_channel.h"
#include "drivers/driver.h"
#include "drivers/life.h"

namespace luxrig {

class CameraSource : public Driver, public PictureTaker {
 public:
  PictureTaker* picture_taker() override { return this; }
  [[nodiscard]] std::vector<Health> health(Time) const override { return {life_.health()}; }
  /// The light of take_raw(), by the camera's response.
  Result<TakenPicture> take(Time now) final;

  /// As take(), but returns the raw samples.
  virtual Result<RawPicture> take_raw(Time now) = 0;
  /// Shortest and longest exposure; empty if exposures cannot be chosen. Opens the camera.
  [[nodiscard]] virtual Result<std::optional<std::pair<double, double>>> exposures_s(Time now) = 0;
  /// Sets the exposure of the next pictures; an exposure outside the range above makes them fail. Cause::invalid, with
  /// nothing set, if it is not a positive number or the camera's exposure cannot be chosen.
  virtual Result<void> set_exposure(double exposure_s) = 0;

 protected:
  /// requires that check_cameras() found no problem with it.
  explicit CameraSource(const PictureCamera& camera);

  [[nodiscard]] tl::unexpected<Fault> inactive() const;
  /// Counts the failure and returns it as health reports it.
  tl::unexpected<Fault> faulted(Time now, const Fault& fault);

  PictureCamera camera_;
  LifeRecord life_;
  bool active_ = false;

 private:
  SampleCurve curve_;
};

/// Problems with the sources of a rig's cameras. Touches no device.
[[nodiscard]] std::vector<Problem> check_cameras(const Rig& rig);

/// requires a source, and check_cameras() to be empty.
[[nodiscard]] std::unique_ptr<CameraSource> make_camera(const Rig& rig, std::size_t camera);

/// The same over the caller's channel.
[[nodiscard]] std::unique_ptr<CameraSource> make_video_camera_over(std::unique_ptr<VideoChannel> channel,
                                                                   const Rig& rig, std::size_t camera);
[[nodiscard]] std::unique_ptr<CameraSource> make_file_camera(const Rig& rig, std::size_t camera);

/// One file of the camera's size; its name states its exposure (file_listing.h).
[[nodiscard]] Result<RawPicture> read_picture_file(const std::filesystem::path& file, const PictureCamera& camera);

}  // namespace luxrig
