#pragma once
/// Made-up rooms with lamps and points to light, in which evaluators are measured and compared. Each room is the same
/// for the same arguments. It is built of closed solids only (walls have thickness, doors stand ajar), with
/// reflectances as in real rooms and a few saturated colours.

#include <cstdint>
#include <string>
#include <vector>

#include "core/transport/evaluator.h"

namespace luxrig {

struct LitRoom {
  std::string name;
  Scene scene;
  std::vector<Emitter> emitters;
  std::vector<Receiver> receivers;  ///< none inside a solid; those on a surface are 1 mm in front of it
  /// Its air, in which lamps hang. Empty if the room does not state it.
  Eigen::AlignedBox3d interior_m{};
  /// Parts that can be lit separately: rooms of a flat, aisles of a hall. They do not overlap.
  std::vector<Eigen::AlignedBox3d> regions_m{};
};

/// A furnished room of 4 × 3 × 2.5 m, closed: about 130 triangles, a pendant and a spot, 60 receivers.
[[nodiscard]] LitRoom make_box_room(std::uint64_t seed = 1);

/// Eight rooms along a hallway, doors ajar, 14.6 × 9.4 × 2.6 m, closed: about 600 triangles, ten bare lamps 15 to 30 cm
/// below a light ceiling, 300 receivers on the work plane, floors and desks.
[[nodiscard]] LitRoom make_eight_room_flat(std::uint64_t seed = 1);

/// An exhibition hall of 20 × 12 × 4.5 m, closed: partition walls, 24 framed pictures and ten sculptures on plinths,
/// about 38 000 triangles, twelve spots on tracks, 300 receivers on walls, pictures and plinths. `polished`: floor and
/// pictures are glossy.
[[nodiscard]] LitRoom make_gallery_hall(std::uint64_t seed = 1, bool polished = false);

/// Four storeys of balconies around a court of 30 × 20 × 14 m with columns, stairs and trees: about 9 000 triangles, 46
/// lamps, 300 receivers on all storeys. The roof has an opening of 10 × 5 m. `sky`, if given, is the last emitter.
[[nodiscard]] LitRoom make_atrium(std::uint64_t seed = 1, const Sky& sky = nullptr);

/// An open-plan office of 16 × 11 × 2.8 m with two cells, closed: desks in groups of four behind screens, cupboards,
/// pillars, about 3 000 triangles, nine bare lamps, 300 receivers on desks and floor.
[[nodiscard]] LitRoom make_open_plan_office(std::uint64_t seed = 1);

/// Round tunnels of 2 m radius with flat floors, walled in. Eight of them, about 75 m in total, branch and close one
/// ring: about 24 000 triangles, eleven bare lamps, 300 receivers on the floors.
[[nodiscard]] LitRoom make_sewers(std::uint64_t seed = 1);

/// Walks behind arcades around an open court of 16 × 16 m, with a statue on a pedestal in its middle: about 23 000
/// triangles, sixteen bare lamps, 240 receivers on the walks' floor, 60 on the statue.
[[nodiscard]] LitRoom make_cloister(std::uint64_t seed = 1);

/// Nine halls on each of two storeys, 30 × 20 × 9.6 m, closed, with doorways between them and a void over a statue in
/// the middle: exhibits on plinths, partitions, benches, about 80 000 triangles, 18 bare lamps, 60 receivers on the
/// lower floor, 240 on the upper, 60 on pedestal and statue.
[[nodiscard]] LitRoom make_museum(std::uint64_t seed = 1);

/// One room of 10 × 7 × 3 m, closed. A wall of shelves with books separates the bed from the living room; there are
/// plants, vases and a knotted sculpture: about 140 000 triangles, two bare lamps, 300 receivers on floor and
/// furniture.
[[nodiscard]] LitRoom make_studio(std::uint64_t seed = 1);

/// Arcades on two storeys around a long open court, 30 × 13 × 12 m in total, with cloth hung between the columns: about
/// 55 000 triangles, 22 bare lamps, 300 receivers on the floors of court and galleries.
[[nodiscard]] LitRoom make_colonnades(std::uint64_t seed = 1);

}  // namespace luxrig
