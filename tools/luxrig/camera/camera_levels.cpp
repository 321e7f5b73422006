#include "tools/luxrig/camera/camera_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <thread>

#include "core/plan/plan.h"
#include "drivers/camera/file_listing.h"
#include "tools/luxrig/camera/camera_series.h"
#include "tools/process/meeting_place.h"
#include "tools/process/status_fields.h"

namespace luxrig {
namespace {

using nlohmann::json;

constexpr double kLowestLevel = 0.05, kLevelStill = 1e-3;
constexpr std::chrono::milliseconds kAskEvery(200);
constexpr std::chrono::seconds kLightWithin(60);
constexpr int kSettled = 5;  ///< equal answers

/// Light from the camera's response to the samples. Samples that are light already stay as they are.
std::vector<float> judged_light(const RawPicture& picture, const SampleCurve& curve) {
  std::vector<float> light = judged_samples(picture);
  if (picture.is_light) return light;
  for (float& sample : light) sample = static_cast<float>(curve.light(static_cast<double>(sample)));
  return light;
}

/// From cd/m² to shares of the brightest.
void normalise(LevelSeries& series) {
  float most = 0;
  for (const LevelStep& step : series.steps)
    for (const auto& frame : step.frames)
      for (const float light : frame) most = std::max(most, light);
  if (!(most > 0)) return;
  const auto scale = [most](LevelStep& step) {
    for (auto& frame : step.frames)
      for (float& light : frame) light /= most;
  };
  scale(series.dark);
  for (LevelStep& step : series.steps) scale(step);
}

class DaemonLight final : public LevelLight {
 public:
  DaemonLight(const Rig& rig, std::size_t fixture, int port, std::optional<std::filesystem::path> token)
      : rig_(rig), fixture_(fixture), port_(port), token_(std::move(token)) {}

  Result<double> set(double level) override {
    if (before_.empty()) {
      auto before = levels();
      if (!before) return tl::unexpected(before.error());
      before_ = std::move(*before);
    }
    std::vector<double> wanted(rig_.fixtures.size(), 0.0);
    wanted[fixture_] = level;
    if (auto applied = apply(wanted); !applied) return tl::unexpected(applied.error());
    // Wait for the fade, and for lamps and daemon to settle.
    int alike = 0;
    std::vector<double> last;
    for (const auto until = std::chrono::steady_clock::now() + kLightWithin;
         std::chrono::steady_clock::now() < until;) {
      std::this_thread::sleep_for(kAskEvery);
      auto seen = levels();
      if (!seen) return tl::unexpected(seen.error());
      alike = *seen == last && (level > 0) == ((*seen)[fixture_] > 0) ? alike + 1 : 0;
      last = std::move(*seen);
      if (alike < kSettled) continue;
      for (std::size_t f = 0; f < last.size(); ++f)
        if (f != fixture_ && last[f] > kLevelStill) return tl::unexpected(not_alone(f, last[f]));
      held_ = last;
      return last[fixture_];
    }
    return tl::unexpected(Fault{Cause::timeout,
                                rig_.fixtures[fixture_].name,
                                fmt::format("the light does not come to rest at level {:g} within {} s: take its bus's "
                                            "alarms away, or stop what else sets the light",
                                            level, kLightWithin.count()),
                                {}});
  }

  Result<void> still() override {
    const auto seen = levels();
    if (!seen) return tl::unexpected(seen.error());
    for (std::size_t f = 0; f < held_.size(); ++f)
      if (std::abs((*seen)[f] - held_[f]) > kLevelStill) return tl::unexpected(not_alone(f, (*seen)[f]));
    return {};
  }

  void give_back() override {
    if (!before_.empty()) (void)apply(before_);
    before_.clear();
  }

 private:
  [[nodiscard]] Fault not_alone(std::size_t fixture, double level) const {
    return {Cause::refused,
            rig_.fixtures[fixture].name,
            fmt::format("its level became {:.3f} by itself: luxmeters correct the light, or limits or a desk change "
                        "it; run the daemon for this check on a rig file without goals",
                        level),
            {}};
  }
  Result<std::vector<double>> levels() const {
    const auto daemon = daemon_on(port_, token_);
    if (!daemon) return tl::unexpected(daemon.error());
    const auto answer = http_get(*daemon, "/api/status");
    if (!answer) return tl::unexpected(no_daemon(port_));
    const json status = json::parse(answer->body, nullptr, false);
    std::vector<double> levels;
    const json fixtures = list_of(status, "fixtures");
    for (std::size_t f = 0; f < fixtures.size() && f < rig_.fixtures.size(); ++f) {
      const auto level = number_of(fixtures[f], "level");
      if (level && text_of(fixtures[f], "name") == rig_.fixtures[f].name) levels.push_back(*level);
    }
    if (levels.size() != rig_.fixtures.size() || fixtures.size() != levels.size())
      return tl::unexpected(
          Fault{Cause::refused,
                {},
                fmt::format("the daemon on port {} drives another rig: give the --port of this one's", port_),
                {}});
    return levels;
  }

  Result<void> apply(const std::vector<double>& levels) const {
    Plan plan;
    plan.rig = rig_.name;
    PlannedTask task;
    task.name = "camera check";
    task.kind = name_of(TaskKind::emittance);
    for (std::size_t f = 0; f < levels.size(); ++f) {
      PlannedLight light;
      light.name = rig_.fixtures[f].name;
      light.level = std::clamp(levels[f], 0.0, rig_.fixtures[f].max_level);
      task.lights.push_back(std::move(light));
    }
    plan.tasks.push_back(std::move(task));
    const auto daemon = daemon_on(port_, token_);
    if (!daemon) return tl::unexpected(daemon.error());
    const auto answer = http_post_json(*daemon, "/api/apply", to_json(plan), 300);
    if (!answer) return tl::unexpected(no_daemon(port_));
    if (answer->status == 200) return {};
    return tl::unexpected(Fault{Cause::refused, {}, "refused by the daemon: " + answer->body, {}});
  }

  const Rig& rig_;
  std::size_t fixture_;
  int port_;
  std::optional<std::filesystem::path> token_;
  std::vector<double> before_, held_;
};

/// "wall_40pct_3.png": 0.4.
std::optional<double> level_in_name(const std::string& name) {
  for (std::size_t at = name.find("pct"); at != std::string::npos; at = name.find("pct", at + 3)) {
    std::size_t begin = at;
    while (begin > 0 && (std::isdigit(static_cast<unsigned char>(name[begin - 1])) != 0 || name[begin - 1] == '.'))
      --begin;
    if (begin == at || (at + 3 < name.size() && std::isalpha(static_cast<unsigned char>(name[at + 3])) != 0)) continue;
    const double percent = std::strtod(name.substr(begin, at - begin).c_str(), nullptr);
    if (percent >= 0 && percent <= 100) return percent / 100;
  }
  return std::nullopt;
}

}  // namespace

std::unique_ptr<LevelLight> make_daemon_light(const Rig& rig, std::size_t fixture, int port,
                                              const std::optional<std::filesystem::path>& token) {
  return std::make_unique<DaemonLight>(rig, fixture, port, token);
}

Result<LevelSeries> take_level_series(LevelLight& light, const TakeRaw& take, const SampleCurve& curve,
                                      const LevelsWanted& wanted, const Progress& progress) {
  LevelSeries series;
  bool is_light = false;
  int done = 0;
  const auto one = [&](double level) -> Result<LevelStep> {
    const auto reached = light.set(level);
    if (!reached) return tl::unexpected(reached.error());
    LevelStep step{*reached, {}};
    for (int f = 0; f < wanted.frames; ++f) {
      const auto picture = take();
      if (!picture) return tl::unexpected(picture.error());
      series.full_scale_counts = picture->full_scale_counts;
      is_light = picture->is_light;
      step.frames.push_back(judged_light(*picture, curve));
      progress(static_cast<double>(++done) / ((wanted.steps + 1) * wanted.frames));
    }
    if (auto still = light.still(); !still) return tl::unexpected(still.error());
    return step;
  };
  const auto all = [&]() -> Result<void> {
    auto dark = one(0);
    if (!dark) return tl::unexpected(dark.error());
    series.dark = std::move(*dark);
    // Steps as in exposures_between(), which avoid a common ratio.
    for (const double level : exposures_between(kLowestLevel, 1, wanted.steps)) {
      auto step = one(std::min(1.0, level));
      if (!step) return tl::unexpected(step.error());
      // Limits may give the same level twice.
      if (series.steps.empty() || step->level > series.steps.back().level * 1.001)
        series.steps.push_back(std::move(*step));
    }
    return {};
  }();
  light.give_back();
  if (!all) return tl::unexpected(all.error());
  if (is_light) normalise(series);
  return series;
}

Result<LevelSeries> level_series_of_files(const PictureCamera& camera, const SampleCurve& curve) {
  const auto files = picture_files(camera.taking.files);
  if (!files) return tl::unexpected(files.error());
  const auto refuse = [&](const std::string& file, const char* why) {
    return tl::unexpected(Fault{Cause::refused, camera.name, file + why, {}});
  };
  LevelSeries series;
  std::map<double, LevelStep> by_level;
  bool is_light = false;
  for (const auto& file : *files) {
    const auto level = level_in_name(file.filename().string());
    if (!level) return refuse(file.string(), " does not say its level: name it as wall_40pct_1.png");
    const auto picture = read_picture_file(file, camera);
    if (!picture) return tl::unexpected(picture.error());
    if (!by_level.empty() && (series.full_scale_counts != picture->full_scale_counts || is_light != picture->is_light))
      return refuse(file.string(), " has other steps than those before it");
    series.full_scale_counts = picture->full_scale_counts;
    is_light = picture->is_light;
    LevelStep& step = by_level[*level];
    step.level = *level;
    step.frames.push_back(judged_light(*picture, curve));
  }
  for (auto& [level, step] : by_level) {
    if (level > 0)
      series.steps.push_back(std::move(step));
    else
      series.dark = std::move(step);
  }
  if (is_light) normalise(series);
  return series;
}

}  // namespace luxrig
