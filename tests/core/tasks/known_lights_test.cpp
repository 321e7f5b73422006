// Light that a calibration found at points takes the place of what is traced, for as long as the room is the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/estimation/calibration.h"
#include "core/tasks/rig_version.h"
#include "tests/core/tasks/tasks_fixture.h"

namespace luxrig {
namespace {

using tasks_fixture::opened;
using tasks_fixture::room_folder;
using tasks_fixture::room_text;

/// spot-1 and head-1 at two points; of the rig as it was found to be.
Calibration measured(const Rig& rig) {
  Calibration found;
  found.rig = rig.name;
  found.made = "2026-11-28T06:12:00Z";
  for (const char* name : {"spot-1", "head-1"}) {
    CalibratedFixture lamp;
    lamp.name = name;
    lamp.output = {1.1, 0.02};
    lamp.offset_m = {0.03, 0, 0};
    found.fixtures.push_back(lamp);
    found.lights.push_back({"plinth-top", name, {333, 7}});
    found.lights.push_back({"floor", name, {44, 6}});
  }
  const auto session = session_of(*calibrated(rig, found, "c.json"));
  EXPECT_TRUE(session && session->rig.known_lights.empty()) << "nothing says what they are of";
  found.as_found = version_of(session->rig, session->scene).light;
  return found;
}

Session calibrated_session(const std::string& text, const Calibration& found) {
  auto rig = parse_rig(text, room_folder() / "rig.toml", room_folder());
  auto session = session_of(*calibrated(*rig, found, "c.json"));
  EXPECT_TRUE(session);
  return std::move(*session);
}

TEST(KnownLights, TakeThePlaceOfWhatIsTraced) {
  const Calibration found = measured(opened(room_text()).rig);
  const Session session = calibrated_session(room_text(), *calibration_from_json(to_json(found), "c.json"));
  const Rig& rig = session.rig;
  ASSERT_EQ(rig.known_lights.size(), 2u) << "the head's light is elsewhere once it turns";
  const TransportMatrix light = transport_of(session, {});
  const auto row = [&](const std::string& name) {
    return std::find_if(rig.points.begin(), rig.points.end(), [&](const Point& point) { return point.name == name; }) -
           rig.points.begin();
  };
  const auto points = static_cast<Eigen::Index>(rig.points.size());
  EXPECT_NEAR(light.lux_per_level(row("plinth-top"), 0), 333, 1e-9);
  EXPECT_NEAR(light.lux_per_level(points, 0), 333, 1e-9) << "the luxmeter there";
  EXPECT_NEAR(light.lux_per_level(row("floor"), 0), 44, 1e-9);
  EXPECT_LT(light.direct_lux_per_level(row("floor"), 0), 44);
  EXPECT_NE(light.lux_per_level(row("floor"), 1), 44);
  const LightModel model = light_model(session, light);
  // Each point's error is its own: what is not of the lamp's output, which all have in common.
  const auto total = [&](const std::string& name) {
    const double lux = model.point_lux_per_level(row(name), 0);
    return std::hypot(lux * model.gain_sd[0], lux * model.local_sd[0], model.point_known_error(row(name), 0));
  };
  EXPECT_NEAR(total("floor"), 6, 1e-9);
  EXPECT_NEAR(total("plinth-top"), std::hypot(333 * 0.02 / 1.1, 333 * 0.0105), 0.2);
  EXPECT_EQ(model.point_known_error(row("floor"), 1), 0);
}

TEST(KnownLights, AreOutdatedOnceTheRoomIsAnother) {
  const Calibration found = measured(opened(room_text()).rig);
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"reflectance = 0.6", "reflectance = 0.5"},
           {"position_m = [1.0, 0.5, 0.0]", "position_m = [1.0, 0.4, 0.0]"}}) {
    const Session session = calibrated_session(replaced(room_text(), from, to), found);
    EXPECT_TRUE(session.rig.known_lights.empty()) << to;
    ASSERT_FALSE(session.rig.notes.empty());
    EXPECT_NE(session.rig.notes.back().text().find("calibrate again"), std::string::npos);
  }
  // A goal is none of the light.
  const Session session = calibrated_session(replaced(room_text(), "goal_lx = 120", "goal_lx = 130"), found);
  EXPECT_EQ(session.rig.known_lights.size(), 2u);
}

}  // namespace
}  // namespace luxrig
