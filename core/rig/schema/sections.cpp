// Every section of a rig file and of a register map, in the order of REFERENCE.md.
#include "core/rig/schema.h"

namespace luxrig {
namespace {

constexpr auto kInMap = SectionSpec::File::register_map;
constexpr SectionSpec kSections[] = {
    {"rig", false, 1, false, "What the rig is called."},
    {"scene", false, 1, false, "The room: a mesh, and how much light its surfaces send back. Leave it out for a void."},
    {"scene.reflectance", true, 10000, false,
     "Reflectance by material name. The first rule that matches wins, also over colours in the mesh file."},
    {"scene.object", true, 10000, false, "A thing put into the room: a mesh (`file`) or a box (`box_m`)."},
    {"daylight", false, 1, false,
     "Light from outside, through whatever openings the mesh leaves: a sky of the CIE, and the sun. It cannot be "
     "dimmed."},
    {"luminaire", true, 10000, false, "A kind of light: what it sends where, at rated flux. Fixtures name it."},
    {"luminaire.emitters", true, 64, false,
     "Emitters of a luminaire that are set one by one, as the red, green, blue and white of a stage light: each with "
     "its flux and colour, all with the luminaire's distribution, which then has no `lumens`, `watts` or colour of its "
     "own. `emitters = [{ … }, { … }]` on one line is the same."},
    {"bus", true, 1000, true, "A way to reach devices. Every further key is the driver's own: see Bus options."},
    {"fixture", true, 10000, false,
     "A luminaire as hung and patched: over DMX (`universe`, `address`, and `slots` or `personality`) or over Modbus "
     "(`unit`, and `register_map` with `channel` or `output`, or `register` with `full_scale`). Its pan and tilt may "
     "be "
     "slots, or drives of their own on another bus (`axes_bus`). Say where it looks by `aim`, by `aim_m`, or by "
     "`pan_deg` and `tilt_deg`."},
    {"luxmeter", true, 10000, false, "A light meter on a Modbus bus. It stands at a `point`, or at `position_m`."},
    {"camera", true, 100, false,
     "Takes pictures of the rig. A real one has a `source`; without, only the simulated rig takes its pictures. An "
     "`aim` task keeps light out of all."},
    {"point", true, 100000, false, "A place whose illuminance matters, on the side its normal points to."},
    {"points", false, 1, false, "Further points, from a table."},
    {"task", true, 1000, false, "What to work out. Without one: an `emittance` task called `levels`."},
    {"mounting", false, 1, false,
     "Where a `placement` or `highlight` task may hang lights. Without it: in the air within the scene's bounding box, "
     "0.1 m off "
     "everything. Places behind closed surfaces, from which no light gets to a point with a goal, cost nothing."},
    {"keep_out", true, 1000, false,
     "A region that no lit beam of a head may meet: an audience, a camera, a mirror. A box (`box_m`), or a sphere "
     "round "
     "`centre_m`. The beam counts to its field angle, zoomed as it is, through walls, and however far. What happens "
     "then: core/show/NOTES.md."},
    {"limits", false, 1, false, "What holds for the whole rig."},
    {"control", false, 1, false, "How looks change, and how readings correct them."},
    {"safe", false, 1, false, "What the light does when something fails."},
    {"startup", false, 1, false,
     "How light comes on the first time after the daemon has started, so that lamps do not all strike in one instant. "
     "Without it nothing is staged. Blackout and the safe look never wait for it."},
    {"daemon", false, 1, false, "The program that keeps the rig running."},
    {"device", false, 1, false,
     "In a register map, not in a rig file: a product with Modbus registers, its limits, and what it does when data "
     "stops. Files of some products are in `rigs/register-maps`.",
     kInMap},
    {"register", true, 2000, false,
     "In a register map: a number that the product keeps, in one register or two. Only what a `level` or an "
     "`illuminance` is matters for control; the others say what else is there.",
     kInMap},
    {"setup", true, 100, false,
     "In a register map: what is written to the product before anything else, in this order, whenever it may have "
     "restarted; a watchdog is armed this way.",
     kInMap},
};

}  // namespace

std::span<const SectionSpec> sections() { return kSections; }

}  // namespace luxrig
