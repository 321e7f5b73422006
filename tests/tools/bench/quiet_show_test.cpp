// A show that holds, with meters of the field and lamps that warm up: it does not correct for ever what no level mends.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/rig/rig_file.h"
#include "core/tasks/session.h"
#include "sim/world/deviations.h"
#include "tests/folders.h"
#include "tools/bench/hold/held_rig.h"

namespace luxrig {
namespace {

TEST(QuietShow, SeldomCorrectsWhereNothingChanges) {
  auto rig = load_rig(test::source_folder() / "rigs/gallery/rig.toml");
  ASSERT_TRUE(rig);
  const auto session = session_of(std::move(*rig));
  ASSERT_TRUE(session);
  ComputeOptions compute;
  compute.max_error = 0.1;
  const auto light = compute_transport(*session, compute);
  ASSERT_TRUE(light);
  int corrections = 0;
  constexpr int kShows = 2;
  for (std::uint64_t seed = 1; seed <= kShows; ++seed) {
    sim::Deviations real = sim::Deviations::real();
    real.seed = seed;
    real.visits_per_hour = 0;
    auto world = sim::World::make(session->rig, real, 0.1);
    ASSERT_TRUE(world);
    HeldRig held(session->rig, light_model(session->rig, *light), std::move(*world));
    held.apply(std::vector<double>(session->rig.fixtures.size(), 0.4));
    held.run(900);
    const int before = held.corrections();
    held.run(3600);
    corrections += held.corrections() - before;
  }
  RecordProperty("corrections_in_an_hour", std::to_string(static_cast<double>(corrections) / kShows));
  EXPECT_LE(corrections, 45 * kShows) << "one every ten seconds would be 360 in each hour";
}

}  // namespace
}  // namespace luxrig
