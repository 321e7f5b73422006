#include "tools/luxrig/calibrate/by_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <numeric>
#include <utility>

#include "core/calibration/camera_run.h"
#include "core/picture/rig_camera.h"
#include "core/text/nearest.h"
#include "tools/luxrig/calibrate/camera_eye.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

/// Places that are no points of the rig; more teach little, and their light has to be traced.
constexpr int kPlacesOfCamera = 80;

/// A picture takes seconds. The light is held meanwhile.
Result<Picture> look_while_held(CameraEye& eye, DaemonRig& daemon, const std::stop_token& stop) {
  auto taken = std::async(std::launch::async, [&] { return eye.look(stop); });
  Result<void> held;
  while (taken.wait_for(DaemonRig::kHoldAgain) != std::future_status::ready)
    if (held) held = daemon.hold_again();
  auto picture = taken.get();
  if (!held) return tl::unexpected(held.error());
  return picture;
}

}  // namespace

std::vector<std::size_t> CameraView::points() const {
  std::vector<std::size_t> points(places.size());
  std::iota(points.begin(), points.end(), session->rig.points.size() - places.size());
  return points;
}

Result<CameraView> camera_view(const Session& stated, const std::string& name, LightPriors& priors) {
  const std::vector<PictureCamera>& cameras = stated.rig.cameras;
  const auto named = std::find_if(cameras.begin(), cameras.end(), [&](const auto& one) { return one.name == name; });
  if (named == cameras.end()) {
    std::vector<std::string_view> names;
    for (const PictureCamera& one : cameras) names.push_back(one.name);
    return refusal(
        fmt::format("the rig has no [[camera]] \"{}\": {}", name, mend_for_unknown(name, names, "this rig has none")));
  }
  std::vector<SeenPlace> places = seen_places(*stated.rays, view_of(*named), stated.rig.points, kPlacesOfCamera);
  if (places.empty()) return refusal(fmt::format("camera \"{}\" sees no matt surface to measure light on", name));
  auto session = session_of(with_places(stated.rig, places));
  if (!session) return refusal(session.error().front().text());
  return CameraView{static_cast<std::size_t>(named - cameras.begin()), std::move(places),
                    std::make_unique<const Session>(std::move(*session)),
                    CameraInstrument(stated.rig, stated.scene.materials.size(), priors)};
}

Result<std::vector<LightReading>> measure_by_camera(const Session& stated, const CameraView& view, DaemonRig& daemon,
                                                    std::span<const double> brightest, std::vector<LampCurve>& curves,
                                                    const std::stop_token& stop) {
  const Rig& rig = stated.rig;
  const PictureCamera& camera = rig.cameras[view.camera];
  auto eye = camera_eye(rig, view.camera, daemon.sim_control());
  if (!eye) return tl::unexpected(eye.error());
  CameraRun run(rig, *stated.rays, view_of(camera), view.places, brightest, curves);
  const Progress progress = progress_line("photographing");
  while (const auto level = run.next()) {
    if (progress) progress(static_cast<double>(run.done()) / static_cast<double>(run.steps()));
    const std::string words = run.words_of_next();
    const auto during = [&](const Fault& fault) {
      return tl::unexpected(Fault{fault.cause, "", words + ": " + fault.detail, {}});
    };
    const auto sent = daemon.light(*level, stop);
    if (!sent) return during(sent.error());
    const auto picture = look_while_held(**eye, daemon, stop);
    if (!picture) return during(picture.error());
    if (auto taken = run.take(*sent, *picture); !taken) return during(taken.error());
  }
  const FoundCamera& found = *run.found();
  fmt::print(
      "Camera \"{}\" shows edges of the room {:.1f} px off where the rig file has it; where it is now found to be, "
      "{:.1f} px, and places to {:.1f} px.\n",
      camera.name, found.stated_off_px, found.off_px, found.standard_error_px);
  curves = run.curves();
  return run.readings(view.instrument, rig.points.size());
}

std::string budget_words(const Rig& rig, const CameraView& view, const RigLight& light, const Eigen::VectorXd& level) {
  CameraBudget sum;
  double goals = 0;
  struct Part {
    const char* words;
    double CameraBudget::*share;
  };
  constexpr Part kParts[] = {{"lamps and mounts", &CameraBudget::lamps},
                             {"the camera's response to each kind of lamp", &CameraBudget::response},
                             {"paint", &CameraBudget::reflectance},
                             {"lens", &CameraBudget::lens},
                             {"stray light in it", &CameraBudget::stray},
                             {"noise", &CameraBudget::noise},
                             {"all else", &CameraBudget::other}};
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    if (!rig.points[p].goal_lx) continue;
    const CameraBudget shares = view.instrument.shares_of(light.known().budget(p, level));
    for (const Part& part : kParts) sum.*part.share += shares.*part.share;
    ++goals;
  }
  std::string words;
  for (const Part& part : kParts)
    if (goals > 0 && sum.*part.share / goals >= 0.005)
      words += fmt::format("{}{} {:.0f} %", words.empty() ? "" : ", ", part.words, 100 * sum.*part.share / goals);
  return words;
}

}  // namespace luxrig
