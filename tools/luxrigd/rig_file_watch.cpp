#include "tools/luxrigd/rig_file_watch.h"

#include <algorithm>
#include <array>
#include <condition_variable>
#include <fstream>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include "core/estimation/calibration.h"
#include "tools/luxrigd/scheduling.h"

namespace luxrig {
namespace {

/// Time of writing and size. The content is read again only when one of them has changed.
using FileStamp = std::pair<std::filesystem::file_time_type, std::uintmax_t>;

std::optional<FileStamp> stamp_of(const std::filesystem::path& file) {
  std::error_code error;
  FileStamp stamp;
  stamp.first = std::filesystem::last_write_time(file, error);
  if (error) return std::nullopt;
  stamp.second = std::filesystem::file_size(file, error);
  return error ? std::nullopt : std::optional(stamp);
}

/// FNV-1a of the content; nullopt if it cannot be read.
std::optional<std::uint64_t> content_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  std::uint64_t hash = 0xcbf29ce484222325U;
  std::array<char, 65536> block;
  while (in.read(block.data(), block.size()) || in.gcount() > 0)
    for (std::streamsize i = 0; i < in.gcount(); ++i)
      hash = (hash ^ static_cast<unsigned char>(block[static_cast<std::size_t>(i)])) * 0x100000001b3U;
  return hash;
}

}  // namespace

std::vector<std::filesystem::path> files_of(const Rig& rig) {
  std::vector<std::filesystem::path> files = {rig.file};
  const auto add = [&](const std::filesystem::path& file) {
    if (!file.empty() && std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  };
  if (rig.scene.mesh) add(rig.scene.mesh->path);
  for (const SceneObject& object : rig.scene.objects)
    if (object.mesh) add(object.mesh->path);
  for (const Luminaire& luminaire : rig.luminaires) add(luminaire.ies_path);
  for (const Fixture& fixture : rig.fixtures)
    if (fixture.mode) add(fixture.mode->file);
  for (const SurfaceGoalSpec& goal : rig.surface_goals) add(goal.strokes_file);
  add(calibration_file(rig));
  return files;
}

struct RigFileWatch::State {
  struct WatchedFile {
    std::filesystem::path file;
    std::optional<FileStamp> stamp;
    std::optional<std::uint64_t> first_content;
    bool changed = false;
  };
  std::mutex mutex;
  std::condition_variable_any wake;
  std::vector<WatchedFile> files;
  std::jthread thread;

  void run(const std::stop_token& stop, Duration period) {
    make_background();
    bool first = true;
    while (!stop.stop_requested()) {
      for (std::size_t i = 0; i < files.size(); ++i) look_at(files[i], first);
      first = false;
      std::unique_lock lock(mutex);
      wake.wait_for(lock, stop, period, [] { return false; });
    }
  }

  /// Only this thread writes; the mutex is for callers of changed().
  void look_at(WatchedFile& watched, bool first) {
    const std::optional<FileStamp> stamp = stamp_of(watched.file);
    if (!first && stamp == watched.stamp) return;
    const std::optional<std::uint64_t> content = content_of(watched.file);
    const std::lock_guard lock(mutex);
    watched.stamp = stamp;
    if (first) watched.first_content = content;
    watched.changed = content != watched.first_content;
  }
};

RigFileWatch::RigFileWatch(std::vector<std::filesystem::path> files, Duration period)
    : state_(std::make_unique<State>()) {
  for (std::filesystem::path& file : files) state_->files.push_back({std::move(file), {}, {}, false});
  state_->thread =
      std::jthread([state = state_.get(), period](const std::stop_token& stop) { state->run(stop, period); });
}

RigFileWatch::~RigFileWatch() = default;

std::vector<std::filesystem::path> RigFileWatch::changed() const {
  const std::lock_guard lock(state_->mutex);
  std::vector<std::filesystem::path> files;
  for (const State::WatchedFile& watched : state_->files)
    if (watched.changed) files.push_back(watched.file);
  return files;
}

}  // namespace luxrig
