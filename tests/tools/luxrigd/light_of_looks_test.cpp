#include "tools/luxrigd/light_of_looks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/tools/programs/process.h"
#include "tools/luxrig/open_session.h"

namespace luxrig {
namespace {

using luxrig::testing::Folder;
using luxrig::testing::source;

class RoomInLooks : public ::testing::Test {
 protected:
  RoomInLooks() {
    auto opened = open_session(source("tests/rigs/room/rig.toml"));
    EXPECT_TRUE(opened) << opened.error()[0].text();
    session_ = std::make_unique<Session>(std::move(*opened));
    hung_ = hung_look(session_->rig).joints;
    options_.max_error = 0.05;
    options_.watch.tell = [this](const Doing&) { computed_ = true; };
  }
  [[nodiscard]] std::vector<Joints> turned(double by_rad) const {
    std::vector<Joints> joints = hung_;
    joints[head()].tilt_rad += by_rad;
    return joints;
  }
  [[nodiscard]] std::size_t head() const {
    for (std::size_t f = 0; f < session_->rig.fixtures.size(); ++f)
      if (session_->rig.fixtures[f].name == "head-1") return f;
    ADD_FAILURE() << "the room has no head";
    return 0;
  }
  LightModel model(LightOfLooks& looks, const std::vector<Joints>& joints) {
    computed_ = false;
    auto model = looks.model(*session_, joints);
    EXPECT_TRUE(model) << model.error().detail;
    return *model;
  }

  std::unique_ptr<Session> session_;
  std::vector<Joints> hung_;
  ComputeOptions options_;
  std::atomic<bool> computed_{false};
};

TEST_F(RoomInLooks, AKnownLookIsNotComputedAgain) {
  LightOfLooks looks(options_);
  const LightModel first = model(looks, hung_);
  EXPECT_TRUE(computed_);
  EXPECT_EQ(model(looks, hung_).point_lux_per_level, first.point_lux_per_level);
  EXPECT_FALSE(computed_);
}

TEST_F(RoomInLooks, LightComputedElsewhereIsKnown) {
  const auto transport = compute_transport(*session_, options_);
  ASSERT_TRUE(transport);
  LightOfLooks looks(options_);
  looks.know(*session_, hung_, *transport);
  EXPECT_EQ(model(looks, hung_).point_lux_per_level, light_model(session_->rig, *transport).point_lux_per_level);
  EXPECT_FALSE(computed_);
}

TEST_F(RoomInLooks, AHeadThatTurnsBackCostsNothing) {
  LightOfLooks looks(options_);
  const LightModel before = model(looks, hung_), after = model(looks, turned(0.3));
  EXPECT_TRUE(computed_);
  EXPECT_NE(after.point_lux_per_level.col(static_cast<Eigen::Index>(head())),
            before.point_lux_per_level.col(static_cast<Eigen::Index>(head())));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(model(looks, hung_).point_lux_per_level, before.point_lux_per_level);
    EXPECT_FALSE(computed_);
    EXPECT_EQ(model(looks, turned(0.3)).point_lux_per_level, after.point_lux_per_level);
    EXPECT_FALSE(computed_);
  }
}

TEST_F(RoomInLooks, TheLastLookIsSavedEvenIfAlreadyKnown) {
  const Folder folder;
  LightOfLooks looks(options_, folder / "state");
  EXPECT_FALSE(looks.read_saved(*session_));
  const LightModel before = model(looks, hung_);
  (void)model(looks, turned(0.3));
  (void)model(looks, hung_);

  LightOfLooks next(options_, folder / "state");
  const auto saved = next.read_saved(*session_);
  ASSERT_TRUE(saved);
  EXPECT_EQ(saved->model.point_lux_per_level, before.point_lux_per_level);
  EXPECT_TRUE(std::equal(hung_.begin(), hung_.end(), saved->joints.begin(), same_aim));
  std::filesystem::remove_all(folder / "state");
  EXPECT_EQ(model(next, hung_).point_lux_per_level, before.point_lux_per_level);
  EXPECT_FALSE(computed_);
  EXPECT_FALSE(std::filesystem::exists(folder / "state")) << "the saved light was saved once more";
  (void)model(next, turned(0.3));
  EXPECT_TRUE(computed_) << "a saved model has no columns to keep";

  ComputeOptions other = options_;
  other.max_error = 0.04;
  EXPECT_FALSE(LightOfLooks(other, folder / "state").read_saved(*session_)) << "it was wanted less exact";
}

TEST_F(RoomInLooks, SavedLightIsAsSureOfEachLampAsTheCalibration) {
  const Folder folder;
  session_->rig.fixtures[head()].known_to = LightError{0.02, 0.03};
  LightOfLooks looks(options_, folder / "state");
  const LightModel before = model(looks, hung_);
  const auto f = static_cast<Eigen::Index>(head());
  ASSERT_EQ(before.gain_sd[f], 0.02);
  const auto saved = LightOfLooks(options_, folder / "state").read_saved(*session_);
  ASSERT_TRUE(saved);
  ASSERT_EQ(saved->model.gain_sd.size(), before.gain_sd.size());
  EXPECT_EQ(saved->model.gain_sd[f], 0.02);
  EXPECT_EQ(saved->model.local_sd[f], 0.03);
}

TEST_F(RoomInLooks, ConcurrentRequestsGetTheLightOfTheirOwnLook) {
  options_.watch.tell = nullptr;
  LightOfLooks looks(options_);
  (void)model(looks, hung_);
  std::vector<std::jthread> threads;
  std::vector<LightModel> found(4);
  for (std::size_t i = 0; i < found.size(); ++i)
    threads.emplace_back([&, i] { found[i] = *looks.model(*session_, turned(0.1 * static_cast<double>(i + 1))); });
  threads.clear();
  std::vector<Eigen::VectorXd> alone;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto transport = compute_transport(*session_, options_, {{}, turned(0.1 * static_cast<double>(i + 1))});
    ASSERT_TRUE(transport);
    alone.push_back(light_model(session_->rig, *transport).point_lux_per_level.col(static_cast<Eigen::Index>(head())));
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::VectorXd own = found[i].point_lux_per_level.col(static_cast<Eigen::Index>(head()));
    for (std::size_t other = 0; other < alone.size(); ++other)
      if (other != i) {
        EXPECT_LT((own - alone[i]).norm(), (own - alone[other]).norm()) << i << " " << other;
      }
  }
}

}  // namespace
}  // namespace luxrig
