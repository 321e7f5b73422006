#pragma once
/// Made-up rooms with lamps and points to light: what evaluators are measured on and compared in. Each is the same for
/// the same arguments, is built of closed solids only (walls have thickness, doors stand ajar), and has reflectances as
/// real rooms have them, with a few saturated colours.

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
};

/// A furnished room of 4 × 3 × 2.5 m, closed: about 130 triangles, a pendant and a spot, 60 receivers.
[[nodiscard]] LitRoom make_box_room(std::uint64_t seed = 1);

/// Eight rooms along a hallway, doors ajar, 14.6 × 9.4 × 2.6 m, closed: about 600 triangles, ten bare lamps 15 to 30 cm
/// below a light ceiling, 300 receivers on the work plane, floors and desks.
[[nodiscard]] LitRoom make_eight_room_flat(std::uint64_t seed = 1);

/// An exhibition hall of 20 × 12 × 4.5 m, closed: partition walls, 24 framed pictures and ten sculptures on plinths,
/// about 38 000 triangles, twelve spots on tracks, 300 receivers on walls, pictures and plinths. `polished` gives the
/// floor and the pictures a gloss.
[[nodiscard]] LitRoom make_gallery_hall(std::uint64_t seed = 1, bool polished = false);

/// Four storeys of balconies around a court of 30 × 20 × 14 m with columns, stairs and trees: about 9 000 triangles, 46
/// lamps, 300 receivers on all storeys. Its roof has an opening of 10 × 5 m; `sky`, when given, is the last emitter.
[[nodiscard]] LitRoom make_atrium(std::uint64_t seed = 1, const Sky& sky = nullptr);

}  // namespace luxrig
