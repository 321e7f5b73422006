#include "tools/luxrigd/api/room_view.h"

#include <nlohmann/json.hpp>

#include "core/picture/picture.h"
#include "core/tasks/rig_notes/rig_notes.h"
#include "tools/terminal/picture_png.h"

namespace luxrig {
namespace {

constexpr int kLongestSide_px = 900;

}  // namespace

RoomView draw_room(const Session& session) {
  auto box = room_of(session.rig, session.scene);
  RoomView view;
  nlohmann::json json = {{"name", session.rig.name}};
  if (!session.scene.triangles.empty()) {
    const PlanView plan = render_plan_view(*session.rays, kLongestSide_px, std::nullopt, 0, box);
    view.png = plan_view_png(plan);
    const double right = plan.left_x_world_m + plan.width_px * plan.metres_per_px;
    const double bottom = plan.top_y_world_m - plan.height_px * plan.metres_per_px;
    json["plan"] = {
        {"url", "/api/room.png"}, {"min", {plan.left_x_world_m, bottom}}, {"max", {right, plan.top_y_world_m}}};
  }
  for (const Fixture& fixture : session.rig.fixtures) box.extend(fixture.world_from_mount.translation_m);
  for (const Point& point : session.rig.points) box.extend(point.position_world_m);
  if (box.isEmpty()) box.extend(Vec3::Zero());
  json["bounds"] = {{"min", {box.min().x(), box.min().y(), box.min().z()}},
                    {"max", {box.max().x(), box.max().y(), box.max().z()}}};
  view.json = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return view;
}

}  // namespace luxrig
