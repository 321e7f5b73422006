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

/// Places of all cameras that are no points of the rig; more teach little, and their light has to be traced.
constexpr int kPlacesOfCameras = 80;

/// A lamp is not photographed by a camera that sees less than this share of the light that another sees of it.
constexpr double kTellsLittle = 0.03;

/// A lamp has come to rest so long after its level has been sent.
constexpr double kLampSettles_s = 0.3;

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

/// most: places that are no points of the rig. first_point: of its places.
Result<CameraView> view_of_named(const Session& stated, const std::string& name, const Calibration* before, int most,
                                 std::size_t first_point, LightPriors& priors) {
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
  std::vector<SeenPlace> places = seen_places(*stated.rays, start.stated, stated.rig.points, most);
  if (start.found_before) {
    auto from_there = seen_places(*stated.rays, *start.found_before, stated.rig.points, most);
    // From within a wall, or above the ceiling, it would see little.
    if (2 * from_there.size() >= places.size())
      places = std::move(from_there);
    else
      start.found_before.reset();
  }
  if (places.empty())
    return refusal(fmt::format(
        "camera \"{}\" sees no matt surface to measure light on; aim it at one in the rig file, and in the room",
        name));
  return CameraView{static_cast<std::size_t>(named - cameras.begin()), start, std::move(places), first_point,
                    CameraInstrument(stated.rig, stated.scene.materials.size(), priors)};
}

/// A camera at work.
struct Photographing {
  const CameraView& view;
  std::vector<bool> sees;  ///< per fixture: a picture of this lamp alone would tell something
  std::unique_ptr<CameraEye> eye;
  CameraRun run;
  std::optional<Fault> refused;  ///< why it was not found
};

/// Per camera: Photographing::sees.
std::vector<std::vector<bool>> seen_lamps(const CameraViews& views, const Eigen::MatrixXd& stated_lux) {
  using Eigen::Index;
  Eigen::MatrixXd brightest = Eigen::MatrixXd::Zero(static_cast<Index>(views.each.size()), stated_lux.cols());
  for (std::size_t k = 0; k < views.each.size(); ++k)
    brightest.row(static_cast<Index>(k)) =
        stated_lux
            .middleRows(static_cast<Index>(views.each[k].first_point), static_cast<Index>(views.each[k].places.size()))
            .colwise()
            .maxCoeff();
  std::vector<std::vector<bool>> sees;
  for (std::size_t k = 0; k < views.each.size(); ++k) {
    sees.emplace_back();
    for (Index f = 0; f < stated_lux.cols(); ++f)
      sees.back().push_back(brightest(static_cast<Index>(k), f) >= kTellsLittle * brightest.col(f).maxCoeff());
  }
  return sees;
}

std::string words_of(const Photographing& one, const Rig& rig) {
  const std::string& name = rig.cameras[one.view.camera].name;
  if (one.refused) return fmt::format("Camera \"{}\" is left out: {}.", name, one.refused->detail);
  const FoundCamera& found = *one.run.found();
  return fmt::format(
      "Camera \"{}\" shows edges of the room {:.1f} px off where {} it; where it is now found to be, {:.1f} px, and "
      "places to {:.1f} px.",
      name, found.stated_off_px, one.run.found_as_before() ? "the last calibration found" : "the rig file has",
      found.off_px, found.standard_error_px);
}

}  // namespace

std::vector<std::size_t> CameraViews::points() const {
  std::size_t places = 0;
  for (const CameraView& view : each) places += view.places.size();
  std::vector<std::size_t> points(places);
  if (session) std::iota(points.begin(), points.end(), session->rig.points.size() - places);
  return points;
}

std::vector<const CameraInstrument*> CameraViews::instruments() const {
  std::vector<const CameraInstrument*> instruments;
  for (const CameraView& view : each) instruments.push_back(&view.instrument);
  return instruments;
}

Result<CameraViews> camera_views(const Session& stated, std::span<const std::string> names, const Calibration* before,
                                 LightPriors& priors) {
  CameraViews views;
  std::vector<SeenPlace> all;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto before_it = names.first(k);
    if (std::find(before_it.begin(), before_it.end(), names[k]) != before_it.end())
      return refusal(fmt::format("camera \"{}\" is named twice: name each camera once", names[k]));
    auto view = view_of_named(stated, names[k], before, kPlacesOfCameras / static_cast<int>(names.size()),
                              stated.rig.points.size() + all.size(), priors);
    if (!view) return tl::unexpected(view.error());
    all.insert(all.end(), view->places.begin(), view->places.end());
    views.each.push_back(std::move(*view));
  }
  auto session = session_of(with_places(stated.rig, all));
  if (!session) return refusal(session.error().front().text());
  views.session = std::make_unique<const Session>(std::move(*session));
  return views;
}

Result<MeasuredByCameras> measure_by_cameras(const Session& stated, const CameraViews& views,
                                             const Eigen::MatrixXd& stated_lux, DaemonRig& daemon,
                                             std::span<const double> brightest, std::vector<LampCurve>& curves,
                                             const std::stop_token& stop) {
  std::vector<Photographing> all;
  for (auto& sees : seen_lamps(views, stated_lux)) {
    const CameraView& view = views.each[all.size()];
    auto eye = camera_eye(stated.rig, view.camera, daemon.sim_control());
    if (!eye) return tl::unexpected(eye.error());
    all.push_back({view,
                   std::move(sees),
                   std::move(*eye),
                   {stated.rig, *stated.rays, view.start, view.places, brightest, curves},
                   {}});
  }
  const Progress progress = progress_line("photographing");
  std::vector<Photographing*> left;
  for (Photographing& one : all) left.push_back(&one);
  while (const auto level = left.front()->run.next()) {
    const CameraRun& first = left.front()->run;
    if (progress) progress(static_cast<double>(first.done()) / static_cast<double>(first.steps()));
    const std::string words = first.words_of_next();
    const auto during = [&](const Fault& fault) {
      return tl::unexpected(Fault{fault.cause, "", words + ": " + fault.detail, {}});
    };
    const auto sent = daemon.light(*level, stop);
    if (!sent) return during(sent.error());
    if (const auto watched = daemon.watch(kLampSettles_s, stop); !watched) return during(watched.error());
    const auto lamp = first.lamp_of_next();
    for (Photographing* const one : left) {
      if (lamp && !one->sees[*lamp]) {
        one->run.skip(*sent);
        continue;
      }
      const auto picture = look_while_held(*one->eye, daemon, stop);
      if (!picture) return during(picture.error());
      if (auto taken = one->run.take(*sent, *picture); !taken) one->refused = taken.error();
    }
    const Fault last_refusal = left.back()->refused.value_or(Fault{});
    std::erase_if(left, [](const Photographing* one) { return one->refused.has_value(); });
    if (left.empty()) return during(last_refusal);
  }
  for (std::size_t f = 0; f < curves.size(); ++f)
    for (const Photographing* const one : left)
      if (curves[f].of_level.empty()) curves[f] = one->run.curves()[f];
  MeasuredByCameras measured;
  for (const Photographing& one : all) {
    fmt::print("{}\n", words_of(one, stated.rig));
    measured.each.emplace_back();
    if (one.refused) continue;
    measured.each.back() = MeasuredByCamera{*one.run.found(), one.run.overflow()};
    auto readings = one.run.readings(one.view.instrument, one.view.first_point, curves);
    measured.readings.insert(measured.readings.end(), std::make_move_iterator(readings.begin()),
                             std::make_move_iterator(readings.end()));
  }
  return measured;
}

void put_cameras(const Rig& rig, const CameraViews& views, const MeasuredByCameras& measured, const RigLight& light,
                 const Calibration* before, Calibration& found) {
  for (std::size_t k = 0; k < measured.each.size(); ++k) {
    if (!measured.each[k]) continue;
    const CameraView& view = views.each[k];
    CalibratedCamera camera;
    camera.name = rig.cameras[view.camera].name;
    put_view(view.start.stated, measured.each[k]->found.camera, measured.each[k]->found.covariance, camera);
    view.instrument.put(rig, light.known(), camera);
    found.cameras.push_back(std::move(camera));
  }
  if (!before) return;
  for (const CalibratedCamera& camera : before->cameras)
    if (std::none_of(found.cameras.begin(), found.cameras.end(),
                     [&](const auto& one) { return one.name == camera.name; }))
      found.cameras.push_back(camera);
}

std::string budget_words(const std::optional<CameraBudget>& budget) {
  std::string words;
  for (const CameraBudgetPart& part : kCameraBudgetParts)
    if (budget && *budget.*part.share >= 0.005)
      words += fmt::format("{}{} {:.0f} %", words.empty() ? "" : ", ", part.words, 100 * (*budget.*part.share));
  return words;
}

Result<std::vector<LuxMap>> lux_maps_of(const Session& stated, const CameraViews& views,
                                        const MeasuredByCameras& measured, const RigLight& light,
                                        std::span<const LampCurve> curves, std::span<const double> level,
                                        const Calibration& found, const ComputeOptions& compute) {
  const auto refuse = [](const std::vector<Problem>& problems) { return refusal(problems.front().text()); };
  auto rig = calibrated(stated.rig, found, "what was found");
  if (!rig) return refuse(rig.error());
  const auto session = session_of(std::move(*rig));
  if (!session) return refuse(session.error());
  const LampShares shares = lamp_shares(light.known(), curves, level, usual_priors(stated.rig).dimmer_exponent);
  std::vector<LuxMap> maps;
  for (std::size_t k = 0; k < measured.each.size(); ++k) {
    if (!measured.each[k]) continue;
    const CameraView& view = views.each[k];
    const Camera& camera = measured.each[k]->found.camera;
    LuxMap map;
    map.camera = stated.rig.cameras[view.camera].name;
    for (std::size_t f = 0; f < level.size(); ++f)
      if (const double share = shares.share[static_cast<Eigen::Index>(f)]; share > 0)
        map.shares.emplace_back(stated.rig.fixtures[f].name, share);
    map.places = map_places(stated.rig, light, camera, view.places, view.first_point, shares);
    const auto pictures = map_pictures(*session, camera, map.places, shares.share, compute.of_part());
    if (!pictures) return tl::unexpected(pictures.error());
    map.lux_png = false_colour_png(pictures->lux, "light", {});
    map.error_png = false_colour_png(pictures->error_percent, "standard error, of the light", {"± %", 1.5, {}});
    maps.push_back(std::move(map));
  }
  return maps;
}

}  // namespace luxrig
