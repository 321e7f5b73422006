#pragma once
/// One video device: identity, formats, controls, frames. No exposure policy, no light.

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/frame_codec.h"

namespace luxrig {

enum class VideoControl {
  exposure_auto,           ///< a menu: 1 is manual
  exposure_auto_priority,  ///< 1: the device may lower its frame rate for longer exposures
  exposure,                ///< in 100 µs
  autogain,
  gain,
  auto_white_balance,
  backlight_compensation,
  gamma,  ///< in hundredths: 100 is linear
  brightness,
  contrast,
};
[[nodiscard]] const char* name_of(VideoControl control);

struct ControlRange {
  std::int64_t least = 0, most = 0, step = 1, fallback = 0;
};

struct VideoFrame {
  std::vector<std::uint8_t> bytes;
  /// On the channel's clock, at the end of the exposure or later; empty if the device does not say.
  std::optional<Duration> captured;
  bool damaged = false;  ///< the device reports missing data
};

class VideoChannel {
 public:
  virtual ~VideoChannel() = default;

  /// Finds and opens the device; idempotent. A Fault states the problem and its remedy.
  virtual Result<void> open() = 0;
  /// Also ends the stream.
  virtual void close() = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  /// "HD Webcam at usb-0000:00:14.0-2 (/dev/video0)"; empty while closed.
  [[nodiscard]] virtual std::string where() const = 0;

  // requires is_open(). A call that finds the device gone closes the channel and returns Cause::network.
  /// Only formats that can be decoded.
  [[nodiscard]] virtual std::vector<PixelFormat> formats() = 0;
  /// Returns the layout that the device really uses; it may differ.
  virtual Result<FrameLayout> set_format(PixelFormat format, int width_px, int height_px) = 0;
  /// Empty if the device has no such control or it cannot be set.
  [[nodiscard]] virtual std::optional<ControlRange> range(VideoControl control) = 0;
  virtual Result<void> set(VideoControl control, std::int64_t value) = 0;
  [[nodiscard]] virtual Result<std::int64_t> get(VideoControl control) = 0;

  virtual Result<void> start() = 0;  ///< idempotent
  /// The next frame; empty if none arrives within `wait`.
  virtual Result<std::optional<VideoFrame>> take(std::chrono::milliseconds wait) = 0;
  /// The clock of the frames' times.
  [[nodiscard]] virtual Duration clock() const = 0;
};

/// A Video4Linux capture device. `device`: path, bus, serial number or name; empty = the only one there is.
[[nodiscard]] std::unique_ptr<VideoChannel> make_v4l2_channel(std::string device);

}  // namespace luxrig
