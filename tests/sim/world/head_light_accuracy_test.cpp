/// head_light: accuracy over many samples.
#include <gtest/gtest.h>

#include <cmath>

#include "core/transport/evaluator.h"
#include "sim/world/head_light.h"
#include "tests/sim/world/head_light_fixture.h"

namespace luxrig::sim {
namespace {

using namespace head_light_fixture;

// The error stated in head_light.h. Interpolation blurs the patch lit by the beam: the darker the walls, the larger
// that patch's share of the indirect light.
TEST(HeadLight, InterpolatedIndirectPartErrsAsStated) {
  const std::vector<Joints> set = spread_aims(kRange, 32), aims = random_aims(48, 1);
  for (const auto& [reflectance, stated] : {std::pair{0.3, 0.23}, {0.5, 0.17}}) {
    const Room room(reflectance);
    const TransportMatrix known = room.evaluate(set, 1'500'000), fresh = room.evaluate(aims, 1'500'000);
    ASSERT_EQ(known.emitters(), static_cast<Eigen::Index>(set.size()));
    ASSERT_EQ(fresh.emitters(), static_cast<Eigen::Index>(aims.size()));
    const auto light = room.head_light(set, known.lux_per_level - known.direct_lux_per_level);
    const double indirect_lx = (fresh.lux_per_level - fresh.direct_lux_per_level).mean();
    Eigen::MatrixXd error_lx(fresh.receivers(), fresh.emitters());
    Eigen::VectorXd lux = room.zeros();
    for (Eigen::Index a = 0; a < fresh.emitters(); ++a) {
      light->column(kFixture, aims[static_cast<std::size_t>(a)], lux);
      error_lx.col(a) = lux - fresh.lux_per_level.col(a);
    }
    const double rms_lx = std::sqrt(error_lx.squaredNorm() / static_cast<double>(error_lx.size()));
    // A quarter either way leaves room for other aims and for the noise of two evaluations.
    EXPECT_NEAR(rms_lx / indirect_lx, stated, 0.25 * stated) << "reflectance " << reflectance;
    EXPECT_LT(std::abs(error_lx.mean()) / indirect_lx, 0.05) << "reflectance " << reflectance;
  }
}

}  // namespace
}  // namespace luxrig::sim
