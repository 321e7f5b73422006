#include "tools/luxrigd/api/room_view.h"

#include <nlohmann/json.hpp>

#include "core/picture/picture.h"
#include "core/tasks/rig_notes/rig_notes.h"
#include "tools/luxrig/addresses.h"
#include "tools/luxrig/vector_json.h"
#include "tools/luxrigd/api/status_parts.h"
#include "tools/terminal/picture_png.h"

namespace luxrig {
namespace {

constexpr int kLongestSide_px = 900;

using nlohmann::json;

json box_json(const Eigen::AlignedBox3d& box) { return {{"min", array_of(box.min())}, {"max", array_of(box.max())}}; }

json fixture_json(const Rig& rig, const Fixture& fixture) {
  json out = fixed_of(rig, fixture);
  out["max_level"] = rig.max_level(fixture);
  if (fixture.switched) out["switched"] = true;
  if (fixture.park) out["parks"] = true;
  if (fixture.moves) {
    out["pan_range_deg"] = {deg_from_rad(fixture.range.pan_min_rad), deg_from_rad(fixture.range.pan_max_rad)};
    out["tilt_range_deg"] = {deg_from_rad(fixture.range.tilt_min_rad), deg_from_rad(fixture.range.tilt_max_rad)};
  }
  // Columns: the mount's x, y and z in the world.
  json& turned = out["mount_axes"] = json::array();
  for (int column = 0; column < 3; ++column) turned.push_back(array_of(fixture.world_from_mount.rotation.col(column)));
  return out;
}

json point_json(const Rig& rig, const Point& point) {
  json out = fixed_of(rig, point);
  out["weight"] = point.weight;
  if (point.goal_lx) out["goal_lux"] = *point.goal_lx;
  return out;
}

json luxmeter_json(const Rig& rig, const Luxmeter& meter) {
  json out = fixed_of(rig, meter);
  out["normal"] = array_of(meter.normal_world);
  return out;
}

json luminaire_json(const Luminaire& luminaire) {
  json out = {{"name", luminaire.name}, {"lumens", luminaire.lumens}, {"colour_rgb", array_of(luminaire.colour_rgb)}};
  if (luminaire.watts) out["watts"] = *luminaire.watts;
  if (luminaire.beam_angle_rad > 0) {
    out["beam_angle_deg"] = deg_from_rad(luminaire.beam_angle_rad);
    out["field_angle_deg"] = deg_from_rad(luminaire.field_angle_rad);
  }
  return out;
}

json camera_json(const PictureCamera& camera) {
  return {{"name", camera.name},
          {"position", array_of(camera.position_world_m)},
          {"aim", array_of(camera.aim_world_m)},
          {"vertical_fov_deg", deg_from_rad(camera.vertical_fov_rad)},
          {"width_px", camera.width_px},
          {"height_px", camera.height_px}};
}

json bus_json(const Bus& bus) {
  json out = {{"name", bus.name}, {"driver", bus.driver}};
  if (const std::string where = bus_address(bus); !where.empty()) out["address"] = where;
  return out;
}

/// `room`: the answer to GET /api/room.
json rig_json(const Session& session, const json& room) {
  const Rig& rig = session.rig;
  const Scene& scene = session.scene;
  json out = room;
  const auto put = [&](const char* key, const auto& list, auto&& one_json) {
    json& into = out[key] = json::array();
    for (const auto& one : list) into.push_back(one_json(one));
  };
  put("buses", rig.buses, bus_json);
  put("luminaires", rig.luminaires, luminaire_json);
  put("fixtures", rig.fixtures, [&](const Fixture& fixture) { return fixture_json(rig, fixture); });
  put("points", rig.points, [&](const Point& point) { return point_json(rig, point); });
  put("luxmeters", rig.luxmeters, [&](const Luxmeter& meter) { return luxmeter_json(rig, meter); });
  put("cameras", rig.cameras, camera_json);
  put("materials", scene.materials, [](const Material& material) {
    return json{{"name", material.name}, {"reflectance_rgb", array_of(material.reflectance_rgb)}};
  });
  out["triangles"] = scene.triangles.size();
  if (!scene.triangles.empty()) out["scene"] = "/api/scene";
  return out;
}

}  // namespace

RoomView draw_room(const Session& session) {
  auto box = room_of(session.rig, session.scene);
  RoomView view;
  json room = {{"name", session.rig.name}};
  if (!session.scene.triangles.empty()) {
    const PlanView plan = render_plan_view(*session.rays, kLongestSide_px, std::nullopt, 0, box);
    view.png = plan_view_png(plan);
    const double right = plan.left_x_world_m + plan.width_px * plan.metres_per_px;
    const double bottom = plan.top_y_world_m - plan.height_px * plan.metres_per_px;
    room["plan"] = {
        {"url", "/api/room.png"}, {"min", {plan.left_x_world_m, bottom}}, {"max", {right, plan.top_y_world_m}}};
  }
  for (const Fixture& fixture : session.rig.fixtures) box.extend(fixture.world_from_mount.translation_m);
  for (const Point& point : session.rig.points) box.extend(point.position_world_m);
  if (box.isEmpty()) box.extend(Vec3::Zero());
  room["bounds"] = box_json(box);
  const auto text_of = [](const json& value) { return value.dump(-1, ' ', false, json::error_handler_t::replace); };
  view.json = text_of(room);
  view.rig = std::make_shared<KeptAnswer>(kept_answer("application/json", text_of(rig_json(session, room))));
  return view;
}

}  // namespace luxrig
