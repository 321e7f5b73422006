#pragma once
/// One video device: what it is, its formats and controls, its frames. Nothing of exposure policy or of light.

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
  exposure_auto_priority,  ///< 1: the device may lengthen exposures by a lower frame rate
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
  /// On the channel's clock, at the end of the exposure or later; nothing: the device does not say.
  std::optional<Duration> captured;
  bool damaged = false;  ///< the device says that data are missing
};

class VideoChannel {
 public:
  virtual ~VideoChannel() = default;

  /// Finds and opens the device; idempotent. A Fault says what is wrong and what would mend it.
  virtual Result<void> open() = 0;
  /// Ends the stream, too.
  virtual void close() = 0;
  [[nodiscard]] virtual bool is_open() const = 0;
  /// "HD Webcam at usb-0000:00:14.0-2 (/dev/video0)"; empty while closed.
  [[nodiscard]] virtual std::string where() const = 0;

  // requires is_open(). Whoever finds the device gone closes the channel and gives Cause::network.
  /// Of those that can be decoded.
  [[nodiscard]] virtual std::vector<PixelFormat> formats() = 0;
  /// The layout that the device really takes, which may be another.
  virtual Result<FrameLayout> set_format(PixelFormat format, int width_px, int height_px) = 0;
  /// Nothing when the device has no such control, or none that can be set.
  [[nodiscard]] virtual std::optional<ControlRange> range(VideoControl control) = 0;
  virtual Result<void> set(VideoControl control, std::int64_t value) = 0;
  [[nodiscard]] virtual Result<std::int64_t> get(VideoControl control) = 0;

  virtual Result<void> start() = 0;  ///< idempotent
  /// The next frame, or nothing within `wait`.
  virtual Result<std::optional<VideoFrame>> take(std::chrono::milliseconds wait) = 0;
  /// Frames' times are on this clock.
  [[nodiscard]] virtual Duration clock() const = 0;
};

/// A Video4Linux capture device. `device`: path, bus, serial number or name; empty: the only one there is.
[[nodiscard]] std::unique_ptr<VideoChannel> make_v4l2_channel(std::string device);

}  // namespace luxrig
