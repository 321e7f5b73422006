#include "core/calibration/camera_run.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/output/dimming.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// The dark is photographed anew after so many lamps, as daylight moves.
constexpr std::size_t kLampsPerDarkPicture = 4;
/// To find the camera, every lamp at this share of its brightest.
constexpr double kToLookAround = 0.4;
/// A lamp's curve is read where it is at least this bright, over where it is brightest.
constexpr double kBrightPlace = 0.3;

/// Whether one of a place's pixels is full.
bool touches_full(const SeenPlace& place, const MergedPicture& picture) {
  const auto first = [](double middle_px) { return static_cast<int>(std::floor(middle_px - kPlaceSide_px / 2.0)); };
  for (int y = first(place.y_px); y <= first(place.y_px) + kPlaceSide_px && y < picture.picture.height_px; ++y)
    for (int x = first(place.x_px); x <= first(place.x_px) + kPlaceSide_px && x < picture.picture.width_px; ++x)
      if (picture.full[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.picture.width_px) +
                       static_cast<std::size_t>(x)])
        return true;
  return false;
}

}  // namespace

CameraRun::CameraRun(const Rig& rig, const RayScene& rays, CameraStart start, std::span<const SeenPlace> places,
                     std::span<const double> brightest, std::vector<LampCurve> curves)
    : rig_(&rig),
      rays_(&rays),
      start_(std::move(start)),
      stated_places_(places),
      brightest_(brightest.begin(), brightest.end()),
      curves_(std::move(curves)) {
  LUXRIG_CHECK(brightest_.size() == rig.fixtures.size() && curves_.size() == rig.fixtures.size(),
               "{} levels and {} curves of {} fixtures", brightest_.size(), curves_.size(), rig.fixtures.size());
  std::size_t lamps = 0;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    if (!(brightest_[f] > 0)) continue;
    if (lamps++ % kLampsPerDarkPicture == 0) plan_.push_back({0, 0});
    for (const double share : kCurveShares) {
      plan_.push_back({f, share * brightest_[f]});
      if (rig.fixtures[f].switched || !curves_[f].of_level.empty()) break;
    }
  }
}

std::optional<std::vector<double>> CameraRun::next() const {
  if (!found_) {
    std::vector<double> all;
    for (std::size_t f = 0; f < brightest_.size(); ++f)
      all.push_back(brightest_[f] * (rig_->fixtures[f].switched ? 1 : kToLookAround));
    return all;
  }
  if (taken_.size() >= plan_.size()) return std::nullopt;
  return levels_of(plan_[taken_.size()], *rig_);
}

std::string CameraRun::words_of_next() const {
  if (!found_) return "all lamps together";
  return taken_.size() < plan_.size() ? words_of(plan_[taken_.size()], *rig_) : "";
}

std::optional<std::size_t> CameraRun::lamp_of_next() const {
  if (!found_ || taken_.size() >= plan_.size() || !(plan_[taken_.size()].level > 0)) return std::nullopt;
  return plan_[taken_.size()].fixture;
}

bool CameraRun::first_of_lamp(std::size_t step) const {
  return plan_[step].level > 0 &&
         (step == 0 || !(plan_[step - 1].level > 0) || plan_[step - 1].fixture != plan_[step].fixture);
}

Result<void> CameraRun::look_for_camera(const Picture& picture) {
  auto found = find_camera(*rays_, start_.best(), picture);
  found_as_before_ = found && start_.found_before;
  if (!found && start_.found_before) found = find_camera(*rays_, start_.stated, picture);
  if (!found) return tl::unexpected(found.error());
  found_ = *found;
  places_ = places_by(*rays_, found_->camera, stated_places_);
  return {};
}

std::vector<std::optional<SeenLight>> CameraRun::light_in(const MergedPicture& picture) {
  auto light = seen_light(picture.picture, dark_, places_);
  for (std::size_t p = 0; p < light.size(); ++p) {
    if (!light[p]) continue;
    ++overflow_.places;
    if (picture.full.empty() || !touches_full(*places_[p], picture)) continue;
    ++overflow_.full_places;
    light[p].reset();
  }
  return light;
}

Result<void> CameraRun::take(std::span<const double> sent, const MergedPicture& picture) {
  LUXRIG_CHECK(sent.size() == rig_->fixtures.size(), "levels of {} fixtures", sent.size());
  if (picture.picture.width_px != start_.stated.width_px || picture.picture.height_px != start_.stated.height_px)
    return refusal("a picture of another size than the camera in the rig file");
  if (!found_) return look_for_camera(picture.picture);
  LUXRIG_CHECK(taken_.size() < plan_.size(), "all {} pictures are taken", plan_.size());
  const LampStep& step = plan_[taken_.size()];
  if (step.level > 0) {
    taken_.push_back({sent[step.fixture], light_in(picture)});
    const auto lit = static_cast<double>(++pictures_of_lamps_);
    overflow_.pixel_share += (picture.full_share() - overflow_.pixel_share) / lit;
  } else {
    dark_ = picture.picture;
    taken_.emplace_back();
  }
  find_curves();
  return {};
}

void CameraRun::skip(std::span<const double> sent) {
  const auto lamp = lamp_of_next();
  LUXRIG_CHECK(lamp && sent.size() == rig_->fixtures.size(), "no lamp alone is to be photographed");
  taken_.push_back({sent[*lamp], std::vector<std::optional<SeenLight>>(places_.size())});
  find_curves();
}

void CameraRun::find_curves() {
  if (taken_.size() < plan_.size()) return;
  for (std::size_t k = 0; k < plan_.size(); ++k)
    if (first_of_lamp(k) && curves_[plan_[k].fixture].of_level.empty()) curves_[plan_[k].fixture] = curve_from(k);
}

LampCurve CameraRun::curve_from(std::size_t first) const {
  std::vector<const Taken*> steps;
  for (std::size_t k = first; k < plan_.size() && plan_[k].level > 0 && plan_[k].fixture == plan_[first].fixture; ++k)
    steps.push_back(&taken_[k]);
  const std::vector<std::optional<SeenLight>>& full = taken_[first].light;
  double brightest = 0;
  for (const auto& light : full)
    if (light) brightest = std::max(brightest, light->lux);
  // The same places at each level; some are full in some pictures.
  std::vector<std::size_t> at_all;
  for (std::size_t p = 0; p < full.size(); ++p)
    if (full[p] && full[p]->lux >= kBrightPlace * brightest &&
        std::all_of(steps.begin(), steps.end(), [&](const Taken* step) { return step->light[p].has_value(); }))
      at_all.push_back(p);
  if (at_all.empty()) return {};
  std::vector<ReadAtLevel> read;
  for (const Taken* step : steps) {
    ReadAtLevel at{step->level, {}};
    double variance = 0;
    for (const std::size_t p : at_all) {
      at.light.lux += step->light[p]->lux;
      variance += std::pow(step->light[p]->standard_error_lx, 2);
    }
    at.light.standard_error_lx = std::sqrt(variance);
    read.push_back(at);
  }
  return curve_of(read);
}

std::vector<LightReading> CameraRun::readings(const CameraInstrument& camera, std::size_t first_receiver,
                                              std::span<const LampCurve> curves) const {
  LUXRIG_CHECK(found_ && taken_.size() == plan_.size(), "{} of {} pictures are taken", taken_.size(), plan_.size());
  LUXRIG_CHECK(curves.size() == curves_.size(), "{} curves of {} fixtures", curves.size(), curves_.size());
  std::vector<LightReading> readings;
  for (std::size_t k = 0; k < plan_.size(); ++k) {
    if (!first_of_lamp(k) || !(taken_[k].level > 0)) continue;
    const std::size_t f = plan_[k].fixture;
    const VectorXd level = share_at_level(curves[f].of_level, taken_[k].level) *
                           VectorXd::Unit(static_cast<Index>(rig_->fixtures.size()), static_cast<Index>(f));
    auto of_lamp = camera.readings(places_, taken_[k].light, start_.stated.width_px, start_.stated.height_px,
                                   first_receiver, level);
    readings.insert(readings.end(), std::make_move_iterator(of_lamp.begin()), std::make_move_iterator(of_lamp.end()));
  }
  return readings;
}

}  // namespace luxrig
