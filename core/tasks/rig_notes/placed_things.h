#pragma once
/// Things that a rig file places, as named in notes. Internal to core/tasks/rig_notes.

#include <fmt/format.h>

#include "core/rig/rig.h"

namespace luxrig {

struct PlacedThing {
  const char* kind;  ///< "fixture", "point" or "luxmeter"
  std::string name;
  Vec3 position_world_m;
  FilePosition in_file;

  [[nodiscard]] std::string text() const { return fmt::format("{} \"{}\"", kind, name); }
};

/// One per housing: if its emitters are set one by one, the first stands for all.
struct PlacedFixture : PlacedThing {
  std::size_t index;  ///< of the rig's fixtures
};
[[nodiscard]] std::vector<PlacedFixture> placed_fixtures(const Rig& rig);

/// The rig's points, then its luxmeters: in the order of receivers_of().
[[nodiscard]] std::vector<PlacedThing> placed_receivers(const Rig& rig);

/// Positions of all of these.
[[nodiscard]] std::vector<Vec3> placed_positions(const Rig& rig);

/// "4.00 x 3.00 x 2.80 m"
[[nodiscard]] std::string size_text(const Vec3& size_m);
/// "x 0.00 to 4.00, y 0.00 to 3.00, z 0.00 to 2.80 m"
[[nodiscard]] std::string extent_text(const Eigen::AlignedBox3d& box_m);
/// "1.00 2.00 0.80"
[[nodiscard]] std::string position_text(const Vec3& position_m);
/// Millimetres up to 10 cm, else metres.
[[nodiscard]] std::string length_text(double length_m);

}  // namespace luxrig
