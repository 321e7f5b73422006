#include "core/calibration/calibration_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/calibration/lamp_steps.h"
#include "core/output/dimming.h"

namespace luxrig {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Json = nlohmann::json;

/// A goal's light that is known no better than this is told of: a usual tolerance.
constexpr double kWellKnown = 0.05;
constexpr std::size_t kMostToSettle = 3;

std::string place_name(const Rig& rig, std::size_t receiver) {
  if (receiver < rig.points.size()) return rig.points[receiver].name;
  return rig.luxmeters[receiver - rig.points.size()].name;
}

/// Of the one lamp that is lit in it.
std::string light_words(const Rig& rig, const VectorXd& level) {
  Index brightest = 0;
  level.maxCoeff(&brightest);
  const auto lamp = static_cast<std::size_t>(brightest);
  return words_of({lamp, level_of_share(rig.fixtures[lamp].measured_curve, level[brightest])}, rig);
}

void tell_what_is_missing(const Calibration& found, const LightUnknowns& known, CalibrationReport& report) {
  for (std::size_t f = 0; f < found.fixtures.size(); ++f) {
    const CalibratedFixture& fixture = found.fixtures[f];
    if (fixture.output.standard_error > 0 && known.read_at(f) < 1)
      report.not_found.push_back(fmt::format(
          "The output of \"{}\" is that of its light at level {:.2f}, where it was read. At full light it may be "
          "another: that depends on its dimmer.",
          fixture.name, known.read_at(f)));
    if (!(fixture.output.standard_error > 0))
      report.not_found.push_back(fmt::format(
          "No reading told how bright \"{}\" is. Its light is taken as the rig file has it.", fixture.name));
    else if (fixture.curve.empty())
      report.not_found.push_back(fmt::format(
          "The dimmer curve of \"{}\" was not measured. Between dark and full the maker's is taken.", fixture.name));
  }
  std::size_t poorly = 0;
  const CalibrationReport::Goal* worst = nullptr;
  for (const CalibrationReport::Goal& goal : report.goals) {
    if (goal.found.share_of_error() <= kWellKnown) continue;
    ++poorly;
    if (!worst || goal.found.share_of_error() > worst->found.share_of_error()) worst = &goal;
  }
  if (worst)
    report.not_found.push_back(fmt::format(
        "The light at {} of {} goals is not known to {:.0f} % (one standard error). The worst is \"{}\": {:.0f} %.",
        poorly, report.goals.size(), 100 * kWellKnown, worst->point, 100 * worst->found.share_of_error()));
  for (const CalibrationReport::Reading& reading : report.readings)
    if (std::abs(reading.in_errors) > kOddReading)
      report.not_found.push_back(fmt::format(
          "With {}, \"{}\" read {:.1f} lx, where {:.1f} lx are explained. It counted little: somebody in the "
          "light, or something that is not in the scene.",
          reading.light, reading.at, reading.lux, reading.explained_lx));
}

Json pair_of(double value, double error) { return Json::array({value, error}); }

Json vector_of(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json json_of(const CalibrationReport::SeenBy& seen) {
  Json json;
  json["name"] = seen.camera;
  json["full_pixels"] = seen.overflow.pixel_share;
  json["places"] = seen.overflow.places;
  json["places_left_out"] = seen.overflow.full_places;
  return json;
}

Json json_of(const LuxMap& map) {
  Json json;
  json["camera"] = map.camera;
  json["light"] = map.light;
  json["share_of_full_light"] = Json::object();
  for (const auto& [fixture, share] : map.shares) json["share_of_full_light"][fixture] = share;
  json["places"] = Json::array();
  for (const LuxMap::Place& place : map.places) {
    Json entry;
    if (!place.point.empty()) entry["point"] = place.point;
    entry["position_m"] = vector_of(place.position_world_m);
    entry["normal"] = vector_of(place.normal_world);
    entry["at_px"] = Json::array({place.x_px, place.y_px});
    entry["lux"] = place.light.lux;
    entry["standard_error_lx"] = place.light.standard_error_lx;
    json["places"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace

CalibrationReport report_of(const Session& session, const RigLight& before, const RigLight& now, Calibration found,
                            double level, std::span<const std::size_t> no_points) {
  const Rig& rig = session.rig;
  CalibrationReport report;
  report.level = level;
  const VectorXd of_use = VectorXd::Constant(static_cast<Index>(rig.fixtures.size()), level);
  for (std::size_t p = 0; p < rig.points.size(); ++p)
    if (rig.points[p].goal_lx)
      report.goals.push_back({rig.points[p].name, before.known().at(p, of_use), now.known().at(p, of_use)});
  const std::vector<LightReading>& readings = now.known().readings();
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const LightReading& reading = readings[k];
    const double in_errors = now.known().surprise()[k];
    report.readings.push_back({light_words(rig, reading.level), place_name(rig, reading.receiver), reading.lux,
                               reading.lux - in_errors * reading.standard_error_lx, in_errors});
  }
  tell_what_is_missing(found, now.known(), report);
  for (const std::size_t p : now.places_to_measure(of_use, kMostToSettle, no_points))
    report.to_settle.push_back(rig.points[p].name);
  report.found = std::move(found);
  return report;
}

std::string to_json(const CalibrationReport& report) {
  Json json;
  json["luxrig_calibration_report"] = 2;
  json["rig"] = report.found.rig;
  json["made"] = report.found.made;
  json["by"] = report.by;
  json["level"] = report.level;
  json["goals"] = json["readings"] = Json::array();
  for (const auto& goal : report.goals)
    json["goals"].push_back({{"point", goal.point},
                             {"stated_lx", pair_of(goal.stated.lux, goal.stated.standard_error_lx)},
                             {"found_lx", pair_of(goal.found.lux, goal.found.standard_error_lx)}});
  for (const auto& reading : report.readings)
    json["readings"].push_back({{"light", reading.light},
                                {"at", reading.at},
                                {"lux", reading.lux},
                                {"explained_lx", reading.explained_lx},
                                {"in_errors", reading.in_errors}});
  json["not_found"] = report.not_found;
  json["to_settle"] = report.to_settle;
  for (const CalibrationReport::SeenBy& seen : report.seen) json["cameras"].push_back(json_of(seen));
  if (report.variance)
    for (const CameraBudgetPart& part : kCameraBudgetParts)
      json["share_of_variance"][part.key] = *report.variance.*part.share;
  for (const LuxMap& map : report.maps) json["maps"].push_back(json_of(map));
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace luxrig
