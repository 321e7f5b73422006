#include "tools/luxrig/calibrate/by_heads.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/calibration/camera_pose.h"
#include "core/calibration/head_found.h"
#include "core/calibration/head_run.h"
#include "tools/luxrig/calibrate/camera_eye.h"
#include "tools/luxrig/calibrate/head_turner.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

using Clock = std::chrono::steady_clock;

/// All lamps at once, to see where the camera hangs.
constexpr double kToLookAround = 0.4;
/// A camera is turned off where it was found to look by this at least, and off its file by that.
constexpr double kCameraKnown_rad = rad_from_deg(0.02), kCameraStated_rad = rad_from_deg(1);

/// What the camera sees, and how well that is known.
struct HeadView {
  SeenSurface surface;
  HeadPriors priors;
};

class HeadMeasurer {
 public:
  HeadMeasurer(const Session& stated, CameraEye& eye, DaemonRig& daemon, const std::stop_token& stop)
      : rig_(stated.rig),
        rays_(*stated.rays),
        eye_(eye),
        daemon_(daemon),
        stop_(stop),
        turner_(stated.rig, daemon, stop) {}

  Result<HeadView> look_around(const Camera& stated) {
    std::vector<double> level;
    for (const Fixture& fixture : rig_.fixtures)
      level.push_back((fixture.switched ? 1 : kToLookAround) * rig_.max_level(fixture));
    if (auto lit = daemon_.light(level, stop_); !lit) return tl::unexpected(lit.error());
    const auto picture = eye_.look(stop_);
    if (!picture) return tl::unexpected(picture.error());
    HeadView view{{}, {}};
    const auto found = find_camera(rays_, stated, picture->picture);
    const double rad_per_px = stated.vertical_fov_rad / stated.height_px;
    const double known_rad =
        found ? std::max(kCameraKnown_rad, found->standard_error_px * rad_per_px) : kCameraStated_rad;
    view.surface = seen_surface(rays_, found ? found->camera : stated);
    view.priors.camera.covariance_rad2 = Mat3::Identity() * (known_rad * known_rad);
    const std::vector<double> dark(rig_.fixtures.size(), 0.0);
    if (auto sent = daemon_.light(dark, stop_); !sent) return tl::unexpected(sent.error());
    return view;
  }

  Result<MeasuredHead> measure(const HeadView& view, std::size_t fixture) {
    MeasuredHead measured{fixture, {}, 0};
    const auto begun = Clock::now();
    HeadRun run(view.surface, rays_, turner_.setup(fixture, view.priors));
    turner_.begin();
    while (const auto step = run.next()) {
      const auto picture = take(fixture, *step);
      if (!picture) return tl::unexpected(picture.error());
      run.take(picture->picture);
    }
    measured.result = run.result();
    measured.seconds = std::chrono::duration<double>(Clock::now() - begun).count();
    return measured;
  }

 private:
  /// The picture of a step. The head has arrived when it returns.
  Result<MergedPicture> take(std::size_t fixture, const HeadStep& step) {
    const auto arrives = turner_.send(fixture, step.joints, step.lit);
    if (!arrives) return tl::unexpected(arrives.error());
    // In the dark, the picture may be taken on the way.
    if (auto waited = turner_.wait_until(step.lit ? *arrives : Clock::now() + HeadTurner::kObeys); !waited)
      return tl::unexpected(waited.error());
    auto picture = eye_.look(stop_);
    if (!picture) return picture;
    if (auto waited = turner_.wait_until(*arrives); !waited) return tl::unexpected(waited.error());
    return picture;
  }

  const Rig& rig_;
  const RayScene& rays_;
  CameraEye& eye_;
  DaemonRig& daemon_;
  std::stop_token stop_;
  HeadTurner turner_;
};

}  // namespace

std::vector<std::size_t> heads_of(const Rig& rig) {
  std::vector<std::size_t> heads;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
    if (rig.fixtures[f].moves && rig.fixtures[f].housing.value_or(f) == f) heads.push_back(f);
  return heads;
}

std::string limited_light_of(const Rig& rig) {
  if (heads_of(rig).empty()) return {};
  for (const Point& point : rig.points)
    if (point.max_lx)
      return fmt::format("so dim that \"{}\", which has a limit, would be within it wherever they look", point.name);
  return {};
}

Result<std::vector<MeasuredHead>> measure_heads(const Session& stated, std::size_t camera, const Camera& view,
                                                DaemonRig& daemon, const std::stop_token& stop) {
  std::vector<MeasuredHead> heads;
  const std::vector<std::size_t> fixtures = heads_of(stated.rig);
  if (fixtures.empty()) return heads;
  auto eye = camera_eye(stated.rig, camera, daemon.sim_control());
  if (!eye) return tl::unexpected(eye.error());
  HeadMeasurer measurer(stated, **eye, daemon, stop);
  const auto seen = measurer.look_around(view);
  if (!seen) return tl::unexpected(seen.error());
  const Progress progress = progress_line("turning heads");
  for (const std::size_t fixture : fixtures) {
    if (progress) progress(static_cast<double>(heads.size()) / static_cast<double>(fixtures.size()));
    auto head = measurer.measure(*seen, fixture);
    if (!head)
      return tl::unexpected(
          Fault{head.error().cause, "", stated.rig.fixtures[fixture].name + ": " + head.error().detail, {}});
    heads.push_back(std::move(*head));
  }
  std::vector<HeadResult> results;
  for (MeasuredHead& head : heads) results.push_back(std::move(head.result));
  conclude_together(seen->priors, results);
  for (std::size_t h = 0; h < heads.size(); ++h) heads[h].result = std::move(results[h]);
  return heads;
}

void put_heads(const Rig& rig, const std::vector<MeasuredHead>& heads, const Calibration* before, Calibration& found) {
  const auto entry_of = [](auto& calibration, const std::string& name) {
    return std::find_if(calibration.fixtures.begin(), calibration.fixtures.end(),
                        [&](const CalibratedFixture& one) { return one.name == name; });
  };
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (!rig.fixtures[f].moves) continue;
    const std::string& name = rig.fixtures[f].name;
    auto entry = entry_of(found, name);
    if (entry == found.fixtures.end()) {
      found.fixtures.emplace_back().name = name;
      entry = std::prev(found.fixtures.end());
    }
    const std::size_t of = rig.fixtures[f].housing.value_or(f);
    const auto head = std::find_if(heads.begin(), heads.end(), [&](const MeasuredHead& h) { return h.fixture == of; });
    if (head != heads.end() && !head->result.refused) {
      put_head(head->result.fit, *entry);
      if (const auto was = before ? entry_of(*before, name) : decltype(entry_of(*before, name)){};
          before && was != before->fixtures.end() && was->head)
        put_motion({was->head->pan_speed_deg_s, was->head->tilt_speed_deg_s, was->head->settling_s}, *entry->head);
      put_motion(head->motion, *entry->head);
      continue;
    }
    if (!before) continue;
    const auto was = entry_of(*before, name);
    if (was == before->fixtures.end() || !was->head) continue;
    entry->head = was->head;
    entry->offset_m = was->offset_m;
    entry->offset_error_m = was->offset_error_m;
    entry->turn_deg = was->turn_deg;
    entry->turn_error_deg = was->turn_error_deg;
  }
}

std::string words_of(const Rig& rig, const MeasuredHead& head) {
  const std::string& name = rig.fixtures[head.fixture].name;
  const HeadResult& result = head.result;
  if (result.refused) return fmt::format("Head \"{}\" is not found: {}.", name, *result.refused);
  double most_rad = 0;
  for (const HeadSighting& sighting : result.held_out)
    most_rad = std::max(most_rad, off_sight(result.fit, sighting).norm());
  const HeadVector& found = result.fit.pose.parameters;
  const std::string kind = words_of(result.fit.kind);
  std::string text = fmt::format(
      "Head \"{}\" is found{}{}: {:.1f} cm and {:.1f}° off the rig file, play {:.2f}° in pan and {:.2f}° in tilt. The "
      "farthest of {} places kept for the test was missed by {:.2f}°; {:.0f} s.",
      name, kind.empty() ? "" : ", it ", kind, 100 * found.segment<3>(kHeadOffset).norm(),
      deg_from_rad(found.segment<3>(kHeadTurn).norm()), deg_from_rad(found[kHeadPanPlay]),
      deg_from_rad(found[kHeadTiltPlay]), result.held_out.size(), deg_from_rad(most_rad), head.seconds);
  const HeadMotion& motion = head.motion;
  const auto add = [&](const char* what, const Known& known, const char* unit) {
    if (known.standard_error > 0)
      text += fmt::format(" {} {:.3g} ± {:.2g} {}.", what, known.value, known.standard_error, unit);
  };
  add("It pans at", motion.pan_speed_deg_s, "°/s");
  add("It tilts at", motion.tilt_speed_deg_s, "°/s");
  add("Beside its way it needs", motion.settling_s, "s to stand still");
  return text;
}

}  // namespace luxrig
