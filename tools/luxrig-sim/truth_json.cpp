#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/luxrig-sim/control_http.h"

namespace luxrig::sim {

std::string truth_json(const Rig& rig, const World& world, Faults& faults, const InTheLight& in_the_light) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["time_s"] = to_seconds(world.now() - Time{});
  json["points"] = Json::array();
  const std::vector<PointTruth> points = world.points();
  for (std::size_t p = 0; p < points.size(); ++p) {
    Json point = {{"name", rig.points[p].name}, {"lux", points[p].lux}, {"max_lux_seen", points[p].max_lux_seen}};
    if (rig.points[p].max_lx) point["max_lux"] = *rig.points[p].max_lx;
    if (in_the_light.shade[p] != 1) point["shade"] = in_the_light.shade[p];
    json["points"].push_back(std::move(point));
  }
  json["luxmeters"] = Json::array();
  const std::vector<PointTruth> meters = world.luxmeters();
  for (std::size_t m = 0; m < meters.size(); ++m) {
    const double reading_lx = world.meter_reading_lx(m);
    json["luxmeters"].push_back({{"name", rig.luxmeters[m].name},
                                 {"lux", meters[m].lux},
                                 {"max_lux_seen", meters[m].max_lux_seen},
                                 {"reading", reading_lx},
                                 {"shown", faults.shown_lx(rig.luxmeters[m].name, reading_lx)},
                                 {"gain", world.meter_gains()[m]}});
    if (in_the_light.cover[m] != 1) json["luxmeters"].back()["cover"] = in_the_light.cover[m];
  }
  json["fixtures"] = Json::array();
  const std::vector<double> drives = world.drives(), levels = world.levels();
  const std::vector<Joints> joints = world.joints();
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    Json fixture = {{"name", rig.fixtures[f].name},
                    {"drive", drives[f]},
                    {"level", levels[f]},
                    {"output", world.fixtures()[f].output},
                    {"curve_exponent", world.fixtures()[f].curve_exponent}};
    if (rig.fixtures[f].moves) {
      fixture["pan_deg"] = deg_from_rad(joints[f].pan_rad);
      fixture["tilt_deg"] = deg_from_rad(joints[f].tilt_rad);
      const Pose lamp = true_lamp(world.fixtures()[f], joints[f], rig.fixtures[f].roll_rad);
      const Vec3 along = lamp.direction(-Vec3::UnitZ());
      fixture["beam_from"] = {lamp.translation_m.x(), lamp.translation_m.y(), lamp.translation_m.z()};
      fixture["beam_along"] = {along.x(), along.y(), along.z()};
      if (rig.fixtures[f].range.zooms()) fixture["beam_angle_deg"] = deg_from_rad(joints[f].beam_rad);
    }
    json["fixtures"].push_back(std::move(fixture));
  }
  json["violations"] = Json::array();
  for (const Violation& violation : world.violations()) {
    json["violations"].push_back({{"point", rig.points[violation.point].name},
                                  {"max_lux", violation.max_lx},
                                  {"lux", violation.lux},
                                  {"time_s", to_seconds(violation.began - Time{})}});
  }
  if (rig.daylight) json["daylight"] = in_the_light.daylight;
  json["faults"] = Json::array();
  for (const FaultOn& fault : faults.all_on()) {
    Json on = {{"device", fault.device}, {"fault", name_of(fault.kind)}};
    if (range_of(fault.kind).valued) on["value"] = fault.value;
    json["faults"].push_back(std::move(on));
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace luxrig::sim
