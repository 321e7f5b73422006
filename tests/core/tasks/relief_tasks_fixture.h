#pragma once
/// Shared by the tests of relief_tasks.

#include <unistd.h>

#include <cmath>
#include <fstream>

#include "core/tasks/solve_tasks.h"
#include "tests/core/tasks/opened_rigs.h"

namespace luxrig::relief_tasks_fixture {

// A well in a slab, the smallest relief of that kind: 0.6 m wide, its rim at 1.08 m.
inline constexpr int kWellSquares = 24;

inline constexpr double kWellStep_m = 0.025, kWellDepth_m = 0.08, kWellRadius_m = 0.12, kRim_m = 1.08;

inline double well_height_m(double x, double y) {
  return -kWellDepth_m * std::exp(-std::pow(std::hypot(x, y) / kWellRadius_m, 4));
}

inline double well_place_m(int i) { return (i - kWellSquares / 2) * kWellStep_m; }

inline constexpr const char* kWellRig = R"([rig]
name = "well"
[scene]
default_reflectance = 0.5
[[scene.object]]
name = "slab"
file = "well.obj"
up_axis = "z"
position_m = [0, 0, 1]
[[scene.object]]
name = "ceiling"
box_m = [4, 4, 0.1]
position_m = [0, 0, 3]
[[luminaire]]
name = "spot"
model = "spot"
beam_angle_deg = 20
field_angle_deg = 40
lumens = 800
watts = 10
[[luminaire]]
name = "bulb"
model = "isotropic"
lumens = 1000
watts = 10
[[bus]]
name = "dmx"
driver = "sacn"
[[fixture]]
name = "left"
luminaire = "spot"
position_m = [-1.2, 0.3, 2.8]
pan_deg = 0
tilt_deg = 0
bus = "dmx"
address = 1
slots = ["pan", "tilt", "dimmer"]
pan_range_deg = [-200, 200]
tilt_range_deg = [-100, 100]
[[fixture]]
name = "right"
luminaire = "spot"
position_m = [0.9, -0.8, 2.8]
pan_deg = 0
tilt_deg = 0
bus = "dmx"
address = 11
slots = ["pan", "tilt", "dimmer"]
pan_range_deg = [-200, 200]
tilt_range_deg = [-100, 100]
[[point]]
name = "beside"
position_m = [0.35, 0, 1.1]
)";

/// Contrast in lux: relative to darkness, the faint edge of a beam would count as much.
inline constexpr const char* kAim =
    "[[task]]\nname = \"relief\"\nkind = \"aim\"\nobject = \"slab\"\ncontrast = \"lux\"\n";

/// Two lights off the ceiling.
inline constexpr const char* kHighlight =
    "[[task]]\nname = \"detail\"\nkind = \"highlight\"\nluminaire = \"spot\"\nobject = \"slab\"\nlights = 2\n"
    "[mounting]\nsurfaces = [\"ceiling\"]\noffset_m = [0.05, 0.15]\n";

/// "beside" with its own limit.
inline std::string with_limit(const std::string& rig, double max_lx) {
  return replaced(rig, "position_m = [0.35, 0, 1.1]\n",
                  "position_m = [0.35, 0, 1.1]\nmax_lx = " + std::to_string(max_lx) + "\n");
}

inline ComputeOptions direct_light() {
  ComputeOptions options;
  options.model = Model::direct;
  return options;
}

inline Eigen::VectorXd levels_of(const SolvedTasks& solved) {
  Eigen::VectorXd levels = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(solved.rig.fixtures.size()));
  for (const PlannedTask& task : solved.plan.tasks)
    for (const PlannedLight& light : task.lights)
      for (std::size_t f = 0; f < solved.rig.fixtures.size(); ++f)
        if (solved.rig.fixtures[f].name == light.name) levels[static_cast<Eigen::Index>(f)] = light.level;
  return levels;
}

/// The rig of a solution, its heads posed by the look.
inline Rig turned(const SolvedTasks& solved) {
  Rig rig = solved.rig;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
    rig.fixtures[f].joints = solved.look.joints[f];
    rig.fixtures[f].aim_world_m = solved.look.aim_world_m[f];
  }
  return rig;
}

/// Adds the mesh of the well beside the rig.
class ReliefTask : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "luxrig-relief-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
    std::ofstream obj(folder_ / "well.obj");
    for (int i = 0; i <= kWellSquares; ++i)
      for (int j = 0; j <= kWellSquares; ++j)
        obj << "v " << well_place_m(i) << ' ' << well_place_m(j) << ' '
            << well_height_m(well_place_m(i), well_place_m(j)) << '\n';
    for (int i = 0; i < kWellSquares; ++i)
      for (int j = 0; j < kWellSquares; ++j) {
        const int a = 1 + i * (kWellSquares + 1) + j, b = a + kWellSquares + 1;
        obj << "f " << a << ' ' << b << ' ' << b + 1 << "\nf " << a << ' ' << b + 1 << ' ' << a + 1 << '\n';
      }
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  [[nodiscard]] Session well(const std::string& rig) const { return opened_rig(rig, folder_); }
  /// The error text of the refusal, which must come.
  [[nodiscard]] std::string refusal_of(const std::string& rig) const {
    const Session session = well(rig);
    const auto solved = solve_tasks(session, transport_of(session, direct_light()), direct_light());
    EXPECT_FALSE(solved);
    if (solved) return "not refused";
    EXPECT_EQ(solved.error().cause, Cause::invalid);
    return solved.error().detail;
  }
  /// In place of the well, a shape that no light could show.
  void flatten() const {
    std::ofstream(folder_ / "well.obj") << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
  }

  std::filesystem::path folder_;
};

using AimTask = ReliefTask;

using HighlightTask = ReliefTask;

inline SolvedTasks solved_of(const Session& session, const ComputeOptions& options) {
  auto solved = solve_tasks(session, transport_of(session, options), options);
  EXPECT_TRUE(solved) << solved.error().detail;
  return std::move(*solved);
}

}  // namespace luxrig::relief_tasks_fixture
