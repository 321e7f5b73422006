// Heads aimed at an object's relief, and lights found for it, checked against recomputed light.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "core/tasks/rig_transport.h"
#include "core/tasks/solve_tasks.h"
#include "tests/core/tasks/opened_rigs.h"
#include "tests/core/tasks/relief_tasks_fixture.h"

namespace luxrig {
namespace {

using namespace relief_tasks_fixture;

const Vec3 kWellMiddle(0, 0, kRim_m - kWellDepth_m / 2);

/// A vertex of the well, lifted slightly off it.
Point place_in_well(int i, int j) {
  const double x = well_place_m(i), y = well_place_m(j), d = 1e-4;
  Point place;
  place.name = "place";
  place.normal_world = Vec3((well_height_m(x - d, y) - well_height_m(x + d, y)) / (2 * d),
                            (well_height_m(x, y - d) - well_height_m(x, y + d)) / (2 * d), 1)
                           .normalized();
  place.position_world_m = Vec3(x, y, kRim_m + well_height_m(x, y)) + 1e-3 * place.normal_world;
  return place;
}

constexpr const char* kDaylight = "[daylight]\nsky = \"uniform\"\nhorizontal_lx = 5000\n";

/// At the rig's points, recomputed.
Eigen::VectorXd lux_anew(const Session& session, const Rig& rig, const Eigen::VectorXd& levels,
                         const ComputeOptions& options) {
  const auto transport = compute_transport(rig, *session.rays, options);
  EXPECT_TRUE(transport) << transport.error().detail;
  return transport->lux(levels_with_daylight(*transport, levels)).head(static_cast<Eigen::Index>(rig.points.size()));
}

/// Lux of the well and its rim, at vertices of its mesh.
class WellLight {
 public:
  WellLight(const Session& session, Rig rig, const Eigen::VectorXd& levels, const ComputeOptions& options) {
    rig.points.clear();
    rig.luxmeters.clear();
    for (int i = kFirst; i <= kLast; ++i)
      for (int j = kFirst; j <= kLast; ++j) rig.points.push_back(place_in_well(i, j));
    lux_ = lux_anew(session, rig, levels, options);
  }
  [[nodiscard]] double max_lx() const { return lux_.maxCoeff(); }
  /// On the well's floor, one of its recessed positions.
  [[nodiscard]] double max_recessed_lx() const {
    double most = 0;
    for (int i = kFirst; i <= kLast; ++i)
      for (int j = kFirst; j <= kLast; ++j)
        if (std::hypot(well_place_m(i), well_place_m(j)) <= 0.07) most = std::max(most, at(i, j));
    return most;
  }
  [[nodiscard]] double mean_lx() const { return lux_.mean(); }
  /// Of each position to the neighbour it differs most from, as an eye sees it: 0…1, mean.
  [[nodiscard]] double contrast() const {
    double sum = 0;
    for (int i = kFirst; i <= kLast; ++i)
      for (int j = kFirst; j <= kLast; ++j) {
        double most = 0;
        for (const auto& [u, v] : {std::pair(i - 1, j), std::pair(i + 1, j), std::pair(i, j - 1), std::pair(i, j + 1)})
          if (std::min(u, v) >= kFirst && std::max(u, v) <= kLast)
            most = std::max(most, std::abs(at(i, j) - at(u, v)) / (at(i, j) + at(u, v) + 0.1 * mean_lx()));
        sum += most;
      }
    return sum / static_cast<double>(lux_.size());
  }

 private:
  static constexpr int kFirst = kWellSquares / 2 - 7, kLast = kWellSquares / 2 + 7;
  [[nodiscard]] double at(int i, int j) const { return lux_[(i - kFirst) * (kLast - kFirst + 1) + j - kFirst]; }
  Eigen::VectorXd lux_;
};

/// By hand: a fixture's light at a position with a free line of sight. normal: none for an eye
double lux_by_hand(const Rig& rig, const Fixture& fixture, double level, const Vec3& place, const Vec3& normal) {
  const Pose lamp = fixture.world_from_lamp();
  const Vec3 way = place - lamp.translation_m, direction = way.normalized();
  const double cosine = normal.isZero() ? 1 : std::max(0.0, -direction.dot(normal));
  return level * rig.luminaires[fixture.luminaire].intensity->intensity_cd(lamp.inverse_direction(direction)) * cosine /
         way.squaredNorm();
}

/// Between the axis of a beam and the direction to a position.
double off_beam_deg(const Fixture& fixture, const Vec3& place) {
  const Pose lamp = fixture.world_from_lamp();
  const Vec3 beam = lamp.direction({0, 0, -1});
  return deg_from_rad(std::acos(std::clamp(beam.dot((place - lamp.translation_m).normalized()), -1.0, 1.0)));
}

/// Requests a stop as soon as a task reports this.
class StopsAt {
 public:
  StopsAt(ComputeOptions& options, const std::string& what) {
    options.watch.stop = person_.get_token();
    options.watch.tell = [this, what](const Doing& doing) {
      if (doing.what == what) person_.request_stop();
    };
  }
  [[nodiscard]] bool stopped() const { return person_.stop_requested(); }

 private:
  std::stop_source person_;
};

TEST_F(AimTask, TurnsHeadsTowardsAnObjectTheyMiss) {
  const Session session = well(std::string(kWellRig) + kAim);
  const SolvedTasks solved = solved_of(session, direct_light());
  const Eigen::VectorXd levels = levels_of(solved);
  ASSERT_EQ(levels.size(), 2);
  const Rig rig = turned(solved);
  for (std::size_t f = 0; f < 2; ++f) {
    const Fixture &was = session.rig.fixtures[f], &is = rig.fixtures[f];
    const PlannedLight& planned = solved.plan.tasks[0].lights[f];
    EXPECT_GT(off_beam_deg(was, kWellMiddle), 25) << was.name << " hangs so that it looks past it";
    EXPECT_LT(off_beam_deg(is, kWellMiddle), 10) << is.name << ": half of its beam angle";
    EXPECT_GT(planned.level, 0);
    ASSERT_TRUE(planned.joints);
    EXPECT_EQ(*planned.joints, is.joints);
    EXPECT_LE(std::abs(planned.joints->pan_rad), rad_from_deg(200));
    EXPECT_LE(std::abs(planned.joints->tilt_rad), rad_from_deg(100));
    ASSERT_TRUE(is.aim_world_m);
    EXPECT_LT(off_beam_deg(is, *is.aim_world_m), 1e-3);
  }
  const Eigen::VectorXd full = Eigen::VectorXd::Ones(2);
  const WellLight before(session, session.rig, full, direct_light()),
      after(session, turned(solved), levels, direct_light());
  EXPECT_GT(after.mean_lx(), 10 * before.mean_lx());
  double by_hand_lx = 0;
  for (std::size_t f = 0; f < 2; ++f)
    by_hand_lx += lux_by_hand(turned(solved), turned(solved).fixtures[f], levels[static_cast<Eigen::Index>(f)],
                              session.rig.points[0].position_world_m, Vec3::UnitZ());
  EXPECT_NEAR(solved.plan.points[0].lux, by_hand_lx, 1e-6 * by_hand_lx);
}

TEST_F(AimTask, ShowsAWellBetterThanBothHeadsAtFullOnItsCentre) {
  std::string rig = kWellRig;
  for (int head = 0; head < 2; ++head) rig = replaced(rig, "pan_deg = 0\ntilt_deg = 0", "aim_m = [0, 0, 1]");
  const Session session = well(rig + replaced(kAim, "contrast = \"lux\"", "contrast = \"relative\"\nbase_lx = 50"));
  const SolvedTasks solved = solved_of(session, direct_light());
  const WellLight before(session, session.rig, Eigen::VectorXd::Ones(2), direct_light()),
      after(session, turned(solved), levels_of(solved), direct_light());
  EXPECT_GT(after.contrast(), 1.1 * before.contrast());
  EXPECT_GT(after.mean_lx(), 40);
  const PlannedRelief& relief = *solved.plan.tasks[0].relief;
  EXPECT_GT(relief.relative_contrast, 1.1 * *relief.before_relative_contrast);
}

TEST_F(AimTask, KeepsAPointLimitThatItWouldOtherwiseBreak) {
  const Session free = well(std::string(kWellRig) + kAim), limited = well(with_limit(kWellRig, 40) + kAim);
  EXPECT_GT(solved_of(free, direct_light()).plan.points[0].lux, 60);
  const SolvedTasks solved = solved_of(limited, direct_light());
  const Eigen::VectorXd lux = lux_anew(limited, turned(solved), levels_of(solved), direct_light());
  EXPECT_LE(lux[0], 40 * (1 + 1e-9));
  EXPECT_NEAR(solved.plan.points[0].lux, lux[0], 1e-9 * lux[0]);
  EXPECT_GT(WellLight(limited, turned(solved), levels_of(solved), direct_light()).mean_lx(), 40) << "lit all the same";
  ASSERT_EQ(solved.plan.limits.size(), 1);
  EXPECT_TRUE(solved.plan.limits[0].met);
}

TEST_F(AimTask, KeepsRecessesWithinTheObjectLimitIncludingReflections) {
  // White walls around the slab reflect the light that passes it.
  std::string rig = replaced(kWellRig, "[0.35, 0, 1.1]", "[0, 0, 1.6]");
  int walls = 0;
  for (const auto& [x, y] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)})
    rig += fmt::format(
        "[[scene.object]]\nname = \"wall {}\"\nbox_m = [{}, {}, 0.5]\nposition_m = [{}, {}, 0.9]\n"
        "reflectance = 0.9\n",
        ++walls, x == 0 ? 0.7 : 0.02, y == 0 ? 0.7 : 0.02, 0.33 * x, 0.33 * y);
  const Session session = well(rig + kAim + "max_object_lx = 150\n");
  ComputeOptions options;
  options.max_error = 0.02;
  options.error_floor_lx = 1;
  const SolvedTasks solved = solved_of(session, options);
  const Eigen::VectorXd levels = levels_of(solved);
  const WellLight all(session, turned(solved), levels, options),
      direct(session, turned(solved), levels, direct_light());
  EXPECT_LE(all.max_recessed_lx(), 1.08 * 150) << "its samples and their normals are not quite the mesh's";
  EXPECT_GT(all.max_recessed_lx(), 0.8 * 150) << "no dimmer than the limit asks";
  EXPECT_GT(all.max_recessed_lx(), 1.1 * direct.max_recessed_lx()) << "the walls give something";
}

TEST_F(AimTask, KeepsTheDirectLightLimitOfAnEye) {
  // An eye on the line from the left head to the well, with nothing that would hide it.
  const Vec3 eye = (Vec3(-1.2, 0.3, 2.8) + kWellMiddle) / 2;
  const std::string point = fmt::format("[[point]]\nname = \"eye\"\nposition_m = [{}, {}, {}]\nnormal = [0, 0, 1]\n",
                                        eye.x(), eye.y(), eye.z());
  const auto at_eye_lx = [&](const std::string& wish) {
    const Session session = well(kWellRig + point + kAim + wish);
    const SolvedTasks solved = solved_of(session, direct_light());
    const Eigen::VectorXd levels = levels_of(solved);
    double lux = 0;
    for (std::size_t f = 0; f < 2; ++f)
      lux += lux_by_hand(turned(solved), turned(solved).fixtures[f], levels[static_cast<Eigen::Index>(f)], eye,
                         Vec3::Zero());
    return lux;
  };
  EXPECT_GT(at_eye_lx(""), 300);
  EXPECT_LE(at_eye_lx("eyes = [\"eye\"]\nmax_eye_lx = 50\n"), 50 * (1 + 1e-6));
}

TEST_F(AimTask, LeavesAHeadDarkAndUnturnedBehindAKeepOutZone) {
  const Session session = well(std::string(kWellRig) + kAim +
                               "[[keep_out]]\nname = \"mirror\"\ncentre_m = [-0.6, 0.15, 1.9]\nradius_m = 0.1\n"
                               "heads = [\"left\"]\n");
  const SolvedTasks solved = solved_of(session, direct_light());
  EXPECT_EQ(solved.plan.tasks[0].lights[0].level, 0);
  EXPECT_EQ(turned(solved).fixtures[0].joints, session.rig.fixtures[0].joints);
  EXPECT_GT(solved.plan.tasks[0].lights[1].level, 0);
  EXPECT_LT(off_beam_deg(turned(solved).fixtures[1], kWellMiddle), 10);
}

TEST_F(AimTask, StoppedWhileAimingGivesItsBestSoFarAndSkipsLaterTasks) {
  const Session session = well(with_limit(kWellRig, 40) + kAim + "[[task]]\nname = \"levels\"\nkind = \"emittance\"\n");
  const TransportMatrix transport = transport_of(session, direct_light());
  const auto whole = solve_tasks(session, transport, direct_light());
  ASSERT_TRUE(whole) << whole.error().detail;
  ASSERT_EQ(whole->plan.tasks.size(), 2);
  ComputeOptions options = direct_light();
  const StopsAt stop(options, "aiming");
  const auto solved = solve_tasks(session, transport, options);
  ASSERT_TRUE(stop.stopped());
  ASSERT_TRUE(solved) << solved.error().detail;
  ASSERT_EQ(solved->plan.tasks.size(), 1);
  EXPECT_LT(solved->plan.tasks[0].iterations, whole->plan.tasks[0].iterations);
  const Eigen::VectorXd levels = levels_of(*solved);
  ASSERT_GT(levels.maxCoeff(), 0);
  for (std::size_t f = 0; f < 2; ++f)
    if (levels[static_cast<Eigen::Index>(f)] > 0) {
      EXPECT_LT(off_beam_deg(turned(*solved).fixtures[f], kWellMiddle), 20);
    }
  const Eigen::VectorXd lux = lux_anew(session, turned(*solved), levels, direct_light());
  EXPECT_LE(lux[0], 40 * (1 + 1e-9));
  EXPECT_NEAR(solved->plan.points[0].lux, lux[0], 1e-9 * lux[0]);
}

TEST_F(AimTask, StoppedBeforeAimingIsCancelledAndLeavesNoTrace) {
  // A bulb that the aim leaves unchanged, so its light is computed first.
  const Session session = well(replaced(kWellRig, "[[point]]\n", R"([[fixture]]
name = "bulb"
luminaire = "bulb"
position_m = [0.4, 0.4, 2.5]
bus = "dmx"
address = 21
[[point]]
goal_lx = 20
)") + "[[task]]\nname = \"levels\"\nkind = \"emittance\"\n" +
                               kAim);
  const TransportMatrix transport = transport_of(session, direct_light());
  const auto before = solve_tasks(session, transport, direct_light());
  ASSERT_TRUE(before) << before.error().detail;
  EXPECT_GT(before->plan.tasks[0].lights[2].level, 0);
  ComputeOptions options = direct_light();
  const StopsAt stop(options, "light that stays");
  const auto solved = solve_tasks(session, transport, options);
  ASSERT_TRUE(stop.stopped());
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().cause, Cause::cancelled) << solved.error().detail;
  const auto after = solve_tasks(session, transport, direct_light());
  ASSERT_TRUE(after) << after.error().detail;
  EXPECT_EQ(text_of(after->plan), text_of(before->plan));
}

TEST_F(AimTask, IsRefusedWhenNoHeadCanTurnToTheObject) {
  std::string rig = kWellRig;
  for (int head = 0; head < 2; ++head) rig = replaced(rig, "tilt_range_deg = [-100, 100]", "tilt_range_deg = [-5, 5]");
  EXPECT_EQ(
      refusal_of(rig + kAim),
      "task \"relief\": no head can be turned to anything that it sees of the object: move one, or widen its range");
}

TEST_F(AimTask, IsRefusedWhenSomethingStandsBetweenAllHeadsAndTheObject) {
  const std::string lid = "[[scene.object]]\nname = \"lid\"\nbox_m = [2, 2, 0.02]\nposition_m = [0, 0, 1.2]\n";
  EXPECT_EQ(
      refusal_of(kWellRig + lid + kAim),
      "task \"relief\": no head sees any of the object: something stands between them, or it turns away from them "
      "all");
}

TEST_F(AimTask, IsRefusedWhenDaylightAloneIsAboveALimit) {
  const std::string said = refusal_of(with_limit(kWellRig, 40) + kDaylight + kAim);
  EXPECT_NE(said.find("point \"beside\" has"), std::string::npos) << said;
  EXPECT_NE(said.find("lx of daylight alone, its limit is 40 lx"), std::string::npos) << said;
}

TEST_F(AimTask, IsRefusedWhenItsCameraSeesNoneOfTheRelief) {
  const std::string camera =
      "[[camera]]\nname = \"cellar\"\nposition_m = [0.1, 0, 0.1]\naim_m = [0, 0, 1]\nwidth_px = 64\nheight_px = 48\n";
  EXPECT_EQ(refusal_of(kWellRig + camera + kAim + "seen_by = \"cellar\"\n"),
            "object \"slab\": camera \"cellar\" sees none of its recessed places");
}

TEST_F(AimTask, IsRefusedForAFlatObject) {
  flatten();
  const std::string said = refusal_of(std::string(kWellRig) + kAim);
  EXPECT_TRUE(said.starts_with("object \"slab\": the target")) << said;
}

TEST_F(HighlightTask, HangsCeilingLightsThatBeatLightsStraightAboveAWell) {
  const Session session = well(std::string(kWellRig) + kHighlight);
  const SolvedTasks solved = solved_of(session, direct_light());
  ASSERT_EQ(solved.plan.tasks.size(), 1);
  ASSERT_EQ(solved.plan.tasks[0].lights.size(), 2);
  ASSERT_EQ(solved.rig.fixtures.size(), 4);
  const Eigen::VectorXd levels = levels_of(solved);
  EXPECT_EQ(levels.head(2), Eigen::VectorXd::Zero(2)) << "what hangs is dark";
  Rig above = solved.rig;
  double by_hand_lx = 0;
  for (std::size_t f = 2; f < 4; ++f) {
    const Fixture& light = solved.rig.fixtures[f];
    const Vec3& at = light.world_from_mount.translation_m;
    EXPECT_GE(at.z(), 3 - 0.15 - 1e-6);
    EXPECT_LE(at.z(), 3 - 0.05 + 1e-6);
    EXPECT_LE(at.head<2>().cwiseAbs().maxCoeff(), 2 + 1e-6);
    EXPECT_LT(off_beam_deg(light, kWellMiddle), 10) << "half of its beam angle";
    EXPECT_GT(levels[static_cast<Eigen::Index>(f)], 0);
    by_hand_lx += lux_by_hand(turned(solved), light, levels[static_cast<Eigen::Index>(f)],
                              session.rig.points[0].position_world_m, Vec3::UnitZ());
    above.fixtures[f].world_from_mount.translation_m = Vec3(0, 0, 2.9);
    above.fixtures[f].joints = {};
  }
  EXPECT_NEAR(solved.plan.points[0].lux, by_hand_lx, 1e-6 * by_hand_lx);
  EXPECT_GT(WellLight(session, turned(solved), levels, direct_light()).contrast(),
            1.5 * WellLight(session, above, levels, direct_light()).contrast());
}

TEST_F(HighlightTask, KeepsPointAndObjectLimitsThatItWouldOtherwiseBreak) {
  const auto light_of = [&](const std::string& rig, double& beside_lx) {
    const Session session = well(rig);
    const SolvedTasks solved = solved_of(session, direct_light());
    const Eigen::VectorXd levels = levels_of(solved);
    EXPECT_GT(levels.maxCoeff(), 0);
    beside_lx = lux_anew(session, turned(solved), levels, direct_light())[0];
    EXPECT_NEAR(solved.plan.points[0].lux, beside_lx, 1e-9 * beside_lx);
    return WellLight(session, turned(solved), levels, direct_light());
  };
  const std::string limited = replaced(kHighlight, "lights = 2\n", "lights = 2\nmax_object_lx = 120\n");
  double beside_lx = 0;
  const WellLight free = light_of(std::string(kWellRig) + kHighlight, beside_lx);
  EXPECT_GT(free.max_recessed_lx(), 200);
  EXPECT_GT(beside_lx, 60);
  const WellLight of_object = light_of(kWellRig + limited, beside_lx);
  EXPECT_LE(of_object.max_recessed_lx(), 1.03 * 120);
  EXPECT_GT(of_object.max_lx(), 0.8 * 120) << "no dimmer than the limit asks";
  const WellLight of_both = light_of(with_limit(kWellRig, 20) + limited, beside_lx);
  EXPECT_LE(beside_lx, 20 * (1 + 1e-9));
  EXPECT_LE(of_both.max_recessed_lx(), 1.03 * 120);
}

TEST_F(HighlightTask, TakesTheBestNumberOfLightsAndListsTheOthers) {
  const Session session = well(std::string(kWellRig) + replaced(kHighlight, "lights = 2\n", "max_lights = 3\n"));
  const SolvedTasks solved = solved_of(session, direct_light());
  const PlannedTask& task = solved.plan.tasks[0];
  ASSERT_EQ(task.numbers.size(), 3);
  ASSERT_GE(task.lights.size(), 1);
  ASSERT_LE(task.lights.size(), 3);
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_EQ(task.numbers[n].lights, static_cast<int>(n) + 1);
    EXPECT_GT(task.numbers[n].local_contrast_lx.value_or(0), 0);
    if (n < task.lights.size()) {
      EXPECT_LE(*task.numbers[n].local_contrast_lx, *task.numbers[task.lights.size() - 1].local_contrast_lx);
    }
  }
}

TEST_F(HighlightTask, StoppedWhileAimingHangsItsBestSoFarAndSkipsLaterTasks) {
  const Session session =
      well(with_limit(kWellRig, 40) + kHighlight + "[[task]]\nname = \"levels\"\nkind = \"emittance\"\n");
  const TransportMatrix transport = transport_of(session, direct_light());
  ComputeOptions options = direct_light();
  const StopsAt stop(options, "aiming");
  const auto solved = solve_tasks(session, transport, options);
  ASSERT_TRUE(stop.stopped());
  ASSERT_TRUE(solved) << solved.error().detail;
  ASSERT_EQ(solved->plan.tasks.size(), 1);
  ASSERT_GE(solved->plan.tasks[0].lights.size(), 1);
  ASSERT_EQ(solved->rig.fixtures.size(), 2 + solved->plan.tasks[0].lights.size());
  const Eigen::VectorXd levels = levels_of(*solved);
  EXPECT_GT(WellLight(session, turned(*solved), levels, direct_light()).mean_lx(), 10);
  const Eigen::VectorXd lux = lux_anew(session, turned(*solved), levels, direct_light());
  EXPECT_LE(lux[0], 40 * (1 + 1e-9));
  EXPECT_NEAR(solved->plan.points[0].lux, lux[0], 1e-9 * lux[0]);
}

TEST_F(HighlightTask, StoppedBeforeItHasLightsGivesNoPlanAndLeavesNoTrace) {
  const Session session = well(std::string(kWellRig) + kHighlight);
  const TransportMatrix transport = transport_of(session, direct_light());
  for (const char* what : {"looking for shadow edges", "asking where lights may hang", "judging lights"}) {
    ComputeOptions options = direct_light();
    const StopsAt stop(options, what);
    const auto solved = solve_tasks(session, transport, options);
    ASSERT_TRUE(stop.stopped()) << what;
    ASSERT_FALSE(solved) << what;
    EXPECT_TRUE(solved.error().detail.ends_with("was stopped")) << solved.error().detail;
  }
  const auto before = solve_tasks(session, transport, direct_light());
  ASSERT_TRUE(before) << before.error().detail;
  EXPECT_EQ(text_of(before->plan), text_of(solved_of(well(std::string(kWellRig) + kHighlight), direct_light()).plan));
}

TEST_F(HighlightTask, IsRefusedWhenLightsCanHangNowhere) {
  const std::string said = refusal_of(std::string(kWellRig) + kHighlight + "clearance_m = 5\n");
  EXPECT_TRUE(said.starts_with("task \"detail\": lights may hang at none of ")) << said;
  EXPECT_TRUE(said.ends_with("widen box_m or offset_m of [mounting], or lower clearance_m")) << said;
}

TEST_F(HighlightTask, IsRefusedWhenNoPossibleLightReachesTheRelief) {
  const std::string lid = "[[scene.object]]\nname = \"lid\"\nbox_m = [3, 3, 0.02]\nposition_m = [0, 0, 1.12]\n";
  const std::string said = refusal_of(replaced(kWellRig, "[0.35, 0, 1.1]", "[0.35, 0, 1.3]") + lid + kHighlight);
  EXPECT_TRUE(said.starts_with("task \"detail\": no shadow edge of the target can be lit from the light domain"))
      << said;
}

TEST_F(HighlightTask, IsRefusedWhenDaylightAloneIsAboveALimit) {
  const std::string said = refusal_of(with_limit(kWellRig, 40) + kDaylight + kHighlight);
  EXPECT_NE(said.find("lx of daylight alone, its limit is 40 lx"), std::string::npos) << said;
}

TEST_F(HighlightTask, IsRefusedForAFlatObject) {
  flatten();
  const std::string said = refusal_of(std::string(kWellRig) + kHighlight);
  EXPECT_TRUE(said.starts_with("object \"slab\": the target")) << said;
}

TEST_F(HighlightTask, StoppedBeforeItHasLightsIsCancelledNotRefused) {
  const Session session = well(std::string(kWellRig) + kHighlight);
  const TransportMatrix transport = transport_of(session, direct_light());
  for (const char* what : {"looking for shadow edges", "asking where lights may hang", "judging lights"}) {
    ComputeOptions options = direct_light();
    const StopsAt stop(options, what);
    const auto solved = solve_tasks(session, transport, options);
    ASSERT_TRUE(stop.stopped()) << what;
    ASSERT_FALSE(solved) << what;
    EXPECT_EQ(solved.error().cause, Cause::cancelled) << what << ": " << solved.error().detail;
  }
}

TEST_F(AimTask, StoppedWhileStudyingItsObjectIsCancelledNotRefused) {
  const Session session = well(std::string(kWellRig) + kAim);
  const TransportMatrix transport = transport_of(session, direct_light());
  std::stop_source person;
  person.request_stop();
  ComputeOptions options = direct_light();
  options.watch.stop = person.get_token();
  const auto solved = solve_tasks(session, transport, options);
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().cause, Cause::cancelled) << solved.error().detail;
}

TEST_F(AimTask, StoppedWhileAimingWithAnObjectLimitGivesItsBestSoFar) {
  const Session session = well(std::string(kWellRig) + kAim + "max_object_lx = 150\n");
  const TransportMatrix transport = transport_of(session, direct_light());
  ComputeOptions options = direct_light();
  const StopsAt stop(options, "aiming");
  const auto solved = solve_tasks(session, transport, options);
  ASSERT_TRUE(stop.stopped());
  ASSERT_TRUE(solved) << solved.error().detail;
}

TEST_F(HighlightTask, StoppedWhileAimingWithAnObjectLimitGivesItsBestSoFar) {
  const Session session =
      well(std::string(kWellRig) + replaced(kHighlight, "lights = 2\n", "lights = 2\nmax_object_lx = 150\n"));
  const TransportMatrix transport = transport_of(session, direct_light());
  ComputeOptions options = direct_light();
  const StopsAt stop(options, "aiming");
  const auto solved = solve_tasks(session, transport, options);
  ASSERT_TRUE(stop.stopped());
  ASSERT_TRUE(solved) << solved.error().detail;
}

TEST_F(HighlightTask, KeepsTheWholeObjectWithinItsLimit) {
  const Session session =
      well(std::string(kWellRig) + replaced(kHighlight, "lights = 2\n", "lights = 2\nmax_object_lx = 120\n"));
  const SolvedTasks solved = solved_of(session, direct_light());
  EXPECT_LE(WellLight(session, turned(solved), levels_of(solved), direct_light()).max_lx(), 1.08 * 120);
}

TEST_F(AimTask, KeepsTheWholeObjectWithinItsLimit) {
  const Session session = well(std::string(kWellRig) + kAim + "max_object_lx = 120\n");
  const SolvedTasks solved = solved_of(session, direct_light());
  EXPECT_LE(WellLight(session, turned(solved), levels_of(solved), direct_light()).max_lx(), 1.08 * 120);
}

TEST_F(AimTask, LightsAnObjectInADarkRoomWithTheDefaultContrast) {
  const Session session = well(std::string(kWellRig) + replaced(kAim, "contrast = \"lux\"\n", ""));
  const SolvedTasks solved = solved_of(session, direct_light());
  EXPECT_GT(WellLight(session, turned(solved), levels_of(solved), direct_light()).mean_lx(), 10);
}

}  // namespace
}  // namespace luxrig
