#include "core/transport/candidates/reflected/surface_cells.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/core/transport/candidates/box_rooms.h"

namespace luxrig {
namespace {

TEST(SurfaceCells, AWallSeparatesTheFloorBeneathIt) {
  const Scene scene = two_rooms(0.5, false);
  const RayScene rays(scene);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  // Cells far larger than the thickness of the wall.
  for (int trial = 0; trial < 20; ++trial) {
    SurfaceCells cells(scene, rays, 0.6, {unit(random), unit(random), unit(random)});
    std::set<std::uint32_t> left, right;
    std::vector<std::pair<Vec3, std::uint32_t>> places;
    for (int i = 0; i < 400; ++i) {
      const bool on_left = i % 2 == 0;
      const Vec3 at(on_left ? 3.4 + 0.6 * unit(random) : 4.15 + 0.6 * unit(random), 3 * unit(random), 0);
      const auto cell = cells.cell_at(at, Vec3::UnitZ(), 10'000, SurfaceCells::Found::from_surface);
      (on_left ? left : right).insert(cell);
      places.emplace_back(at, cell);
    }
    for (const std::uint32_t cell : left) EXPECT_FALSE(right.contains(cell));
    EXPECT_LT(left.size(), 30u);
    // Every place is found again, never across the wall.
    std::uint64_t cast = 0;
    for (const auto& [at, cell] : places) {
      const auto found = cells.find(at, Vec3::UnitZ(), cast);
      EXPECT_TRUE((at.x() < 4 ? left : right).contains(found));
    }
    EXPECT_EQ(cells.find({1, 2.7, 0}, Vec3::UnitZ(), cast), SurfaceCells::kNone) << "where no ray has been";
  }
}

TEST(SurfaceCells, TheSidesOfAThinObjectAreSeparate) {
  const Scene scene = two_rooms(0.5, true);
  const RayScene rays(scene);
  SurfaceCells cells(scene, rays, 0.5, Vec3::Constant(0.3));
  const auto above = cells.cell_at({1.7, 1.4, 0.75}, Vec3::UnitZ(), 100, SurfaceCells::Found::from_surface);
  const auto below = cells.cell_at({1.7, 1.4, 0.70}, -Vec3::UnitZ(), 100, SurfaceCells::Found::from_surface);
  EXPECT_NE(above, below);
  EXPECT_EQ(cells.cell_at({1.71, 1.41, 0.75}, Vec3::UnitZ(), 100, SurfaceCells::Found::from_surface), above);
  EXPECT_EQ(cells.cells()[above].hits_from_surfaces, 2u);
  EXPECT_EQ(cells.cell_at({3, 2.9, 0}, Vec3::UnitZ(), 2, SurfaceCells::Found::from_surface), SurfaceCells::kNone)
      << "no more than were allowed";
}

}  // namespace
}  // namespace luxrig
