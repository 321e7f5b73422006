#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "tools/bench/analytic/case.h"
#include "tools/bench/transport/case.h"

namespace luxrig {
namespace {

std::size_t lines_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::size_t count = 0;
  for (std::string line; std::getline(in, line);) ++count;
  return count;
}

std::filesystem::path fresh_folder(const std::string& name) {
  const auto folder = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  return folder;
}

TEST(AnalyticSuite, DirectLightMeetsItsTargetsInPointFluxAndAreaRows) {
  BenchOptions options;
  options.quick = true;
  std::vector<BenchRow> rows;
  add_point_rows(options, rows);
  add_flux_rows(options, rows);
  add_area_rows(options, rows);
  EXPECT_GT(rows.size(), 30u);
  for (const BenchRow& row : rows)
    if (row.method == "direct") {
      EXPECT_EQ(row.met(), std::optional(true))
          << row.case_name << ", " << row.method << ": " << row.error << ' ' << row.further.back().second;
    }
}

TEST(AnalyticCase, ErrorsCoverTheReceiversAndTheRequestedPart) {
  AnalyticCase one;
  one.exact_lx = {100, 10, 0.01};
  TransportMatrix matrix;
  matrix.lux_per_level = Eigen::Vector3d(101, 10, 0.02);
  matrix.direct_lux_per_level = Eigen::Vector3d(50, 10, 0);
  // The third error is relative to a thousandth of the brightest: 0.01 / 0.1.
  EXPECT_NEAR(error_of(one, matrix).worst, 0.1, 1e-12);
  EXPECT_NEAR(error_of(one, matrix).rms, std::sqrt((0.01 * 0.01 + 0.1 * 0.1) / 3), 1e-12);
  one.part = AnalyticCase::Part::direct;
  EXPECT_NEAR(error_of(one, matrix).worst, 0.5, 1e-12);
  one.part = AnalyticCase::Part::reflected;
  EXPECT_NEAR(error_of(one, matrix).worst, 1.0, 1e-12);
  matrix.lux_per_level(1, 0) = std::nan("");
  one.part = AnalyticCase::Part::total;
  EXPECT_TRUE(std::isnan(error_of(one, matrix).worst));
  EXPECT_TRUE(std::isnan(error_of(one, matrix).rms));
}

TEST(AnalyticCase, FewerReceiversAreSpreadOverAllAndKeepTheirExactLux) {
  AnalyticCase one;
  for (int i = 0; i < 10; ++i) {
    one.receivers.push_back({Vec3(i, 0, 0), Vec3::UnitZ()});
    one.exact_lx.push_back(100.0 + i);
  }
  const AnalyticCase few = with_receivers(one, 3);
  ASSERT_EQ(few.receivers.size(), 3u);
  EXPECT_EQ(few.exact_lx, (std::vector<double>{101, 105, 108}));
  for (std::size_t r = 0; r < 3; ++r) EXPECT_EQ(few.receivers[r].position_world_m.x(), few.exact_lx[r] - 100);
  EXPECT_EQ(with_receivers(one, 10).exact_lx, one.exact_lx);
  EXPECT_EQ(with_receivers(one, 99).exact_lx, one.exact_lx);
}

TEST(TransportCase, ErrorIsRelativeToTheLuxOrToOnePercentOfItsMean) {
  Eigen::VectorXd lux(2), reference(2);
  reference << 199, 1;
  lux << 199, 2;
  const RoomError error = error_of(lux, reference);
  EXPECT_NEAR(error.rms, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(error.bias, 0.5, 1e-12);
  reference << 200, 0;
  lux << 190, 1;
  EXPECT_NEAR(error_of(lux, reference).bias, (1.0 - 0.05) / 2, 1e-12);
}

TEST(TransportCase, HashDistinguishesGeometryMaterialLampAndReceiver) {
  const LitRoom room = make_box_room();
  EXPECT_EQ(hash_of(room), hash_of(make_box_room()));
  std::set<std::uint64_t> hashes = {hash_of(room), hash_of(make_box_room(2))};
  LitRoom other = room;
  other.scene.vertices_m[7].x() += 1e-4f;
  hashes.insert(hash_of(other));
  other = room;
  other.scene.materials[1].reflectance_rgb.x() += 0.01;
  hashes.insert(hash_of(other));
  other = room;
  other.emitters[0].intensity = make_isotropic(901);
  hashes.insert(hash_of(other));
  other = room;
  other.emitters[0].world_from_lamp.translation_m.y() += 0.01;
  hashes.insert(hash_of(other));
  other = room;
  other.receivers[3].normal_world = -other.receivers[3].normal_world;
  hashes.insert(hash_of(other));
  EXPECT_EQ(hashes.size(), 7u);
}

TEST(TransportCase, RadianceGetsEveryTriangleLampAndReceiver) {
  const auto folder = fresh_folder("luxrig-radiance");
  const LitRoom room = make_box_room();
  EXPECT_EQ(export_for_radiance(room, folder), "");
  // A line per material and triangle, three per lamp, and the heading.
  EXPECT_EQ(lines_of(folder / "box.rad"),
            1 + room.scene.materials.size() + room.scene.triangles.size() + 3 * room.emitters.size());
  EXPECT_EQ(lines_of(folder / "box.pts"), room.receivers.size());
  EXPECT_EQ(lines_of(folder / "box-lamp0.dat"), 2u + 181u);
  // Candela of the isotropic lamp, at every degree.
  std::ifstream in(folder / "box-lamp0.dat");
  std::string heading;
  std::getline(in, heading);
  std::getline(in, heading);
  for (double cd = 0; in >> cd;) EXPECT_NEAR(cd, 900 / (4 * kPi), 1e-6);
  EXPECT_NE(export_for_radiance(room, "/proc/no-such-folder"), "");
}

}  // namespace
}  // namespace luxrig
