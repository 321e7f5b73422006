/// A camera whose pictures another program puts into a folder.

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "drivers/camera/camera_source.h"
#include "drivers/camera/file_listing.h"
#include "drivers/camera/picture_file.h"

namespace luxrig {
namespace {

constexpr std::uintmax_t kMaxPictureBytes = 256u << 20;

class FileCamera final : public CameraSource {
 public:
  explicit FileCamera(const PictureCamera& camera) : CameraSource(camera) {}

  DriverBounds bounds() const override {
    DriverBounds bounds;
    bounds.read = std::chrono::seconds(10);  // a large picture on a slow disk
    bounds.fault_after = bounds.read;        // for a lost folder; a folder that gets no more pictures is not noticed
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
  Result<RawPicture> take_raw(Time now) override {
    if (!active_) return inactive();
    life_.count_sent();
    auto picture = newest();
    if (!picture) return faulted(now, picture.error());
    life_.active(now);
    life_.count_received(now);
    return picture;
  }
  Result<std::optional<std::pair<double, double>>> exposures_s(Time) override { return std::nullopt; }
  Result<void> set_exposure(double) override {
    return tl::unexpected(Fault{Cause::invalid, camera_.name, "exposures of files are what their names say", {}});
  }

 private:
  Result<RawPicture> newest() const {
    const auto files = picture_files(camera_.taking.files);
    if (!files) return tl::unexpected(files.error());
    return read_picture_file(files->back(), camera_);
  }
};

}  // namespace

Result<RawPicture> read_picture_file(const std::filesystem::path& file, const PictureCamera& camera) {
  const auto bad = [&](Cause cause, const std::string& why) {
    return tl::unexpected(Fault{cause, camera.name, file.string() + ": " + why, {}});
  };
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  if (error) return bad(Cause::system, error.message() + ": check its permissions");
  if (size > kMaxPictureBytes) return bad(Cause::protocol, "larger than 256 MiB: give a smaller picture");
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
  return std::make_unique<FileCamera>(rig.cameras[camera]);
}

}  // namespace luxrig
