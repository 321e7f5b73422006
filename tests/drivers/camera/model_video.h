#pragma once
/// A video device in the same process, under a stepped clock: waiting advances the clock. Its sensor is simulated.

#include <algorithm>
#include <deque>
#include <map>

#include "drivers/camera/video_channel.h"

namespace luxrig {

/// The device and its faults; outlives the channel.
struct ModelVideo {
  bool plugged_in = true, in_use = false;
  std::vector<PixelFormat> formats = {PixelFormat::grey8, PixelFormat::grey12};
  int width_px = 16, height_px = 8;
  Duration clock = std::chrono::seconds(100), frame_interval = std::chrono::milliseconds(33);
  int pipeline = 2;          ///< frames until a change of exposure shows
  bool has_times = true;     ///< frames carry their capture time
  bool stalls = false;       ///< no frame arrives
  int damaged = 0, cut = 0;  ///< of the next frames
  /// Factor on an exposure that is set; 1 = kept exactly.
  double keeps_exposure = 1;
  bool resets_itself = false;  ///< automatic exposure returns with every frame
  /// Light of the scene: exposure × this = sample, as a share of full scale.
  double full_scale_per_s = 50;
  std::map<VideoControl, std::pair<ControlRange, std::int64_t>> controls = {
      {VideoControl::exposure_auto, {{0, 3, 1, 3}, 3}},   {VideoControl::exposure_auto_priority, {{0, 1, 1, 0}, 1}},
      {VideoControl::exposure, {{1, 5000, 1, 156}, 156}}, {VideoControl::gain, {{0, 100, 1, 10}, 50}},
      {VideoControl::gamma, {{72, 500, 1, 220}, 220}},    {VideoControl::brightness, {{-64, 64, 1, 0}, 12}},
  };
  int opened = 0, closed = 0;
  std::vector<std::pair<VideoControl, std::int64_t>> sets;  ///< controls that were set, in order
};

class ModelVideoChannel final : public VideoChannel {
 public:
  explicit ModelVideoChannel(ModelVideo& device) : device_(device) {}

  Result<void> open() override {
    if (open_) return {};
    if (!device_.plugged_in) return fault(Cause::network, "not plugged in");
    open_ = true;
    ++device_.opened;
    exposures_.assign(static_cast<std::size_t>(device_.pipeline), exposure_now());  // it is already working on frames
    light_ = device_.full_scale_per_s;
    return {};
  }
  void close() override {
    if (open_) ++device_.closed;
    open_ = streaming_ = false;
    queued_.clear();
  }
  [[nodiscard]] bool is_open() const override { return open_; }
  [[nodiscard]] std::string where() const override { return "model"; }

  std::vector<PixelFormat> formats() override { return device_.formats; }
  Result<FrameLayout> set_format(PixelFormat format, int, int) override {
    if (device_.in_use) return tl::unexpected(Fault{Cause::refused, {}, "in use", {}});
    layout_ = {format,
               device_.width_px,
               device_.height_px,
               static_cast<std::size_t>(device_.width_px) * bytes_per_pixel(format),
               false,
               false};
    return layout_;
  }
  std::optional<ControlRange> range(VideoControl control) override {
    const auto found = device_.controls.find(control);
    if (found == device_.controls.end()) return std::nullopt;
    return found->second.first;
  }
  Result<void> set(VideoControl control, std::int64_t value) override {
    if (gone()) return lost();
    device_.sets.emplace_back(control, value);
    // As in webcams, a control that runs automatically cannot be set.
    if (control == VideoControl::exposure && device_.controls.contains(VideoControl::exposure_auto) &&
        device_.controls.at(VideoControl::exposure_auto).second != 1)
      return fault(Cause::refused, "its exposure is automatic");
    auto& [range, kept] = device_.controls.at(control);
    kept = value;
    if (control == VideoControl::exposure)
      kept = std::clamp(static_cast<std::int64_t>(static_cast<double>(value) * device_.keeps_exposure), range.least,
                        range.most);
    return {};
  }
  Result<std::int64_t> get(VideoControl control) override {
    if (gone()) return tl::unexpected(lost().error());
    return device_.controls.at(control).second;
  }

  Result<void> start() override {
    if (gone()) return lost();
    if (!streaming_) next_ = device_.clock + device_.frame_interval;
    streaming_ = true;
    return {};
  }

  /// As in a kernel, at most four frames wait: older ones stay, newer ones are lost.
  Result<std::optional<VideoFrame>> take(std::chrono::milliseconds wait) override {
    if (gone()) return tl::unexpected(lost().error());
    const Duration until = device_.clock + wait;
    run_to(device_.clock);
    if (queued_.empty() && !device_.stalls) run_to(std::min(until, next_));
    if (queued_.empty()) {
      device_.clock = until;
      return std::nullopt;
    }
    VideoFrame frame = std::move(queued_.front());
    queued_.pop_front();
    return frame;
  }
  [[nodiscard]] Duration clock() const override { return device_.clock; }

 private:
  static Result<void> fault(Cause cause, const char* text) { return tl::unexpected(Fault{cause, {}, text, {}}); }
  bool gone() const { return !device_.plugged_in; }
  Result<void> lost() {
    close();
    return fault(Cause::network, "unplugged");
  }
  void run_to(Duration time) {
    while (streaming_ && !device_.stalls && next_ <= time) {
      device_.clock = std::max(device_.clock, next_);
      if (queued_.size() < 4) queued_.push_back(frame());
      next_ += device_.frame_interval;
    }
  }
  double exposure_now() const {
    const auto found = device_.controls.find(VideoControl::exposure);
    return found == device_.controls.end() ? 0.01 : 1e-4 * static_cast<double>(found->second.second);
  }
  VideoFrame frame() {
    // Uses the controls of some frames ago, and the light at the start of the frame.
    exposures_.push_back(exposure_now());
    while (exposures_.size() > static_cast<std::size_t>(device_.pipeline) + 1) exposures_.pop_front();
    if (device_.resets_itself) device_.controls.at(VideoControl::exposure_auto).second = 3;
    const int counts = counts_of(layout_.format);
    const int sample = static_cast<int>(std::min(1.0, exposures_.front() * light_) * counts + 0.5);
    light_ = device_.full_scale_per_s;
    VideoFrame frame;
    if (device_.has_times) frame.captured = next_;
    for (int p = 0; p < layout_.width_px * layout_.height_px; ++p) {
      frame.bytes.push_back(static_cast<std::uint8_t>(sample & 255));
      if (bytes_per_pixel(layout_.format) == 2) frame.bytes.push_back(static_cast<std::uint8_t>(sample >> 8));
    }
    if (device_.damaged > 0)
      --device_.damaged, frame.damaged = true;
    else if (device_.cut > 0)
      --device_.cut, frame.bytes.resize(5);
    return frame;
  }

  ModelVideo& device_;
  FrameLayout layout_;
  Duration next_{};
  std::deque<VideoFrame> queued_;
  std::deque<double> exposures_;
  double light_ = 0;
  bool open_ = false, streaming_ = false;
};

}  // namespace luxrig
