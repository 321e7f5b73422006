// A preview of the light agrees with the light as it is computed whole, says what cannot be reached, and the newest
// question of a client wins.
#include "tools/luxrigd/light_preview.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "core/tasks/rig_transport.h"
#include "tests/tools/programs/process.h"
#include "tools/luxrig/open_session.h"

namespace luxrig {
namespace {

using luxrig::testing::source;

class PreviewOfRoom : public ::testing::Test {
 protected:
  explicit PreviewOfRoom(const char* file = "tests/rigs/room/rig.toml") {
    auto opened = open_session(source(file));
    EXPECT_TRUE(opened) << opened.error()[0].text();
    session = std::make_shared<const Session>(std::move(*opened));
    const Rig& rig = session->rig;
    show.fixtures.resize(rig.fixtures.size());
    show.points.resize(rig.points.size());
    for (std::size_t f = 0; f < rig.fixtures.size(); ++f) {
      show.fixtures[f].joints = rig.fixtures[f].joints;
      show.fixtures[f].level = 0.5;
      show.fixtures[f].gain = 1;
    }
    set_light(show, false);
  }
  /// Light of a look by the evaluators that plans are made with.
  [[nodiscard]] Eigen::VectorXd light_of_look(const ShowStatus& of, bool reflections) const {
    std::vector<Joints> joints;
    Eigen::VectorXd level(static_cast<Eigen::Index>(of.fixtures.size()));
    for (std::size_t f = 0; f < of.fixtures.size(); ++f) {
      joints.push_back(of.fixtures[f].joints);
      level[static_cast<Eigen::Index>(f)] = of.fixtures[f].level;
    }
    ComputeOptions options;
    options.model = reflections ? Model::path : Model::direct;
    options.max_error = 0.02;
    const auto transport = compute_transport(*session, options, {{}, joints});
    EXPECT_TRUE(transport) << transport.error().detail;
    return transport->lux(levels_with_daylight(*transport, level));
  }
  void set_light(ShowStatus& of, bool reflections) const {
    const Eigen::VectorXd lux = light_of_look(of, reflections);
    for (std::size_t p = 0; p < of.points.size(); ++p) of.points[p].predicted_lx = lux[static_cast<Eigen::Index>(p)];
  }
  [[nodiscard]] std::size_t called(const std::string& name) const {
    for (std::size_t f = 0; f < session->rig.fixtures.size(); ++f)
      if (session->rig.fixtures[f].name == name) return f;
    ADD_FAILURE() << name;
    return 0;
  }
  Result<PreviewedLight> ask(const std::vector<WantedChange>& wanted, bool reflections = false) {
    return preview.light(session, show, wanted, reflections, "me");
  }
  /// The preview is what the whole computation gives for its own joints and levels.
  void expect_as_computed(const PreviewedLight& light, bool reflections, double relative) const {
    ShowStatus then = show;
    for (const PreviewedFixture& one : light.fixtures) {
      then.fixtures[one.fixture].joints = one.joints;
      then.fixtures[one.fixture].level = one.level;
    }
    const Eigen::VectorXd lux = light_of_look(then, reflections);
    for (std::size_t p = 0; p < light.lux.size(); ++p)
      EXPECT_NEAR(light.lux[p], lux[static_cast<Eigen::Index>(p)],
                  relative * lux[static_cast<Eigen::Index>(p)] +
                      (light.standard_error_lux.empty() ? 1e-6 : 4 * light.standard_error_lux[p]))
          << session->rig.points[p].name;
  }
  PreviewedLight with_reflections(const std::vector<WantedChange>& wanted) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (std::chrono::steady_clock::now() < until) {
      auto light = ask(wanted, true);
      if (!light) ADD_FAILURE() << light.error().detail;
      if (!light || light->reflections) return light.value_or(PreviewedLight{});
      EXPECT_NE(light->text, "");
      EXPECT_TRUE(light->standard_error_lux.empty()) << "it is not known yet";
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ADD_FAILURE() << "reflections are never ready";
    return {};
  }

  std::shared_ptr<const Session> session;
  ShowStatus show;
  LightPreview preview;
};

TEST_F(PreviewOfRoom, DirectLightIsAsTheWholeComputationHasIt) {
  const Vec3 at(1.2, 0.3, 1.0);
  const auto light = ask({{"head-1", 0.8, at, {}}, {"bulb-1", 0.1, {}, {}}});
  ASSERT_TRUE(light) << light.error().detail;
  EXPECT_FALSE(light->reflections);
  EXPECT_EQ(light->text, "") << "none were asked for";
  ASSERT_EQ(light->fixtures.size(), 2u);
  EXPECT_TRUE(light->fixtures[0].reached) << light->fixtures[0].why;
  // The beam goes through the point.
  const Fixture& head = session->rig.fixtures[called("head-1")];
  const Pose lamp = head.world_from_lamp(light->fixtures[0].joints);
  const Vec3 beam = -lamp.rotation.col(2);
  EXPECT_NEAR((at - lamp.translation_m).normalized().dot(beam), 1, 1e-9);
  expect_as_computed(*light, false, 1e-6);
}

TEST_F(PreviewOfRoom, ReflectedLightIsThereWithItsError) {
  set_light(show, true);
  const auto light = with_reflections({{"head-1", 0.8, Vec3(1.2, 0.3, 1.0), {}}, {"spot-1", 0.0, {}, {}}});
  ASSERT_EQ(light.standard_error_lux.size(), light.lux.size());
  for (const double error : light.standard_error_lux) EXPECT_GT(error, 0);
  expect_as_computed(light, true, 0.06);
}

TEST_F(PreviewOfRoom, WhatGainsAreKnownToBeCounts) {
  const std::size_t f = called("bulb-1");
  for (PointStatus& point : show.points) point.predicted_lx = 100;
  show.fixtures[f].gain = 0.7;
  const auto half = ask({{"bulb-1", 0.25, {}, {}}});
  show.fixtures[f].gain = 1.4;
  const auto twice = ask({{"bulb-1", 0.25, {}, {}}});
  ASSERT_TRUE(half && twice);
  for (std::size_t p = 0; p < show.points.size(); ++p) {
    EXPECT_LT(half->lux[p], 100);
    EXPECT_NEAR(100 - twice->lux[p], 2 * (100 - half->lux[p]), 1e-9);
  }
}

TEST_F(PreviewOfRoom, AFixtureThatDoesNotMoveIsTurnedByAPerson) {
  const auto light = ask({{"spot-1", {}, Vec3(0, -1, 0), {}}});
  ASSERT_TRUE(light) << light.error().detail;
  EXPECT_TRUE(light->fixtures[0].by_a_person);
  EXPECT_TRUE(light->fixtures[0].reached);
  expect_as_computed(*light, false, 1e-6);
  EXPECT_FALSE(ask({{"spot-1", {}, {}, Joints{0, 0, 0}}})) << "it has no angles to set";
}

TEST_F(PreviewOfRoom, WhatIsNotReachedStaysAsItIsAndSaysWhy) {
  const auto before = ask({{"head-1", 0.5, {}, {}}});
  const auto up = ask({{"head-1", {}, Vec3(1.5, -1.5, 9), {}}});
  const auto far = ask({{"head-1", {}, {}, Joints{rad_from_deg(300), 0, 0}}});
  const auto inside = ask({{"head-1", {}, session->rig.fixtures[called("head-1")].world_from_mount.translation_m, {}}});
  ASSERT_TRUE(before && up && far && inside);
  for (const auto* light : {&*up, &*far, &*inside}) {
    EXPECT_FALSE(light->fixtures[0].reached);
    EXPECT_NE(light->fixtures[0].why, "");
    EXPECT_EQ(light->lux, before->lux);
  }
  EXPECT_EQ(far->fixtures[0].why, "pan 300° is needed, and it goes from -270° to 270°");
  EXPECT_NE(up->fixtures[0].why.find("tilt"), std::string::npos) << up->fixtures[0].why;
}

TEST_F(PreviewOfRoom, ALevelIsAtMostWhatIsAllowed) {
  const auto light = ask({{"bulb-1", 1.0, {}, {}}});
  ASSERT_TRUE(light);
  EXPECT_EQ(light->fixtures[0].level, 0.9);
  EXPECT_EQ(light->fixtures[0].why, "its most is 90 %");
}

TEST_F(PreviewOfRoom, UnknownNamesAndOnesTwiceAreRefused) {
  for (const std::vector<WantedChange>& wanted : std::vector<std::vector<WantedChange>>{
           {{"nobody", 0.5, {}, {}}}, {{"spot-1", 0.5, {}, {}}, {"spot*", 0.1, {}, {}}}}) {
    const auto light = ask(wanted);
    ASSERT_FALSE(light);
    EXPECT_EQ(light.error().cause, Cause::invalid) << light.error().detail;
  }
  EXPECT_TRUE(ask({{"*", 0, {}, {}}})) << "and then it goes on";
}

TEST_F(PreviewOfRoom, OfManyQuestionsAtOnceTheNewestIsAnsweredAndNoneHangs) {
  std::atomic<int> answered{0}, superseded{0}, busy{0};
  std::vector<std::thread> clients;
  for (int i = 0; i < 8; ++i)
    clients.emplace_back([&, i] {
      for (int k = 0; k < 10; ++k) {
        const auto light =
            preview.light(session, show, {{"head-1", {}, Vec3(0.1 * k, 0.1 * i, 0), {}}}, false, i < 6 ? "me" : "you");
        if (light)
          ++answered;
        else if (light.error().cause == Cause::cancelled)
          ++superseded;
        else if (light.error().cause == Cause::timeout)
          ++busy;
      }
    });
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(answered + superseded + busy, 80);
  EXPECT_GT(answered, 0);
  EXPECT_TRUE(ask({{"head-1", 0.5, {}, {}}}));
}

}  // namespace
}  // namespace luxrig
