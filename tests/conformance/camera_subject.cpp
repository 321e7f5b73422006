// Cameras: a video device in the same process under a stepped clock, and a folder that another program fills. A camera
// must see the light that is there.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "core/rig/rig_file.h"
#include "drivers/camera/camera_source.h"
#include "tests/conformance/subject.h"
#include "tests/drivers/camera/model_video.h"

namespace luxrig {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr int kSeen_px = 4;
constexpr double kSeenTolerance = 0.002;
constexpr Duration kPicturesEvery = milliseconds(100);

Rig rig_of_camera(PictureSource source) {
  Rig rig;
  PictureCamera camera;
  camera.name = "cam";
  camera.width_px = camera.height_px = kSeen_px;
  camera.taking.source = source;
  rig.cameras.push_back(camera);
  return rig;
}

class CameraSubject : public Subject {
 public:
  Result<void> call(double drive) override {
    show(drive);
    const auto taken = driver->picture_taker()->take(now);
    if (!taken) return tl::unexpected(taken.error());
    double sum = 0;
    for (const Vec3f& pixel : taken->light) sum += static_cast<double>(pixel.y());
    seen_ = sum / static_cast<double>(taken->light.size());
    return {};
  }
  [[nodiscard]] Duration period() const override { return kPicturesEvery; }
  [[nodiscard]] bool at(double drive) const override { return seen_ && std::abs(*seen_ - drive) < kSeenTolerance; }
  [[nodiscard]] bool at_either(double before, double current) const override { return at(before) || at(current); }
  std::vector<std::string> bad_requests_taken() override {
    std::vector<std::string> taken;
    for (const double exposure_s :
         {std::numeric_limits<double>::quiet_NaN(), 0.0, -0.01, std::numeric_limits<double>::infinity()}) {
      const auto set = dynamic_cast<CameraSource&>(*driver).set_exposure(exposure_s);
      if (set || set.error().cause != Cause::invalid || set.error().detail.empty())
        taken.push_back("exposure " + std::to_string(exposure_s));
    }
    return taken;
  }

 protected:
  virtual void show(double drive) = 0;
  std::optional<double> seen_;  ///< of the last picture
};

/// At a model device: time passes while the driver waits for its frames.
class VideoSubject final : public CameraSubject {
 public:
  VideoSubject() : rig_(rig_of_camera(PictureSource::v4l2)) {
    device_.width_px = device_.height_px = kSeen_px;
    device_.controls.at(VideoControl::exposure).second = 321;  // set by another program before
    device_.controls.at(VideoControl::gain).second = 77;
    power_on_ = device_.controls;
    rig_.cameras[0].taking.exposure_s = kExposure_s;
    driver = make_video_camera_over(std::make_unique<ModelVideoChannel>(device_), rig_, 0);
    bounds = driver->bounds();
  }
  ~VideoSubject() override { driver.reset(); }

  void cycle(double drive) override {
    const Duration start = device_.clock;
    last = call(drive);
    const Duration took = device_.clock - start;
    worst_over_bound = std::max(worst_over_bound, took - bounds.read);
    device_.clock = std::max(device_.clock, start + kPicturesEvery);
    now += std::max(took, kPicturesEvery);
  }
  bool left_as_agreed(double) override {
    for (const auto& [control, found] : power_on_)
      if (device_.controls.at(control).second != found.second) return false;
    return device_.opened == device_.closed;
  }
  bool untouched() override { return device_.opened == 0 && device_.sets.empty(); }
  void set_fault(sim::FaultKind fault) override {
    fault_ = fault;
    if (fault == sim::FaultKind::dead) device_.plugged_in = false;
    if (fault == sim::FaultKind::silent) device_.stalls = true;
    if (fault == sim::FaultKind::slow) device_.frame_interval = milliseconds(900);
  }
  void clear_faults() override {
    if (!device_.plugged_in) device_.controls = power_on_;
    device_.plugged_in = true;
    device_.stalls = false;
    device_.frame_interval = milliseconds(33);
    device_.cut = device_.damaged = 0;
    fault_.reset();
  }
  [[nodiscard]] const ModelVideo& device() const { return device_; }

 private:
  static constexpr double kExposure_s = 0.01;

  void show(double drive) override {
    device_.full_scale_per_s = drive / kExposure_s;
    if (fault_ == sim::FaultKind::garbled) device_.cut = 1000;
    if (fault_ == sim::FaultKind::lost) device_.damaged = 3;
  }

  Rig rig_;
  ModelVideo device_;
  std::map<VideoControl, std::pair<ControlRange, std::int64_t>> power_on_;
  std::optional<sim::FaultKind> fault_;
};

/// Another program puts a 16-bit picture into a folder whenever one is wanted.
class FolderSubject final : public CameraSubject {
 public:
  FolderSubject() : rig_(rig_of_camera(PictureSource::files)) {
    std::string name = (fs::temp_directory_path() / "luxrig-camera-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
    rig_.cameras[0].taking.files = folder_;
    write(0);
    driver = make_camera(rig_, 0);
    bounds = driver->bounds();
  }
  ~FolderSubject() override {
    driver.reset();
    fs::remove_all(folder_);
    fs::remove_all(away());
  }

  void cycle(double drive) override {
    const auto start = std::chrono::steady_clock::now();
    last = call(drive);
    const auto took = std::chrono::steady_clock::now() - start;
    worst_over_bound = std::max(worst_over_bound, std::chrono::duration_cast<Duration>(took) - bounds.read);
    now += kPicturesEvery;
  }
  bool left_as_agreed(double) override { return untouched(); }
  /// The pictures belong to another program.
  bool untouched() override {
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(folder_)) files += entry.path() == newest_;
    return files == 1 && fs::file_size(newest_) == written_;
  }
  void set_fault(sim::FaultKind fault) override {
    fault_ = fault;
    if (fault == sim::FaultKind::dead) fs::rename(folder_, away());
  }
  void clear_faults() override {
    if (fault_ == sim::FaultKind::dead) fs::rename(away(), folder_);
    fault_.reset();
  }

 private:
  [[nodiscard]] fs::path away() const { return folder_.string() + "-away"; }
  void show(double drive) override {
    if (fault_ == sim::FaultKind::dead || fault_ == sim::FaultKind::silent) return;
    if (fault_ == sim::FaultKind::lost && number_ % 2 == 0) return;
    write(drive);
  }
  void write(double drive) {
    const int sample = static_cast<int>(std::lround(drive * 65535));
    std::string bytes = "P5 4 4 65535\n";
    for (int p = 0; p < kSeen_px * kSeen_px; ++p) {
      bytes += static_cast<char>(sample >> 8);
      bytes += static_cast<char>(sample & 255);
    }
    if (fault_ == sim::FaultKind::garbled) bytes.resize(static_cast<std::size_t>(number_ % 40));
    const fs::path before = newest_;
    newest_ = folder_ / ("shot_" + std::to_string(++number_) + ".pgm");
    std::ofstream(newest_, std::ios::binary) << bytes;
    written_ = bytes.size();
    if (!before.empty()) fs::remove(before);
  }

  Rig rig_;
  fs::path folder_, newest_;
  std::size_t written_ = 0;
  int number_ = 0;
  std::optional<sim::FaultKind> fault_;
};

void add_number(std::vector<std::vector<std::uint8_t>>& record, double value) {
  const std::string text = std::to_string(value);
  record.emplace_back(text.begin(), text.end());
}

/// Every control that the driver sets, and the light that it sees.
std::vector<std::vector<std::uint8_t>> record_video() {
  std::vector<std::vector<std::uint8_t>> record;
  VideoSubject subject;
  EXPECT_TRUE(subject.driver->activate(subject.now));
  for (int i = 0; i < 5; ++i) {
    subject.cycle(0.1 * i);
    EXPECT_TRUE(subject.at(0.1 * i));
  }
  subject.driver->deactivate(subject.now);
  for (const auto& [control, value] : subject.device().sets) {
    record.push_back({static_cast<std::uint8_t>(control)});
    add_number(record, static_cast<double>(value));
  }
  add_number(record, to_seconds(subject.device().clock));
  return record;
}

/// The driver's health after each picture.
std::vector<std::vector<std::uint8_t>> record_folder() {
  std::vector<std::vector<std::uint8_t>> record;
  FolderSubject subject;
  EXPECT_TRUE(subject.driver->activate(subject.now));
  for (int i = 0; i < 5; ++i) {
    subject.cycle(0.1 * i);
    EXPECT_TRUE(subject.at(0.1 * i));
    const Health health = subject.bus();
    add_number(record, to_seconds(health.last_ok - Time{}));
    add_number(record, static_cast<double>(health.received));
  }
  return record;
}

/// Problems of a rig file with this text in line 33.
std::vector<Problem> problems_of_camera_line(const std::string& source, const std::string& line) {
  std::string text =
      "[rig]\nname = \"seen\"\n[[camera]]\nname = \"cam\"\nposition_m = [1, 2, 3]\naim_m = [0, 0, 0]\n" + source;
  while (std::count(text.begin(), text.end(), '\n') < 32) text += '\n';
  const auto rig = parse_rig(text + line + "\n", "rig.toml", fs::temp_directory_path());
  return rig ? std::vector<Problem>{} : rig.error();
}

}  // namespace

std::vector<Kind> camera_kinds() {
  Kind video;
  video.name = "camera_v4l2";
  video.connected = [] { return std::make_unique<VideoSubject>(); };
  video.alone = [] {
    Rig rig = rig_of_camera(PictureSource::v4l2);
    rig.cameras[0].taking.device = "/dev/luxrig-no-such-camera";
    return make_camera(rig, 0);
  };
  video.sends_by_itself = false;
  video.record = record_video;
  video.problems_of_misspelt_option = [](std::string& known) {
    known = "exposure_ms";
    return problems_of_camera_line("source = \"v4l2\"\n", "exposure_msx = 10");
  };
  video.option_column = 1;
  Kind folder;
  folder.name = "camera_files";
  folder.connected = [] { return std::make_unique<FolderSubject>(); };
  folder.alone = [] {
    Rig rig = rig_of_camera(PictureSource::files);
    rig.cameras[0].taking.files = "/luxrig-no-such-folder";
    return make_camera(rig, 0);
  };
  folder.sends_by_itself = false;
  folder.record = record_folder;
  folder.problems_of_misspelt_option = [](std::string& known) {
    known = "files";
    return problems_of_camera_line("source = \"files\"\nfiles = \".\"\n", "filesx = \"shots\"");
  };
  folder.option_column = 1;
  return {std::move(video), std::move(folder)};
}

}  // namespace luxrig
