#pragma once
/// A [[camera]] with a source, as a driver: its life cycle, bounds and health are those of drivers/driver.h; one serves
/// one camera. It has no bus and no other capability than to take pictures.

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

  /// As take(), without making light of the samples.
  virtual Result<RawPicture> take_raw(Time now) = 0;
  /// Least and most; nothing when exposures cannot be chosen. Opens the camera.
  [[nodiscard]] virtual Result<std::optional<std::pair<double, double>>> exposures_s(Time now) = 0;
  /// Of the next pictures; outside the range above they are refused. Cause::invalid, and nothing is set: what is no
  /// positive number, or a camera whose exposure cannot be chosen.
  virtual Result<void> set_exposure(double exposure_s) = 0;

 protected:
  /// requires that check_cameras() found nothing wrong with it.
  explicit CameraSource(const PictureCamera& camera);

  [[nodiscard]] tl::unexpected<Fault> inactive() const;
  /// Counts the failure, and gives it as health does.
  tl::unexpected<Fault> faulted(Time now, const Fault& fault);

  PictureCamera camera_;
  LifeRecord life_;
  bool active_ = false;

 private:
  SampleCurve curve_;
};

/// What is wrong with the sources of a rig's cameras. Touches no device.
[[nodiscard]] std::vector<Problem> check_cameras(const Rig& rig);

/// requires a source, and check_cameras() to be empty.
[[nodiscard]] std::unique_ptr<CameraSource> make_camera(const Rig& rig, std::size_t camera);

/// The same over a channel of the caller's.
[[nodiscard]] std::unique_ptr<CameraSource> make_video_camera_over(std::unique_ptr<VideoChannel> channel,
                                                                   const Rig& rig, std::size_t camera);
[[nodiscard]] std::unique_ptr<CameraSource> make_file_camera(const Rig& rig, std::size_t camera);

/// One file, of the camera's size; its exposure is what its name says (file_listing.h).
[[nodiscard]] Result<RawPicture> read_picture_file(const std::filesystem::path& file, const PictureCamera& camera);

}  // namespace luxrig
