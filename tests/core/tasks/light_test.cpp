/// Known light is kept: only turned or new lamps are computed.

#include "core/tasks/light.h"

#include <gtest/gtest.h>

#include <random>

#include "core/tasks/rig_transport.h"
#include "tests/core/tasks/tasks_fixture.h"

namespace luxrig {
namespace {

using namespace tasks_fixture;

const char* const kOvercast = "\n[daylight]\nsky = \"overcast\"\nhorizontal_lx = 5000\n";

class KeptLight : public testing::Test {
 protected:
  KeptLight() : session_(opened(room_text())), hung_(hung_look(session_.rig)) {
    before_ = transport_of(session_, options_);
  }
  [[nodiscard]] TransportMatrix light(const Look& look, bool kept, ModelUsed* used = nullptr) const {
    const KeptTransport before{hung_.joints, before_};
    auto transport = compute_transport(session_.rig, *session_.rays, options_, look, used, kept ? &before : nullptr);
    EXPECT_TRUE(transport) << transport.error().detail;
    return std::move(*transport);
  }

  static void expect_alike(const TransportMatrix& a, const TransportMatrix& b, const Eigen::VectorXd& levels) {
    const Eigen::VectorXd error_lux = a.standard_error_lux(levels) + b.standard_error_lux(levels);
    const Eigen::VectorXd off_lux = (a.lux(levels) - b.lux(levels)).cwiseAbs();
    for (Eigen::Index r = 0; r < off_lux.size(); ++r) EXPECT_LE(off_lux[r], 6 * error_lux[r] + 1e-9) << r;
  }

  Session session_;
  ComputeOptions options_;
  Look hung_;
  TransportMatrix before_;
};

TEST_F(KeptLight, CastsNoRayWhenNothingTurns) {
  ModelUsed used;
  const TransportMatrix again = light(hung_, true, &used);
  EXPECT_EQ(again.rays, 0u);
  EXPECT_EQ(again.lux_per_level, before_.lux_per_level);
  EXPECT_EQ(again.direct_lux_per_level, before_.direct_lux_per_level);
  EXPECT_EQ(used.name, "kept");
}

TEST_F(KeptLight, ComputesOnlyTheTurnedFixture) {
  options_.max_error = 0.02;  // the known light is twice as exact
  Look turned = hung_;
  turned.joints[1].tilt_rad += 0.4;
  ModelUsed used;
  const TransportMatrix some = light(turned, true, &used), all = light(turned, false);
  EXPECT_TRUE(used.reached()) << used.warning();
  EXPECT_NE(used.reason.find("2 of 3"), std::string::npos) << used.reason;
  for (const Eigen::Index same : {0, 2}) EXPECT_EQ(some.lux_per_level.col(same), before_.lux_per_level.col(same));
  EXPECT_GT((some.lux_per_level.col(1) - before_.lux_per_level.col(1)).cwiseAbs().maxCoeff(),
            0.05 * before_.lux_per_level.col(1).maxCoeff());
  EXPECT_TRUE(some.direct_lux_per_level.isApprox(all.direct_lux_per_level, 1e-12));
  expect_alike(some, all, Eigen::VectorXd::Unit(3, 1));
}

TEST_F(KeptLight, NearlyExactLightIsRefinedByASecondEstimate) {
  options_.model = Model::path;
  options_.max_error = 0.01;
  before_ = transport_of(session_, options_);
  options_.max_error = 0.8 * before_.rms_error;
  Look turned = hung_;
  turned.joints[1].tilt_rad += 0.4;
  ModelUsed used;
  const TransportMatrix some = light(turned, true, &used), all = light(turned, false);
  EXPECT_TRUE(used.reached()) << used.warning();
  EXPECT_NE(used.reason.find("2 of 3"), std::string::npos) << used.reason;
  EXPECT_NE(some.lux_per_level.col(0), before_.lux_per_level.col(0));
  EXPECT_TRUE(some.direct_lux_per_level.isApprox(all.direct_lux_per_level, 1e-12));
  for (Eigen::Index e = 0; e < 3; ++e) expect_alike(some, all, Eigen::VectorXd::Unit(3, e));
}

TEST_F(KeptLight, InexactLightIsComputedAgain) {
  ComputeOptions coarse = options_;
  coarse.model = options_.model = Model::path;
  coarse.max_error = 0.2;
  before_ = transport_of(session_, coarse);
  options_.max_error = 0.003;
  Look turned = hung_;
  turned.joints[0].tilt_rad += 0.2;
  ModelUsed used;
  const TransportMatrix anew = light(turned, true, &used);
  EXPECT_TRUE(used.reached()) << used.warning();
  EXPECT_LE(anew.rms_error, 0.003);
  EXPECT_NE(anew.lux_per_level.col(2), before_.lux_per_level.col(2));
}

TEST_F(KeptLight, MatchesFreshlyComputedLightForAnyLook) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> turn(-1, 1), level(0, 1);
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    Look look = hung_;
    for (Joints& joints : look.joints) {
      if (level(random) < 0.5) joints.pan_rad += turn(random), joints.tilt_rad += turn(random);
      look.levels.push_back(level(random) < 0.3 ? 0 : level(random));
    }
    ModelUsed used;
    const TransportMatrix some = light(look, true, &used), all = light(look, false);
    EXPECT_TRUE(used.reached()) << used.warning();
    const Eigen::Map<const Eigen::VectorXd> levels(look.levels.data(), 3);
    expect_alike(some, all, levels);
  }
}

TEST(KeptLightOfALargerRig, DaylightIsKeptWhenALampIsHung) {
  const Session session = opened(room_text() + kOvercast);
  const ComputeOptions options;
  const TransportMatrix before = transport_of(session, options);
  Rig more = session.rig;
  more.fixtures.push_back(more.fixtures[0]);
  more.fixtures.back().world_from_mount.translation_m.x() += 0.3;
  const std::vector<Joints> joints = hung_look(session.rig).joints;
  const KeptTransport kept{joints, before};
  const auto with = compute_transport(more, *session.rays, options, {}, nullptr, &kept);
  ASSERT_TRUE(with) << with.error().detail;
  ASSERT_EQ(with->emitters(), before.emitters() + 1);
  EXPECT_EQ(with->lux_per_level.leftCols(3), before.lux_per_level.leftCols(3));
  EXPECT_EQ(with->lux_per_level.rightCols(before.emitters() - 3),
            before.lux_per_level.rightCols(before.emitters() - 3));
  EXPECT_GT(with->lux_per_level.col(3).maxCoeff(), 0);
}

TEST(LightOf, NoEmittersHasNoColumns) {
  const Session session = opened(room_text());
  EvaluateOptions wanted;
  wanted.colour = true;
  ModelUsed used;
  const auto dark = light_of(*session.rays, receivers_of(session.rig), {}, wanted, {}, &used);
  ASSERT_TRUE(dark);
  EXPECT_EQ(dark->emitters(), 0);
  EXPECT_EQ(dark->receivers(), 4);
  EXPECT_EQ(dark->rgb_per_level.size(), 3u);
  EXPECT_TRUE(used.reached());
}

}  // namespace
}  // namespace luxrig
