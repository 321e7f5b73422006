#include "core/calibration/camera_instrument.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace luxrig {
namespace {

using Eigen::Index;

constexpr std::size_t kLens = 3, kFlare = 0, kHalo = 1;
/// A place says nothing of a lamp that gives it less than this of its brightest: there stray light rules.
constexpr double kSeen = 0.02;
constexpr double kDarkest_lx = 0.05;
/// A response's error over that before anything was measured: above, readings have told nothing.
constexpr double kToldNothing = 0.9;

void append(Eigen::VectorXd& values, std::size_t count, double value) {
  const auto more = static_cast<Index>(count);
  values.conservativeResize(values.size() + more);
  values.tail(more).setConstant(value);
}

}  // namespace

CameraInstrument::CameraInstrument(const Rig& rig, std::size_t materials, LightPriors& priors,
                                   const CameraPriors& usual)
    : usual_(usual),
      first_paint_(static_cast<std::size_t>(priors.log_meter.size())),
      first_lens_(first_paint_ + materials),
      first_response_(first_lens_ + kLens),
      responses_(rig.luminaires.size()),
      first_stray_(static_cast<std::size_t>(priors.stray.size())) {
  append(priors.log_meter, materials, usual.log_paint);
  for (const double lens : usual.lens) append(priors.log_meter, 1, lens);
  append(priors.log_meter, responses_, usual.log_response);
  append(priors.stray, 1, usual.flare);
  append(priors.stray, 1, usual.halo);
  for (const Fixture& fixture : rig.fixtures) of_lamp_.push_back(response_to(fixture.luminaire));
}

Showing CameraInstrument::showing(const SeenPlace& place, const SeenLight& light, int width_px, int height_px) const {
  Showing showing;
  const double aside = 2 * place.x_px / width_px - 1, down = 2 * place.y_px / height_px - 1;
  const double width2 = static_cast<double>(width_px) * width_px, height2 = static_cast<double>(height_px) * height_px;
  const double rho2 = (aside * aside * width2 + down * down * height2) / (width2 + height2);
  double power = 1;
  for (std::size_t k = 0; k < kLens; ++k) showing.factors.push_back({first_lens_ + k, -(power *= rho2)});
  showing.of_lamp = of_lamp_;
  showing.paint = place.material;
  showing.stray = {{first_stray_ + kFlare, light.veil_lx}, {first_stray_ + kHalo, light.halo_lx}};
  return showing;
}

std::vector<LightReading> CameraInstrument::readings(std::span<const std::optional<SeenPlace>> places,
                                                     std::span<const std::optional<SeenLight>> light, int width_px,
                                                     int height_px, std::size_t first_receiver,
                                                     const Eigen::VectorXd& level) const {
  LUXRIG_CHECK(places.size() == light.size(), "light of {} places at {}", light.size(), places.size());
  double brightest = 0;
  for (const auto& seen : light)
    if (seen) brightest = std::max(brightest, seen->lux);
  std::vector<LightReading> readings;
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (!places[k] || !light[k] || light[k]->lux < kSeen * brightest) continue;
    LightReading reading;
    reading.receiver = first_receiver + k;
    reading.meter = first_paint_ + places[k]->material;
    reading.lux = light[k]->lux;
    reading.standard_error_lx =
        std::hypot(light[k]->standard_error_lx, usual_.place_share * light[k]->lux, kDarkest_lx);
    reading.level = level;
    reading.showing = showing(*places[k], *light[k], width_px, height_px);
    readings.push_back(std::move(reading));
  }
  return readings;
}

double CameraInstrument::lens_share(const LightUnknowns& known, double rho) const {
  double log_loss = 0, power = 1;
  for (std::size_t k = 0; k < kLens; ++k)
    log_loss += (power *= rho * rho) * std::log(known.meter_gain(first_lens_ + k));
  return std::exp(-log_loss);
}

void CameraInstrument::put(const Rig& rig, const LightUnknowns& known, CalibratedCamera& into) const {
  const auto relative_error = [&](std::size_t meter) {
    return known.meter_gain_standard_error(meter) / known.meter_gain(meter);
  };
  for (std::size_t k = 0; k < kLens; ++k)
    into.lens_loss[k] = {std::log(known.meter_gain(first_lens_ + k)), relative_error(first_lens_ + k)};
  into.flare = {known.stray(first_stray_ + kFlare), known.stray_standard_error(first_stray_ + kFlare)};
  into.halo = {known.stray(first_stray_ + kHalo), known.stray_standard_error(first_stray_ + kHalo)};
  into.responses.clear();
  for (std::size_t l = 0; l < responses_; ++l)
    if (const std::size_t meter = response_to(l); relative_error(meter) < kToldNothing * usual_.log_response)
      into.responses.emplace_back(rig.luminaires[l].name,
                                  Known{known.meter_gain(meter), known.meter_gain_standard_error(meter)});
}

CameraBudget budget_of(const LightBudget& budget, std::span<const CameraInstrument* const> cameras) {
  const double all = budget.sum();
  CameraBudget shares;
  if (!(all > 0)) return shares;
  const auto of = [all](const Eigen::VectorXd& parts, std::size_t first, std::size_t count) {
    return parts.segment(static_cast<Index>(first), static_cast<Index>(count)).sum() / all;
  };
  for (const CameraInstrument* const camera : cameras) {
    shares.lens += of(budget.instrument, camera->first_lens_, kLens);
    shares.response += of(budget.instrument, camera->first_response_, camera->responses_);
    shares.reflectance += of(budget.instrument, camera->first_paint_, camera->first_lens_ - camera->first_paint_);
    shares.stray += of(budget.stray, camera->first_stray_, 2);
  }
  shares.reflectance += budget.paint / all;
  shares.lamps = (budget.output + budget.mount) / all;
  shares.noise = budget.noise / all;
  shares.other = 1 - shares.lens - shares.response - shares.reflectance - shares.stray - shares.lamps - shares.noise;
  return shares;
}

std::optional<CameraBudget> budget_of_goals(const Rig& rig, const LightUnknowns& known, const Eigen::VectorXd& level,
                                            std::span<const CameraInstrument* const> cameras) {
  CameraBudget sum;
  double goals = 0;
  for (std::size_t p = 0; p < rig.points.size(); ++p) {
    if (!rig.points[p].goal_lx) continue;
    const CameraBudget shares = budget_of(known.budget(p, level), cameras);
    for (const CameraBudgetPart& part : kCameraBudgetParts) sum.*part.share += shares.*part.share;
    ++goals;
  }
  if (!(goals > 0)) return std::nullopt;
  for (const CameraBudgetPart& part : kCameraBudgetParts) sum.*part.share /= goals;
  return sum;
}

}  // namespace luxrig
