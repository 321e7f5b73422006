// Finds the nearest record and neighbouring records, compared with a search through all records.
#include "core/transport/paths/irradiance_records.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace luxrig {
namespace {

using Vertex = IrradianceRecords::Vertex;

/// Random places on a floor of 6 m by 4 m, scaled, from a corner.
std::vector<Vertex> scattered(std::mt19937_64& random, std::size_t count, const Vec3& about_m, double scale) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vertex> places;
  for (std::size_t i = 0; i < count; ++i)
    places.push_back({about_m + scale * Vec3(6 * unit(random), 4 * unit(random), 0), Vec3::UnitZ(), 0});
  return places;
}

TEST(IrradianceRecords, NearestMatchesAnExhaustiveSearch) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const std::size_t count : {1u, 2u, 7u, 400u}) {
      const Vec3 about_m = Vec3(10, -20, 3) * scale;
      const std::vector<Vertex> places = scattered(random, count, about_m, scale);
      IrradianceRecords records;
      // Appended in two steps, as records grow.
      records.append(std::span(places).first(count / 2), 3);
      records.append(std::span(places).subspan(count / 2), 3);
      ASSERT_EQ(records.size(), count);
      int found = 0;
      for (int i = 0; i < 500; ++i) {
        const Vec3 from_m = about_m + scale * Vec3(6 * unit(random), 4 * unit(random), 0);
        const auto nearest = records.nearest(from_m, Vec3::UnitZ());
        double min_m = HUGE_VAL;
        for (const Vertex& place : places) min_m = std::min(min_m, (place.position_world_m - from_m).norm());
        if (!nearest) continue;
        ++found;
        ASSERT_NEAR(nearest->distance_m, min_m, 1e-5 * scale) << count << " records at scale " << scale;
        ASSERT_NEAR((records.place(nearest->record).position_world_m - from_m).norm(), min_m, 1e-5 * scale);
      }
      // The nearest is at most one and a half spacings away.
      EXPECT_EQ(found, count == 400 ? 500 : found);
      EXPECT_FALSE(records.nearest(about_m, -Vec3::UnitZ())) << "the other side of the floor";
    }
  }
}

TEST(IrradianceRecords, NeighboursAreMutualAndShareTheirPlane) {
  std::mt19937_64 random(2);
  const double apart_m = 3;
  std::vector<Vertex> places = scattered(random, 300, Vec3::Zero(), 1);
  // A ceiling that looks down, a wall, and a floor above both.
  for (int i = 0; i < 300; ++i) {
    Vertex other = places[static_cast<std::size_t>(i)];
    const int kind = i % 3;
    other.position_world_m.z() = kind == 0 ? apart_m : kind == 1 ? 0.5 * other.position_world_m.y() : 2 * apart_m;
    if (kind == 1) other.position_world_m.y() = 0;
    other.normal_world = kind == 0 ? Vec3(-Vec3::UnitZ()) : kind == 1 ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitZ());
    places.push_back(other);
  }
  IrradianceRecords records;
  records.append(places, 3);
  std::vector<std::uint32_t> beside;
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    records.find_beside(i, beside);
    for (const std::uint32_t j : beside) {
      EXPECT_NE(i, j);
      EXPECT_TRUE(pairs.emplace(i, j).second) << "told once";
      EXPECT_GT(places[i].normal_world.dot(places[j].normal_world), 0.94);
      EXPECT_LT(std::abs((places[i].position_world_m - places[j].position_world_m).dot(places[i].normal_world)), 0.2);
    }
  }
  for (const auto& [i, j] : pairs) EXPECT_TRUE(pairs.contains({j, i})) << i << " and " << j;
  EXPECT_GT(pairs.size(), places.size()) << "one each at least, on average";
}

TEST(IrradianceRecords, AcceptsCoincidentCollinearAndFarPlaces) {
  std::vector<std::uint32_t> beside;
  for (const double offset_m : {0.0, 1e7}) {
    for (const double step_m : {0.0, 1e-9, 1.0}) {
      std::vector<Vertex> places;
      for (int i = 0; i < 50; ++i) places.push_back({Vec3(offset_m + step_m * i, offset_m, 0), Vec3::UnitZ(), 0});
      IrradianceRecords records;
      records.append(places, 6);
      for (std::uint32_t i = 0; i < places.size(); ++i) {
        records.find_beside(i, beside);
        EXPECT_LT(beside.size(), places.size());
        const auto nearest = records.nearest(places[i].position_world_m, Vec3::UnitZ());
        ASSERT_TRUE(nearest);
        EXPECT_NEAR(nearest->distance_m, 0, 1e-6 * std::max(1.0, step_m));
      }
      EXPECT_FALSE(records.nearest(Vec3(-1e12, 1e12, 1e12), Vec3::UnitZ()));
    }
  }
  IrradianceRecords none;
  EXPECT_FALSE(none.nearest(Vec3::Zero(), Vec3::UnitZ()));
}

TEST(IrradianceRecords, AFewOutliersDoNotMergeARoomIntoOneCell) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const double far_m : {10.0, 1e3, 1e4}) {
    std::vector<Vertex> places = scattered(random, 3000, Vec3::Zero(), 1);
    for (int i = 0; i < 30; ++i) places.push_back({far_m * Vec3(unit(random), unit(random), 0), Vec3::UnitZ(), 0});
    IrradianceRecords records;
    records.append(places, 3);
    std::vector<std::uint32_t> beside;
    std::size_t all = 0;
    for (std::uint32_t i = 0; i < 3000; ++i) {
      records.find_beside(i, beside);
      all += beside.size();
      for (const std::uint32_t j : beside)
        EXPECT_LT((places[i].position_world_m - places[j].position_world_m).norm(), 1) << far_m;
    }
    EXPECT_LT(all, 8 * 3000u) << far_m;
    EXPECT_GT(all, 1000u) << far_m << ": and they still learn from each other";
    for (const Vertex& from : scattered(random, 200, Vec3::Zero(), 0.9)) {
      const auto nearest = records.nearest(from.position_world_m, Vec3::UnitZ());
      ASSERT_TRUE(nearest) << far_m;
      double min_m = HUGE_VAL;
      for (const Vertex& place : places)
        min_m = std::min(min_m, (place.position_world_m - from.position_world_m).norm());
      EXPECT_NEAR(nearest->distance_m, min_m, 2e-7 * far_m + 1e-6) << far_m << ": but for rounding to floats";
    }
  }
}

}  // namespace
}  // namespace luxrig
