#include "tools/luxrig/calibrate/camera_eye.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>
#include <vector>

#include "core/picture/pfm.h"
#include "drivers/camera/camera_source.h"
#include "tools/process/clock.h"

namespace luxrig {
namespace {

constexpr int kLongestPicture_s = 300;
/// Each exposure of a bracket over the next shorter one.
constexpr double kBracketStep = 16;
constexpr int kSimulatedExposures = 2, kRealExposures = 3;
/// Of a place, 25 pixels are read.
constexpr int kSimulatedPasses = 8;
/// Longer, a person in the room would move.
constexpr double kLongestExposure_s = 0.5;

std::string as_query(const std::string& text) {
  std::string out;
  for (const unsigned char c : text)
    out += std::isalnum(c) != 0 ? std::string(1, static_cast<char>(c)) : fmt::format("%{:02X}", c);
  return out;
}

class SimulatedEye final : public CameraEye {
 public:
  SimulatedEye(HttpPeer control, std::string camera) : control_(std::move(control)), camera_(std::move(camera)) {}

  Result<MergedPicture> look(const std::stop_token& stop) override {
    std::vector<Picture> exposures;
    double underexposed = 1;
    for (int k = 0; k < kSimulatedExposures; ++k, underexposed *= kBracketStep) {
      if (stop.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "", "stopped", {}});
      const auto answer = http_get(control_,
                                   fmt::format("/picture?camera={}&underexposed={}&passes={}", as_query(camera_),
                                               underexposed, kSimulatedPasses),
                                   kLongestPicture_s);
      if (!answer || answer->status != 200)
        return tl::unexpected(Fault{Cause::network, camera_, "the simulated rig gives no picture", {}});
      auto picture = picture_from_pfm(answer->body);
      if (!picture) return tl::unexpected(picture.error());
      exposures.push_back(std::move(*picture));
    }
    return merged_with_full(exposures, cut_pixels(exposures.back()));
  }

 private:
  HttpPeer control_;
  std::string camera_;
};

class RealEye final : public CameraEye {
 public:
  explicit RealEye(std::unique_ptr<CameraSource> source) : source_(std::move(source)) {}
  ~RealEye() override { source_->deactivate(now()); }

  Result<MergedPicture> look(const std::stop_token& stop) override {
    if (auto active = source_->activate(now()); !active) return tl::unexpected(active.error());
    const auto range_s = source_->exposures_s(now());
    if (!range_s) return tl::unexpected(range_s.error());
    if (!*range_s) return one();
    std::vector<Picture> exposures;
    double exposure_s = std::min((*range_s)->second, kLongestExposure_s);
    for (int k = 0; k < kRealExposures && exposure_s >= (*range_s)->first; ++k, exposure_s /= kBracketStep) {
      if (stop.stop_requested()) return tl::unexpected(Fault{Cause::cancelled, "", "stopped", {}});
      if (auto set = source_->set_exposure(exposure_s); !set) return tl::unexpected(set.error());
      auto picture = take();
      if (!picture) return tl::unexpected(picture.error());
      exposures.push_back(std::move(*picture));
    }
    if (exposures.empty()) return one();
    return merged_with_full(exposures, full_pixels_);
  }

 private:
  Result<MergedPicture> one() {
    const auto picture = take();
    if (!picture) return tl::unexpected(picture.error());
    return merged_with_full({&*picture, 1}, full_pixels_);
  }

  /// In the same unit at each exposure.
  Result<Picture> take() {
    auto taken = source_->take(now());
    if (!taken) return tl::unexpected(taken.error());
    full_pixels_ =
        static_cast<std::size_t>(std::lround(taken->saturated_share * static_cast<double>(taken->light.size())));
    Picture picture;
    picture.width_px = taken->width_px;
    picture.height_px = taken->height_px;
    picture.luminance_cd_m2 = std::move(taken->light);
    if (!taken->calibrated && taken->exposure_s > 0)
      for (Vec3f& pixel : picture.luminance_cd_m2) pixel /= static_cast<float>(taken->exposure_s);
    return picture;
  }

  std::unique_ptr<CameraSource> source_;
  std::size_t full_pixels_ = 0;  ///< of the last picture taken
};

}  // namespace

Result<std::unique_ptr<CameraEye>> camera_eye(const Rig& rig, std::size_t camera,
                                              const std::optional<HttpPeer>& sim_control) {
  if (sim_control) return std::make_unique<SimulatedEye>(*sim_control, rig.cameras[camera].name);
  if (rig.cameras[camera].taking.source == PictureSource::none)
    return refusal(
        fmt::format("camera \"{}\" has no source of pictures in the rig file, and the daemon's rig is not "
                    "simulated: give it a source, rigs/REFERENCE.md says how",
                    rig.cameras[camera].name));
  if (const auto problems = check_cameras(rig); !problems.empty()) return refusal(problems.front().text());
  return std::make_unique<RealEye>(make_camera(rig, camera));
}

}  // namespace luxrig
