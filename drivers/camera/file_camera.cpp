/// A camera whose pictures some other program puts into a folder.

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "core/check.h"
#include "drivers/camera/camera_source.h"
#include "drivers/camera/file_listing.h"
#include "drivers/camera/picture_file.h"
#include "drivers/life.h"

namespace luxrig {
namespace {

constexpr std::uintmax_t kMostPictureBytes = 256u << 20;

class FileCamera final : public CameraSource {
 public:
  FileCamera(const PictureCamera& camera, SampleCurve curve)
      : camera_(camera), curve_(std::move(curve)), life_(camera.name) {}

  DriverBounds bounds() const override {
    DriverBounds bounds;
    bounds.read = std::chrono::seconds(10);  // a large picture on a slow disk
    bounds.notices_loss = false;             // nobody says whether more pictures will come
    return bounds;
  }
  Result<void> activate(Time now) override {
    if (active_) return {};
    active_ = true;
    if (const auto files = picture_files(camera_.taking.files)) {
      life_.active(now);
    } else {
      life_.faulted(now, files.error());
    }
    return {};
  }
  void deactivate(Time now) override {
    active_ = false;
    life_.configured(now);
  }
  std::vector<Health> health(Time) const override { return {life_.health()}; }

  Result<TakenPicture> take(Time now) override {
    const auto raw = take_raw(now);
    if (!raw) return tl::unexpected(raw.error());
    return light_of(*raw, curve_, camera_.taking, now);
  }
  Result<RawPicture> take_raw(Time now) override {
    if (!active_) return tl::unexpected(Fault{Cause::inactive, camera_.name, "the camera is not active", {}});
    auto picture = newest();
    if (!picture) {
      life_.faulted(now, picture.error());
      return tl::unexpected(life_.fault());
    }
    life_.active(now);
    life_.count_received(now);
    return picture;
  }
  Result<std::optional<std::pair<double, double>>> exposures_s(Time) override { return std::nullopt; }
  void set_exposure(double) override {}

 private:
  Result<RawPicture> newest() const {
    const auto files = picture_files(camera_.taking.files);
    if (!files) return tl::unexpected(files.error());
    return read_picture_file(files->back(), camera_);
  }

  PictureCamera camera_;
  SampleCurve curve_;
  LifeRecord life_;
  bool active_ = false;
};

}  // namespace

Result<RawPicture> read_picture_file(const std::filesystem::path& file, const PictureCamera& camera) {
  const auto bad = [&](Cause cause, const std::string& why) {
    return tl::unexpected(Fault{cause, camera.name, file.string() + ": " + why, {}});
  };
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error) return bad(Cause::system, error.message() + ": check its permissions");
  if (size > kMostPictureBytes) return bad(Cause::protocol, "larger than 256 MiB: give a smaller picture");
  std::ifstream in(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), {});
  auto picture = decode_picture(bytes);
  if (!picture) return bad(picture.error().cause, picture.error().detail + ": write it again, as PNG, PGM, PPM or PFM");
  if (picture->width_px != camera.width_px || picture->height_px != camera.height_px)
    return bad(Cause::refused, fmt::format("it has {} x {} pixels, not {} x {}: write width_px and height_px so",
                                           picture->width_px, picture->height_px, camera.width_px, camera.height_px));
  picture->exposure_s = exposure_in_name(file.filename().string()).value_or(0);
  return picture;
}

std::unique_ptr<CameraSource> make_file_camera(const Rig& rig, std::size_t camera) {
  const PictureCamera& spec = rig.cameras[camera];
  auto curve = curve_of(spec.taking);
  LUXRIG_CHECK(curve.has_value(), "camera {} was not checked", spec.name);
  return std::make_unique<FileCamera>(spec, std::move(*curve));
}

}  // namespace luxrig
