#include "tools/luxrig/calibrate/by_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <numeric>
#include <utility>

#include "core/calibration/camera_offset.h"
#include "core/picture/rig_camera.h"
#include "core/text/nearest.h"
#include "tools/luxrig/calibrate/camera_eye.h"
#include "tools/terminal/command.h"
#include "tools/terminal/picture_png.h"

namespace luxrig {
namespace {

/// Places that are no points of the rig; more teach little, and their light has to be traced.
constexpr int kPlacesOfCamera = 80;

/// A picture takes seconds. The light is held meanwhile.
Result<MergedPicture> look_while_held(CameraEye& eye, DaemonRig& daemon, const std::stop_token& stop) {
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

Result<CameraView> camera_view(const Session& stated, const std::string& name, const Calibration* before,
                               LightPriors& priors) {
  const std::vector<PictureCamera>& cameras = stated.rig.cameras;
  const auto named = std::find_if(cameras.begin(), cameras.end(), [&](const auto& one) { return one.name == name; });
  if (named == cameras.end()) {
    std::vector<std::string_view> names;
    for (const PictureCamera& one : cameras) names.push_back(one.name);
    return refusal(
        fmt::format("the rig has no [[camera]] \"{}\": {}", name, mend_for_unknown(name, names, "this rig has none")));
  }
  CameraStart start{view_of(*named)};
  if (before)
    for (const CalibratedCamera& found : before->cameras)
      if (found.name == name) start.found_before = view_of(*named, found);
  std::vector<SeenPlace> places = seen_places(*stated.rays, start.stated, stated.rig.points, kPlacesOfCamera);
  if (start.found_before) {
    auto from_there = seen_places(*stated.rays, *start.found_before, stated.rig.points, kPlacesOfCamera);
    // From within a wall, or above the ceiling, it would see little.
    if (2 * from_there.size() >= places.size())
      places = std::move(from_there);
    else
      start.found_before.reset();
  }
  if (places.empty()) return refusal(fmt::format("camera \"{}\" sees no matt surface to measure light on", name));
  auto session = session_of(with_places(stated.rig, places));
  if (!session) return refusal(session.error().front().text());
  return CameraView{static_cast<std::size_t>(named - cameras.begin()), start, std::move(places),
                    std::make_unique<const Session>(std::move(*session)),
                    CameraInstrument(stated.rig, stated.scene.materials.size(), priors)};
}

Result<MeasuredByCamera> measure_by_camera(const Session& stated, const CameraView& view, DaemonRig& daemon,
                                           std::span<const double> brightest, std::vector<LampCurve>& curves,
                                           const std::stop_token& stop) {
  const Rig& rig = stated.rig;
  const PictureCamera& camera = rig.cameras[view.camera];
  auto eye = camera_eye(rig, view.camera, daemon.sim_control());
  if (!eye) return tl::unexpected(eye.error());
  CameraRun run(rig, *stated.rays, view.start, view.places, brightest, curves);
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
      "Camera \"{}\" shows edges of the room {:.1f} px off where {} it; where it is now found to be, {:.1f} px, and "
      "places to {:.1f} px.\n",
      camera.name, found.stated_off_px, run.found_as_before() ? "the last calibration found" : "the rig file has",
      found.off_px, found.standard_error_px);
  curves = run.curves();
  return MeasuredByCamera{run.readings(view.instrument, rig.points.size()), found, run.overflow()};
}

void put_cameras(const Rig& rig, const CameraView* view, const MeasuredByCamera* measured, const RigLight& light,
                 const Calibration* before, Calibration& found) {
  if (view && measured) {
    CalibratedCamera camera;
    camera.name = rig.cameras[view->camera].name;
    put_view(view->start.stated, measured->found.camera, measured->found.covariance, camera);
    view->instrument.put(rig, light.known(), camera);
    found.cameras.push_back(std::move(camera));
  }
  if (!before) return;
  for (const CalibratedCamera& camera : before->cameras)
    if (std::none_of(found.cameras.begin(), found.cameras.end(),
                     [&](const auto& one) { return one.name == camera.name; }))
      found.cameras.push_back(camera);
}

std::string budget_words(const Rig& rig, const CameraView& view, const RigLight& light, const Eigen::VectorXd& level) {
  const auto budget = view.instrument.of_goals(rig, light.known(), level);
  std::string words;
  for (const CameraBudgetPart& part : kCameraBudgetParts)
    if (budget && *budget.*part.share >= 0.005)
      words += fmt::format("{}{} {:.0f} %", words.empty() ? "" : ", ", part.words, 100 * (*budget.*part.share));
  return words;
}

Result<LuxMap> lux_map_of(const Session& stated, const CameraView& view, const Camera& camera, const RigLight& light,
                          std::span<const LampCurve> curves, std::span<const double> level, const Calibration& found,
                          const ComputeOptions& compute) {
  const auto refuse = [](const std::vector<Problem>& problems) { return refusal(problems.front().text()); };
  auto rig = calibrated(stated.rig, found, "what was found");
  if (!rig) return refuse(rig.error());
  const auto session = session_of(std::move(*rig));
  if (!session) return refuse(session.error());
  const LampShares shares = lamp_shares(light.known(), curves, level, usual_priors(stated.rig).dimmer_exponent);
  LuxMap map;
  map.camera = stated.rig.cameras[view.camera].name;
  for (std::size_t f = 0; f < level.size(); ++f)
    if (const double share = shares.share[static_cast<Eigen::Index>(f)]; share > 0)
      map.shares.emplace_back(stated.rig.fixtures[f].name, share);
  map.places = map_places(stated.rig, light, camera, view.places, view.points().front(), shares);
  const auto pictures = map_pictures(*session, camera, map.places, shares.share, compute.of_part());
  if (!pictures) return tl::unexpected(pictures.error());
  map.lux_png = false_colour_png(pictures->lux, "light", {});
  map.error_png = false_colour_png(pictures->error_percent, "standard error, of the light", {"± %", 1.5, {}});
  return map;
}

}  // namespace luxrig
