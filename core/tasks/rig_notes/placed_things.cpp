#include "core/tasks/rig_notes/placed_things.h"

namespace luxrig {

std::vector<PlacedFixture> placed_fixtures(const Rig& rig) {
  std::vector<PlacedFixture> placed;
  for (std::size_t i = 0; i < rig.fixtures.size(); ++i) {
    const Fixture& fixture = rig.fixtures[i];
    if (fixture.housing.value_or(i) != i) continue;
    const std::string name = fixture.housing ? fixture.name.substr(0, fixture.name.rfind('/')) : fixture.name;
    placed.push_back({{"fixture", name, fixture.world_from_lamp().translation_m, fixture.in_file}, i});
  }
  return placed;
}

std::vector<PlacedThing> placed_receivers(const Rig& rig) {
  std::vector<PlacedThing> placed;
  for (const luxrig::Point& point : rig.points)
    placed.push_back({"point", point.name, point.position_world_m, point.in_file});
  for (const Luxmeter& meter : rig.luxmeters)
    placed.push_back({"luxmeter", meter.name, meter.position_world_m, meter.in_file});
  return placed;
}

std::vector<Vec3> placed_positions(const Rig& rig) {
  std::vector<Vec3> positions;
  for (const PlacedFixture& fixture : placed_fixtures(rig)) positions.push_back(fixture.position_world_m);
  for (const PlacedThing& receiver : placed_receivers(rig)) positions.push_back(receiver.position_world_m);
  return positions;
}

std::string size_text(const Vec3& size_m) {
  const auto text = [](double m) { return fmt::format("{:.{}f}", m, m < 0.1 ? 4 : 2); };
  return fmt::format("{} x {} x {} m", text(size_m.x()), text(size_m.y()), text(size_m.z()));
}

std::string extent_text(const Eigen::AlignedBox3d& box_m) {
  const Vec3 &a = box_m.min(), &b = box_m.max();
  return fmt::format("x {:.2f} to {:.2f}, y {:.2f} to {:.2f}, z {:.2f} to {:.2f} m", a.x(), b.x(), a.y(), b.y(), a.z(),
                     b.z());
}

std::string position_text(const Vec3& position_m) {
  const Vec3 mm = (1000 * position_m).array().round() + 0.0;  // no negative zero
  return fmt::format("{:.3f} {:.3f} {:.3f}", mm.x() / 1000, mm.y() / 1000, mm.z() / 1000);
}

std::string length_text(double length_m) {
  return length_m < 0.1 ? fmt::format("{:.1f} mm", 1000 * length_m) : fmt::format("{:.2f} m", length_m);
}

}  // namespace luxrig
