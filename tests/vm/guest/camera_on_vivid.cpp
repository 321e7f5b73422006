// The camera driver with vivid, the kernel's virtual video device. vivid's own controls set its test patterns and
// faults. camera_on_vivid look|formats|settings|busy|damaged|unplug Exits 0 if all checks held.
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <functional>
#include <thread>

#include "drivers/camera/camera_source.h"
#include "drivers/camera/v4l2_devices.h"
#include "drivers/camera/video_settings.h"

namespace {

using namespace luxrig;

int failures = 0;
void check(bool so, const std::string& what) {
  fmt::print("{} {}\n", so ? "ok    " : "FAILED", what);
  std::fflush(stdout);
  failures += !so;
}

Time now() {
  return Time{} + std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch());
}

/// vivid's own controls, by name: the kernel's headers have no numbers for them. While the driver has the device open,
/// no other descriptor may set them, so this uses the driver's.
class VividControls {
 public:
  explicit VividControls(std::string path) : path_(std::move(path)) {}
  [[nodiscard]] int set(const std::string& name, int value) const {
    return with_control(name, [value](int fd, const v4l2_queryctrl& about) { return set_at(fd, about.id, value); });
  }
  /// Sets a menu control by the text of the choice.
  [[nodiscard]] int choose(const std::string& name, const std::string& choice) const {
    return with_control(name, [&choice](int fd, const v4l2_queryctrl& about) {
      for (int i = about.minimum; i <= about.maximum; ++i) {
        v4l2_querymenu entry{};
        entry.id = about.id;
        entry.index = static_cast<std::uint32_t>(i);
        if (::ioctl(fd, VIDIOC_QUERYMENU, &entry) == 0 && choice == reinterpret_cast<const char*>(entry.name))
          return set_at(fd, about.id, i);
      }
      return ENOENT;
    });
  }

 private:
  static int set_at(int fd, std::uint32_t id, int value) {
    v4l2_control control{id, value};
    return ::ioctl(fd, VIDIOC_S_CTRL, &control) == 0 ? 0 : errno;
  }
  [[nodiscard]] int with_control(const std::string& name,
                                 const std::function<int(int fd, const v4l2_queryctrl& about)>& use) const {
    const int drivers = fd_of_driver(), fd = drivers >= 0 ? drivers : ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
    int code = ENOENT;
    v4l2_queryctrl about{};
    about.id = V4L2_CTRL_FLAG_NEXT_CTRL;
    while (::ioctl(fd, VIDIOC_QUERYCTRL, &about) == 0) {
      if (name == reinterpret_cast<const char*>(about.name)) {
        code = use(fd, about);
        break;
      }
      about.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
    if (drivers < 0) ::close(fd);
    return code;
  }
  [[nodiscard]] int fd_of_driver() const {
    for (int fd = 3; fd < 64; ++fd) {
      std::error_code error;
      if (std::filesystem::read_symlink(fmt::format("/proc/self/fd/{}", fd), error) == path_ && !error) return fd;
    }
    return -1;
  }
  std::string path_;
};

Rig rig_of(const std::string& device, PixelFormat format = PixelFormat::any, int width_px = 320, int height_px = 180) {
  Rig rig;
  PictureCamera camera;
  camera.name = "cam";
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.taking.source = PictureSource::v4l2;
  camera.taking.device = device;
  camera.taking.format = format;
  rig.cameras.push_back(camera);
  return rig;
}

std::string why(const Result<RawPicture>& picture) { return picture ? std::string("taken") : picture.error().detail; }

/// Mean of each channel over the middle of the picture, or -1.
Vec3 middle(const Result<RawPicture>& picture) {
  if (!picture) return Vec3::Constant(-1);
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int y = picture->height_px / 4; y < 3 * picture->height_px / 4; ++y)
    for (int x = picture->width_px / 4; x < 3 * picture->width_px / 4; ++x, ++count)
      for (int c = 0; c < 3; ++c)
        sum[c] += static_cast<double>(picture->samples[static_cast<std::size_t>(
            (y * picture->width_px + x) * picture->channels + (picture->channels == 3 ? c : 0))]);
  return sum / count;
}

void look() {
  const auto devices = v4l2_devices();
  for (const V4l2Device& d : devices) fmt::print("  {} \"{}\" at {}\n", d.path, d.name, d.bus);
  check(devices.size() == 2, "two cameras are found");
  check(devices.size() == 2 && devices[0].name == "vivid" && devices[0].bus == "platform:vivid-000" &&
            devices[1].bus == "platform:vivid-001",
        "by name and bus");
  const auto one = choose_device(devices, "platform:vivid-001");
  check(one && one->path == devices[1].path, "one is chosen by its bus");
  const auto both = choose_device(devices, "");
  check(!both && both.error().detail.find("vivid-000") != std::string::npos, "two are not chosen from by nothing");
  check(!choose_device(devices, "Webcam 9000"), "one that is not there is said");
}

void formats() {
  const VividControls controls("/dev/video0");
  check(controls.choose("OSD Text Mode", "None") == 0, "no text in the pattern");
  const struct {
    const char* pattern;
    Vec3 rgb;
  } colours[] = {{"100% White", {1, 1, 1}},
                 {"100% Black", {0, 0, 0}},
                 {"100% Red", {1, 0, 0}},
                 {"100% Green", {0, 1, 0}},
                 {"100% Blue", {0, 0, 1}}};
  for (const PixelFormat format : {PixelFormat::grey8, PixelFormat::grey10, PixelFormat::grey12, PixelFormat::grey16,
                                   PixelFormat::yuyv, PixelFormat::rgb24, PixelFormat::bgr24}) {
    const Rig rig = rig_of("/dev/video0", format);
    const auto camera = make_camera(rig, 0);
    (void)camera->activate(now());
    for (const auto& colour : colours) {
      check(controls.choose("Test Pattern", colour.pattern) == 0, std::string("pattern ") + colour.pattern);
      const auto taken = camera->take_raw(now());
      const Vec3 got = middle(taken);
      const bool grey = format != PixelFormat::yuyv && format != PixelFormat::rgb24 && format != PixelFormat::bgr24;
      fmt::print("  {} {}: {:.4f} {:.4f} {:.4f} {}\n", name_of(format), colour.pattern, got.x(), got.y(), got.z(),
                 why(taken));
      if (!grey) {
        check((got - colour.rgb).cwiseAbs().maxCoeff() < 0.02, "is that colour");
      } else if (colour.rgb.minCoeff() == 1 || colour.rgb.maxCoeff() == 0) {
        // vivid calculates in eight bits, which grey formats have at their upper end.
        check(std::abs(got.x() - colour.rgb.x()) < 0.01, "is that grey");
      }
    }
    camera->deactivate(now());
  }
  const auto best = make_camera(rig_of("/dev/video0"), 0);
  (void)best->activate(now());
  const auto taken = best->take_raw(now());
  check(taken && taken->full_scale_counts == 65535, "any: the format with most bits");
  best->deactivate(now());
  const auto odd = make_camera(rig_of("/dev/video0", PixelFormat::grey8, 321, 181), 0);
  (void)odd->activate(now());
  const auto refused = odd->take_raw(now());
  check(!refused && refused.error().detail.find("320 x 180") != std::string::npos,
        "a size it has not: " + why(refused));
}

void settings() {
  const VividControls controls("/dev/video0");
  const auto channel = make_v4l2_channel("/dev/video0");
  const bool opened = channel->open().has_value();
  check(opened, "opened: " + channel->where());
  check(controls.set("Gain, Automatic", 1) == 0 && controls.set("Brightness", 7) == 0,
        "gain is automatic, brightness off its default");
  PictureTaking wanted;
  wanted.gain = 77;
  const auto fixed = fix_settings(*channel, wanted);
  check(fixed && fixed->changed && fixed->exposure_s == 0, "settings are fixed, exposure is not known");
  check(channel->get(VideoControl::autogain).value_or(-1) == 0 && channel->get(VideoControl::gain).value_or(-1) == 77 &&
            channel->get(VideoControl::brightness).value_or(-1) == channel->range(VideoControl::brightness)->fallback,
        "and read back");
  const auto again = fix_settings(*channel, wanted);
  check(again && !again->changed, "a second time nothing changes");
  wanted.exposure_s = 0.01;
  const auto exposed = fix_settings(*channel, wanted);
  check(!exposed && exposed.error().cause == Cause::refused, "exposure_ms is refused: it has no such control");
  wanted.exposure_s.reset();
  wanted.gain = 1000;
  check(!fix_settings(*channel, wanted), "a gain that it has not is refused");
  // Its automatic gain changes values by itself.
  check(channel->set(VideoControl::brightness, 3) && channel->set(VideoControl::autogain, 1), "as somebody set it up");
  const FoundSettings found = settings_found(*channel);
  wanted.gain = 77;
  check(fix_settings(*channel, wanted).has_value() && channel->get(VideoControl::autogain).value_or(-1) == 0,
        "settings are fixed again");
  check(give_back(*channel, found).has_value() && channel->get(VideoControl::autogain).value_or(-1) == 1 &&
            channel->get(VideoControl::brightness).value_or(-1) == 3,
        "and given back as found");
  const int other = ::open("/dev/video0", O_RDWR | O_CLOEXEC);
  v4l2_control brightness{V4L2_CID_BRIGHTNESS, 1};
  check(::ioctl(other, VIDIOC_S_CTRL, &brightness) != 0 && errno == EBUSY, "other programs cannot change its controls");
  ::close(other);
}

void busy() {
  const Rig rig = rig_of("/dev/video1", PixelFormat::grey8);
  const auto first = make_camera(rig, 0), second = make_camera(rig_of("/dev/video1", PixelFormat::grey16), 0);
  const auto beside = make_camera(rig_of("platform:vivid-000", PixelFormat::grey8), 0);
  (void)first->activate(now());
  check(first->take_raw(now()).has_value(), "one takes a picture");
  (void)second->activate(now());
  const auto refused = second->take_raw(now());
  check(!refused && refused.error().detail.find("in use") != std::string::npos, "another is told: " + why(refused));
  (void)beside->activate(now());
  check(beside->take_raw(now()).has_value(), "a second camera is taken beside it");
  check(first->take_raw(now()).has_value(), "and the first goes on");
  first->deactivate(now());
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  const auto freed = second->take_raw(now());
  check(freed.has_value(), "once it is free the other has it: " + why(freed));
}

void damaged() {
  const VividControls controls("/dev/video0");
  const auto camera = make_camera(rig_of("/dev/video0", PixelFormat::grey8), 0);
  (void)camera->activate(now());
  check(camera->take_raw(now()).has_value(), "a picture");
  check(controls.set("Inject V4L2_BUF_FLAG_ERROR", 1) == 0, "the next frame is damaged");
  const auto after = camera->take_raw(now());
  check(after.has_value(), "the one after it is taken: " + why(after));
  check(camera->health(now()).at(0).errors == 1, "and the damaged one is counted");
  check(controls.set("Percentage of Dropped Buffers", 100) == 0, "all frames are lost");
  const Time start = now();
  const auto stalled = camera->take_raw(start);
  const Duration took = now() - start;
  check(!stalled && stalled.error().cause == Cause::timeout, "a stalled stream is said: " + why(stalled));
  check(took < camera->bounds().read + std::chrono::milliseconds(500),
        fmt::format("within its bound: {:.2f} of {:.2f} s", to_seconds(took), to_seconds(camera->bounds().read)));
  check(camera->health(now()).at(0).life == Life::faulted, "and the camera is faulted");
  check(controls.set("Percentage of Dropped Buffers", 0) == 0, "frames come again");
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  const auto back = camera->take_raw(now());
  check(back && camera->health(now()).at(0).life == Life::active, "a picture again: " + why(back));
}

void unplug() {
  const auto camera = make_camera(rig_of("platform:vivid-001", PixelFormat::grey8), 0);
  (void)camera->activate(now());
  check(camera->take_raw(now()).has_value(), "a picture");
  {
    const VividControls controls("/dev/video1");
    check(controls.set("Disconnect", 1) == 0, "pulled out");
  }
  const auto gone = camera->take_raw(now());
  check(!gone && gone.error().cause == Cause::network, "said: " + why(gone));
  check(camera->health(now()).at(0).life == Life::faulted, "the camera is faulted");
  fmt::print("UNPLUGGED\n");
  std::fflush(stdout);
  Result<RawPicture> back = tl::unexpected(Fault{});
  for (int i = 0; i < 100 && !back; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    back = camera->take_raw(now());
  }
  check(back.has_value(), "plugged in again, it takes pictures: " + why(back));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  fmt::print("--- {}\n", what);
  if (what == "look") look();
  if (what == "formats") formats();
  if (what == "settings") settings();
  if (what == "busy") busy();
  if (what == "damaged") damaged();
  if (what == "unplug") unplug();
  return failures == 0 && !what.empty() ? 0 : 1;
}
