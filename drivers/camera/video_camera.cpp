/// A camera that streams frames by itself.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "drivers/camera/camera_source.h"
#include "drivers/camera/video_settings.h"
#include "drivers/io/deadline.h"

namespace luxrig {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kOpening(1500);    ///< to open a device and set its controls
constexpr milliseconds kSlowFrame(400);   ///< between frames: large pictures over USB 2 come at 5 Hz or less
constexpr int kSettleFrames = 4;          ///< a sensor's pipeline may hold when a control changes
constexpr int kQueuedFrames = 4;          ///< the kernel may hold
constexpr milliseconds kVideoRetry(500);  ///< after a failure

class VideoCamera final : public CameraSource {
 public:
  VideoCamera(std::unique_ptr<VideoChannel> channel, const PictureCamera& camera)
      : CameraSource(camera), channel_(std::move(channel)) {}
  ~VideoCamera() override { leave(); }

  DriverBounds bounds() const override {
    DriverBounds bounds;
    bounds.read = kOpening + frames_bound();
    bounds.fault_after = bounds.read;
    return bounds;
  }
  Result<void> activate(Time now) override {
    if (active_) return {};
    active_ = true;
    if (auto ready = get_ready(now); !ready) {
      channel_->close();
      retry_at_ = now + kVideoRetry;
      life_.faulted(now, ready.error());
    }
    return {};
  }
  void deactivate(Time now) override {
    leave();
    active_ = false;
    life_.configured(now);
  }

  Result<RawPicture> take_raw(Time now) override {
    if (!active_) return inactive();
    if (life_.life() == Life::faulted && !channel_->is_open() && now < retry_at_) return tl::unexpected(life_.fault());
    life_.count_sent();
    auto picture = fresh_picture(now);
    if (!picture) {
      if (picture.error().cause == Cause::network) found_.reset();  // it may have lost power and its settings with it
      channel_->close();                                            // whatever the fault, start over next time
      retry_at_ = now + kVideoRetry;
      return faulted(now, picture.error());
    }
    life_.active(now);
    life_.count_received(now);
    return picture;
  }

  Result<std::optional<std::pair<double, double>>> exposures_s(Time now) override {
    if (!active_) return inactive();
    if (auto opened = channel_->open(); !opened) return faulted(now, opened.error());
    return exposure_range_s(*channel_);
  }
  Result<void> set_exposure(double exposure_s) override {
    if (!(exposure_s > 0) || !std::isfinite(exposure_s))
      return tl::unexpected(Fault{Cause::invalid, camera_.name, fmt::format("no exposure of {} s", exposure_s), {}});
    camera_.taking.exposure_s = exposure_s;
    return {};
  }

 private:
  /// Time within which a fresh frame must arrive: after the discarded frames and one that began before the call.
  milliseconds frames_bound() const {
    const auto exposure = std::chrono::ceil<milliseconds>(from_seconds(camera_.taking.exposure_s.value_or(0)));
    return (kSettleFrames + 4) * std::max(kSlowFrame, exposure + milliseconds(50));
  }

  /// Opens the camera, sets format and settings, starts the stream.
  Result<VideoSettings> get_ready(Time now) {
    const bool was_open = channel_->is_open();
    if (auto opened = channel_->open(); !opened) return tl::unexpected(opened.error());
    if (!was_open) {
      if (!found_) found_ = settings_found(*channel_);
      if (auto set = set_format(); !set) return tl::unexpected(set.error());
    }
    auto settings = fix_settings(*channel_, camera_.taking);
    if (!settings) return settings;
    if (settings->changed || !was_open) unsettled_ = true;
    if (auto started = channel_->start(); !started) return tl::unexpected(started.error());
    life_.active(now);
    return settings;
  }

  Result<void> set_format() {
    std::vector<PixelFormat> formats = channel_->formats();
    const PixelFormat wanted = camera_.taking.format;
    if (formats.empty())
      return tl::unexpected(Fault{
          Cause::refused, {}, "the camera has none of GREY, Y10, Y12, Y16, YUYV, RGB24, BGR24: take another", {}});
    // Prefer the most steps; among equals, the fewest bytes.
    std::sort(formats.begin(), formats.end(),
              [](PixelFormat a, PixelFormat b) { return std::pair(-counts_of(a), a) < std::pair(-counts_of(b), b); });
    if (wanted != PixelFormat::any && std::find(formats.begin(), formats.end(), wanted) == formats.end()) {
      std::string names;
      for (const PixelFormat format : formats) names += fmt::format("{}{}", names.empty() ? "" : ", ", name_of(format));
      return tl::unexpected(Fault{Cause::refused,
                                  {},
                                  fmt::format("the camera has no {}: write format = any of {}", name_of(wanted), names),
                                  {}});
    }
    const auto layout = channel_->set_format(wanted == PixelFormat::any ? formats.front() : wanted, camera_.width_px,
                                             camera_.height_px);
    if (!layout) return tl::unexpected(layout.error());
    layout_ = *layout;
    if (layout_.width_px != camera_.width_px || layout_.height_px != camera_.height_px)
      return tl::unexpected(Fault{Cause::refused,
                                  {},
                                  fmt::format("the camera has pictures of {} x {} pixels, not {} x {}: write width_px "
                                              "and height_px that it has",
                                              layout_.width_px, layout_.height_px, camera_.width_px, camera_.height_px),
                                  {}});
    return {};
  }

  /// A frame exposed wholly after `now`, with the wanted settings checked before and after.
  Result<RawPicture> fresh_picture(Time now) {
    const auto settings = get_ready(now);
    if (!settings) return tl::unexpected(settings.error());
    const Deadline deadline(frames_bound());
    const Duration since = channel_->clock(), until = since + frames_bound();
    const Duration exposure = from_seconds(settings->exposure_s);
    // The first frame that ends after the call may have begun before it, more so if the exposure is unknown.
    int skip = 1 + (unsettled_ ? kSettleFrames : 0), untimed = kQueuedFrames, damaged = 0, stale = 0;
    while (!deadline.passed() && channel_->clock() < until) {
      auto frame = channel_->take(deadline.left());
      if (!frame) return tl::unexpected(frame.error());
      if (!*frame) break;
      const VideoFrame& got = **frame;
      if (got.damaged) {
        ++damaged;
        life_.count_error();
        continue;
      }
      if (got.captured ? *got.captured - exposure < since : untimed-- > 0) {
        ++stale;
        continue;
      }
      if (skip-- > 0) continue;
      const auto still = fix_settings(*channel_, camera_.taking);
      if (!still) return tl::unexpected(still.error());
      if (still->changed)
        return tl::unexpected(
            Fault{Cause::refused, {}, "something else changed the camera's settings: end the program that does", {}});
      auto picture = decode_frame(layout_, got.bytes);
      if (picture) picture->exposure_s = settings->exposure_s;
      unsettled_ = false;
      return picture;
    }
    return tl::unexpected(Fault{Cause::timeout,
                                {},
                                fmt::format("no good frame within {} ms ({} damaged, {} too old): the stream stalls, "
                                            "unplug the camera and plug it in again",
                                            frames_bound().count(), damaged, stale),
                                {}});
  }

  /// Restores the settings found at the start. After a failure the channel may be closed although the camera is there.
  void leave() {
    if (found_ && channel_->open()) (void)give_back(*channel_, *found_);
    found_.reset();
    channel_->close();
  }

  std::unique_ptr<VideoChannel> channel_;
  std::optional<FoundSettings> found_;  ///< empty = never opened, or not since it had power
  FrameLayout layout_;
  bool unsettled_ = true;  ///< a control has changed since the last picture
  Time retry_at_{};
};

}  // namespace

std::unique_ptr<CameraSource> make_video_camera_over(std::unique_ptr<VideoChannel> channel, const Rig& rig,
                                                     std::size_t camera) {
  return std::make_unique<VideoCamera>(std::move(channel), rig.cameras[camera]);
}

}  // namespace luxrig
