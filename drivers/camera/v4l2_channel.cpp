/// Source: Linux Media documentation, Video for Linux API (streaming I/O by memory mapping; controls).
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>

#include "drivers/camera/v4l2_devices.h"
#include "drivers/camera/video_channel.h"
#include "drivers/io/deadline.h"
#include "drivers/io/os_fault.h"

namespace luxrig {
namespace {

constexpr std::uint32_t kVideoBuffers = 4;
constexpr std::size_t kMaxFrameBytes = 512u << 20;

struct FourCc {
  PixelFormat format;
  std::uint32_t code;
};
constexpr FourCc kFourCcs[] = {
    {PixelFormat::grey8, V4L2_PIX_FMT_GREY},  {PixelFormat::grey10, V4L2_PIX_FMT_Y10},
    {PixelFormat::grey12, V4L2_PIX_FMT_Y12},  {PixelFormat::grey16, V4L2_PIX_FMT_Y16},
    {PixelFormat::yuyv, V4L2_PIX_FMT_YUYV},   {PixelFormat::rgb24, V4L2_PIX_FMT_RGB24},
    {PixelFormat::bgr24, V4L2_PIX_FMT_BGR24},
};

std::uint32_t id_of(VideoControl control) {
  switch (control) {
    case VideoControl::exposure_auto:
      return V4L2_CID_EXPOSURE_AUTO;
    case VideoControl::exposure_auto_priority:
      return V4L2_CID_EXPOSURE_AUTO_PRIORITY;
    case VideoControl::exposure:
      return V4L2_CID_EXPOSURE_ABSOLUTE;
    case VideoControl::autogain:
      return V4L2_CID_AUTOGAIN;
    case VideoControl::gain:
      return V4L2_CID_GAIN;
    case VideoControl::auto_white_balance:
      return V4L2_CID_AUTO_WHITE_BALANCE;
    case VideoControl::backlight_compensation:
      return V4L2_CID_BACKLIGHT_COMPENSATION;
    case VideoControl::gamma:
      return V4L2_CID_GAMMA;
    case VideoControl::brightness:
      return V4L2_CID_BRIGHTNESS;
    case VideoControl::contrast:
      return V4L2_CID_CONTRAST;
  }
  return 0;
}

class V4l2Channel final : public VideoChannel {
 public:
  explicit V4l2Channel(std::string device) : wanted_(std::move(device)) {}
  ~V4l2Channel() override { close(); }
  V4l2Channel(const V4l2Channel&) = delete;
  V4l2Channel& operator=(const V4l2Channel&) = delete;

  Result<void> open() override {
    if (fd_ >= 0) return {};
    std::string path = wanted_;
    if (!wanted_.starts_with('/')) {
      const auto device = choose_device(v4l2_devices(), wanted_);
      if (!device) return tl::unexpected(device.error());
      path = device->path;
    }
    const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) return tl::unexpected(cannot_open(path, errno));
    fd_ = fd;
    v4l2_capability capability{};
    if (call(VIDIOC_QUERYCAP, &capability) != 0) {
      close();
      return tl::unexpected(Fault{Cause::refused, {}, path + " is no camera: luxrig devices lists them", {}});
    }
    const auto can =
        (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
    if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) {
      close();
      return tl::unexpected(
          Fault{Cause::refused, {}, path + " streams no pictures: luxrig devices lists devices that do", {}});
    }
    // Programs of ordinary priority then cannot change the controls. A driver without priorities also works.
    v4l2_priority priority = V4L2_PRIORITY_RECORD;
    (void)call(VIDIOC_S_PRIORITY, &priority);
    where_ = fmt::format("{} at {} ({})", reinterpret_cast<const char*>(capability.card),
                         reinterpret_cast<const char*>(capability.bus_info), path);
    return {};
  }

  void close() override {
    if (fd_ < 0) return;
    if (streaming_) {
      int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      (void)call(VIDIOC_STREAMOFF, &type);
    }
    for (const Mapped& buffer : buffers_) ::munmap(buffer.data, buffer.length);
    buffers_.clear();
    ::close(fd_);
    fd_ = -1;
    streaming_ = false;
    where_.clear();
  }
  [[nodiscard]] bool is_open() const override { return fd_ >= 0; }
  [[nodiscard]] std::string where() const override { return where_; }

  std::vector<PixelFormat> formats() override {
    std::vector<PixelFormat> formats;
    for (std::uint32_t i = 0; i < 256; ++i) {
      v4l2_fmtdesc about{};
      about.index = i;
      about.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      if (call(VIDIOC_ENUM_FMT, &about) != 0) break;
      for (const FourCc& known : kFourCcs)
        // A format that the kernel's driver converts in software is less faithful to the light.
        if (known.code == about.pixelformat && (about.flags & V4L2_FMT_FLAG_EMULATED) == 0)
          formats.push_back(known.format);
    }
    return formats;
  }

  Result<FrameLayout> set_format(PixelFormat format, int width_px, int height_px) override {
    v4l2_format wanted{};
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    v4l2_pix_format& pix = wanted.fmt.pix;
    pix.width = static_cast<std::uint32_t>(width_px);
    pix.height = static_cast<std::uint32_t>(height_px);
    pix.field = V4L2_FIELD_NONE;
    for (const FourCc& known : kFourCcs)
      if (known.format == format) pix.pixelformat = known.code;
    const std::uint32_t code = pix.pixelformat;
    if (call(VIDIOC_S_FMT, &wanted) != 0) return tl::unexpected(failed("the format"));
    if (pix.pixelformat != code)
      return tl::unexpected(Fault{Cause::refused,
                                  {},
                                  fmt::format("the camera has no {} of {} x {} pixels: write another format or size",
                                              name_of(format), width_px, height_px),
                                  {}});
    if (pix.field != V4L2_FIELD_NONE && pix.field != V4L2_FIELD_ANY)
      return tl::unexpected(
          Fault{Cause::refused, {}, "the camera sends half pictures (interlaced): choose a size without", {}});
    FrameLayout layout;
    layout.format = format;
    layout.width_px = static_cast<int>(std::min<std::uint32_t>(pix.width, kMaxPictureSide_px + 1));
    layout.height_px = static_cast<int>(std::min<std::uint32_t>(pix.height, kMaxPictureSide_px + 1));
    layout.bytes_per_line = pix.bytesperline != 0 ? pix.bytesperline : pix.width * bytes_per_pixel(format);
    // If the device does not say, Y'CbCr has limited range and Rec. 601.
    layout.limited_range = format == PixelFormat::yuyv && pix.quantization != V4L2_QUANTIZATION_FULL_RANGE &&
                           pix.colorspace != V4L2_COLORSPACE_JPEG;
    layout.bt709 = pix.ycbcr_enc == V4L2_YCBCR_ENC_709 ||
                   (pix.ycbcr_enc == V4L2_YCBCR_ENC_DEFAULT && pix.colorspace == V4L2_COLORSPACE_REC709);
    return layout;
  }

  std::optional<ControlRange> range(VideoControl control) override {
    v4l2_queryctrl about{};
    about.id = id_of(control);
    if (call(VIDIOC_QUERYCTRL, &about) != 0 ||
        (about.flags & (V4L2_CTRL_FLAG_DISABLED | V4L2_CTRL_FLAG_READ_ONLY)) != 0)
      return std::nullopt;
    return ControlRange{about.minimum, about.maximum, std::max(1, about.step), about.default_value};
  }
  Result<void> set(VideoControl control, std::int64_t value) override {
    v4l2_control wanted{id_of(control), static_cast<std::int32_t>(value)};
    if (call(VIDIOC_S_CTRL, &wanted) != 0)
      return tl::unexpected(failed(fmt::format("{} = {}", name_of(control), value).c_str()));
    return {};
  }
  Result<std::int64_t> get(VideoControl control) override {
    v4l2_control asked{id_of(control), 0};
    if (call(VIDIOC_G_CTRL, &asked) != 0) return tl::unexpected(failed(name_of(control)));
    return asked.value;
  }

  Result<void> start() override {
    if (streaming_) return {};
    if (auto mapped = map_buffers(); !mapped) return mapped;
    for (std::uint32_t i = 0; i < buffers_.size(); ++i)
      if (auto queued = queue(i); !queued) return queued;
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (call(VIDIOC_STREAMON, &type) != 0) return tl::unexpected(failed("the stream"));
    streaming_ = true;
    return {};
  }

  Result<std::optional<VideoFrame>> take(std::chrono::milliseconds wait) override {
    const Deadline deadline(wait);
    for (;;) {
      v4l2_buffer buffer{};
      buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      buffer.memory = V4L2_MEMORY_MMAP;
      if (call(VIDIOC_DQBUF, &buffer) == 0) return frame_in(buffer);
      if (errno != EAGAIN) return tl::unexpected(failed("a frame"));
      pollfd ready{fd_, POLLIN, 0};
      const int left = static_cast<int>(deadline.left().count());
      if (left == 0) return std::nullopt;
      const int count = ::poll(&ready, 1, left);
      if (count < 0 && errno != EINTR) return tl::unexpected(failed("a frame"));
      if (count > 0 && (ready.revents & (POLLERR | POLLHUP)) != 0) {
        // The device is gone or the stream has ended: VIDIOC_DQBUF shows which.
        if (call(VIDIOC_DQBUF, &buffer) == 0) return frame_in(buffer);
        if (errno == EAGAIN || errno == EINVAL) errno = ENODEV;
        return tl::unexpected(failed("a frame"));
      }
    }
  }

  [[nodiscard]] Duration clock() const override {
    timespec t{};
    ::clock_gettime(CLOCK_MONOTONIC, &t);
    return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
  }

 private:
  struct Mapped {
    void* data;
    std::size_t length;
  };

  template <class Argument>
  int call(unsigned long request, Argument* argument) const {
    int result = 0;
    do {
      result = ::ioctl(fd_, request, argument);
    } while (result != 0 && errno == EINTR);
    return result;
  }

  static Fault cannot_open(const std::string& path, int error) {
    switch (error) {
      case ENOENT:
      case ENODEV:
      case ENXIO:
        return {Cause::network, {}, path + " is not there: plug the camera in (luxrig devices lists cameras)", {}};
      case EACCES:
      case EPERM:
        return {Cause::system, {}, path + " may not be opened: add the user to the group video", {}};
      case EBUSY:
        return {Cause::refused, {}, path + " is in use: end the program that has it", {}};
      default:
        return os_fault(path, error);
    }
  }

  /// Why a call failed, by errno; closes a device that is gone.
  Fault failed(const std::string& what) {
    const int error = errno;
    const std::string where = where_;
    if (error == ENODEV || error == ENXIO || error == EIO) {
      close();
      return {Cause::network, {}, where + " has been unplugged: plug it in again", {}};
    }
    if (error == EBUSY)
      return {Cause::refused, {}, fmt::format("{} is in use ({}): end the program that has it", where, what), {}};
    if (error == EINVAL || error == ERANGE)
      return {
          Cause::refused, {}, fmt::format("{} refuses {}: choose what luxrig devices says it has", where, what), {}};
    return os_fault(where + ", " + what, error);
  }

  Result<void> map_buffers() {
    if (!buffers_.empty()) return {};
    v4l2_requestbuffers request{};
    request.count = kVideoBuffers;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (call(VIDIOC_REQBUFS, &request) != 0) return tl::unexpected(failed("its buffers"));
    for (std::uint32_t i = 0; i < std::min(request.count, 32u); ++i) {
      v4l2_buffer buffer{};
      buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
      buffer.memory = V4L2_MEMORY_MMAP;
      buffer.index = i;
      if (call(VIDIOC_QUERYBUF, &buffer) != 0) return tl::unexpected(failed("its buffers"));
      if (buffer.length == 0 || buffer.length > kMaxFrameBytes)
        return tl::unexpected(Fault{Cause::protocol, {}, fmt::format("buffers of {} bytes", buffer.length), {}});
      void* data =
          ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, static_cast<off_t>(buffer.m.offset));
      if (data == MAP_FAILED) return tl::unexpected(failed("its buffers"));
      buffers_.push_back({data, buffer.length});
    }
    return {};
  }

  Result<void> queue(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    if (call(VIDIOC_QBUF, &buffer) != 0) return tl::unexpected(failed("a buffer"));
    return {};
  }

  Result<std::optional<VideoFrame>> frame_in(const v4l2_buffer& buffer) {
    if (buffer.index >= buffers_.size() || buffer.bytesused > buffers_[buffer.index].length)
      return tl::unexpected(Fault{Cause::protocol, {}, "a frame that is larger than its buffer", {}});
    VideoFrame frame;
    frame.damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
    if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
      frame.captured =
          std::chrono::seconds(buffer.timestamp.tv_sec) + std::chrono::microseconds(buffer.timestamp.tv_usec);
    const auto* bytes = static_cast<const std::uint8_t*>(buffers_[buffer.index].data);
    if (!frame.damaged) frame.bytes.assign(bytes, bytes + buffer.bytesused);
    if (auto queued = queue(buffer.index); !queued) return tl::unexpected(queued.error());
    return frame;
  }

  std::string wanted_, where_;
  int fd_ = -1;
  bool streaming_ = false;
  std::vector<Mapped> buffers_;
};

}  // namespace

std::unique_ptr<VideoChannel> make_v4l2_channel(std::string device) {
  return std::make_unique<V4l2Channel>(std::move(device));
}

}  // namespace luxrig
