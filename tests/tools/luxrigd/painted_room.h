#pragma once
/// A copy of the smallest rig with a surface goal, for tests of painting.

#include <gtest/gtest.h>

#include <fstream>
#include <thread>

#include "core/goals/painting_file.h"
#include "core/tasks/surface_goals.h"
#include "tests/tools/programs/process.h"
#include "tools/luxrig/open_session.h"
#include "tools/luxrig/painting_files.h"
#include "tools/luxrigd/painted_goals.h"

namespace luxrig::testing {

class PaintedRoomTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::copy(source("tests/rigs/room"), folder_ / "room", std::filesystem::copy_options::recursive);
    append("\n[[surface_goal]]  # on the floor\nname = \"floor\"\nstrokes = \"floor.json\"\npatch_m = 0.2\n");
    ASSERT_TRUE(save_painting(goal(), painting_to_json({}), {}));
    session_ = open();
  }
  [[nodiscard]] std::filesystem::path file(const char* name = "rig.toml") const { return folder_ / "room" / name; }
  void append(const std::string& text) { std::ofstream(file(), std::ios::app) << text; }
  [[nodiscard]] SurfaceGoalSpec goal() const {
    SurfaceGoalSpec spec;
    spec.name = "floor";
    spec.strokes_file = file("floor.json");
    spec.patch_m = 0.2;
    return spec;
  }
  [[nodiscard]] std::shared_ptr<const Session> open() const {
    auto session = open_session(file());
    EXPECT_TRUE(session) << session.error()[0].text();
    return session ? std::make_shared<const Session>(std::move(*session)) : nullptr;
  }
  /// On the floor, so far from its middle.
  [[nodiscard]] SurfacePlace place(double x_m, double y_m) const {
    const auto bounds = session_->rays->bounds_world_m();
    return {{bounds.center().x() + x_m, bounds.center().y() + y_m, bounds.min().z()}, Vec3::UnitZ()};
  }
  [[nodiscard]] Stroke bucket(double lux) const { return {StrokeKind::bucket, {place(0.3, 0.4)}, lux}; }
  [[nodiscard]] Stroke brush(double lux, int places) const {
    Stroke stroke{StrokeKind::brush, {}, lux, 0.4, 0.5};
    for (int i = 0; i < places; ++i) stroke.path.push_back(place(-0.5 + 0.1 * i, 0.1 * (i % 3)));
    return stroke;
  }
  [[nodiscard]] std::unique_ptr<PaintedGoals> goals() const {
    return std::make_unique<PaintedGoals>([this] { return session_; });
  }
  /// Its patches, as soon as they are there.
  static std::string patches_of(PaintedGoals& goals, const std::string& name = "floor") {
    while (true) {
      const auto patches = goals.patches(name);
      if (patches) return (*patches)->body;
      EXPECT_EQ(patches.error().why, PaintingRefusal::Why::not_yet) << patches.error().text;
      if (patches.error().why != PaintingRefusal::Why::not_yet) return {};
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  Folder folder_;
  std::shared_ptr<const Session> session_;
};

}  // namespace luxrig::testing
