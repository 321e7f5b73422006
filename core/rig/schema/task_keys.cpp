// Keys for goals: points, tasks, where lights may hang.
#include "core/rig/schema/key_tables.h"

namespace luxrig::schema {
namespace {

using enum ValueType;

constexpr Bounds kLux{0, 1e7};
constexpr Bounds kLights{1, 1000};
constexpr Bounds kWeight{0, 1000};

constexpr KeySpec kTaskKeys[] = {
    {"point", "name", name, "", kRequired, kAny, "", R"("table top")", "name of the point"},
    {"point", "position_m", vector3, "m", kRequired, kPosition, "", "[1, 1, 0.8]", "where it is"},
    {"point", "normal", vector3, "", "[0, 0, 1]", kPosition, "", "[0, 1, 1]",
     "out of the lit side, of any length but 0"},
    {"point",
     "goal_lx",
     number,
     "lx",
     kNone,
     {0, 1e7, true},
     "",
     "300",
     "wanted illuminance; left out, it is only reported. To keep a place dark, use `max_lx`"},
    {"point", "goal_xy", chromaticity, "", kNone, kChromaticity, "", "[0.4, 0.38]",
     "wanted chromaticity (CIE 1931), beside `goal_lx`; once one goal has a colour, all that count must"},
    {"point", "goal_cct_k", number, "K", kNone, kKelvin, "", "3000",
     "the same as that of a black body; instead of `goal_xy`"},
    {"point", "weight", number, "", "1", {0, 1e6}, "", "2", "how much its goal counts against others"},
    {"point", "max_lx", number, "lx", kNone, kLux, "", "400", "never more than this; it wins over any goal"},
    {"point",
     "goal_tolerance",
     number,
     "",
     kNone,
     {0, 0.5, true},
     "",
     "0.25",
     "how far, as a share of its goal, the light may be off for the goal to count as met; left out, as `[control]` "
     "says"},

    {"points", "file", file, "", kRequired, kAny, "", R"("points.csv")", "CSV file; see The points file"},

    {"surface_goal", "name", name, "", kRequired, kAny, "", R"("drawing")", "name of the painted light"},
    {"surface_goal", "strokes", text, "", kRequired, kAny, "", R"("drawing.json")",
     "file with its strokes, which `luxrig paint` writes; the points that follow from them are in a CSV file of the "
     "same name beside it"},
    {"surface_goal", "max_lx", number, "lx", kNone, kLux, "", "200", "never more than this at its points"},
    {"surface_goal", "weight", number, "", "1", {0, 1e6}, "", "2", "how much it counts against other goals"},
    {"surface_goal", "goal_xy", chromaticity, "", kNone, kChromaticity, "", "[0.4, 0.38]",
     "wanted chromaticity (CIE 1931) of its light; once one goal has a colour, all that count must"},
    {"surface_goal", "goal_cct_k", number, "K", kNone, kKelvin, "", "3000",
     "the same as that of a black body; instead of `goal_xy`"},
    {"surface_goal",
     "uniformity",
     number,
     "",
     kNone,
     {0, 1, true},
     "",
     "0.6",
     "wanted lowest over mean illuminance at its points (U0 of EN 12464-1): reported beside its goals"},
    {"surface_goal",
     "goal_tolerance",
     number,
     "",
     kNone,
     {0, 0.5, true},
     "",
     "0.25",
     "how far, as a share of its goal, the light may be off at its points; left out, as `[control]` says"},
    {"surface_goal", "patch_m", number, "m", "0.1", {0.001, 10}, "", "0.05", "size of the patches that strokes cover"},
    {"surface_goal",
     "min_spacing_m",
     number,
     "m",
     "0.2",
     {0, 1000, true},
     "",
     "0.1",
     "distance of its points where it has most detail"},
    {"surface_goal", "max_spacing_m", number, "m", "1", {0, 1000, true}, "", "0.5", "and where it has none"},

    {"task", "name", name, "", kRequired, kAny, "", R"("levels")", "name of the task"},
    {"task", "kind", text, "", kRequired, kAny, "emittance, placement, aim, highlight, directions", R"("emittance")",
     "`emittance`: the level of every fixture; `placement`: where further lights should hang, and their levels; `aim`: "
     "where heads that hang look and how bright they are, so that an object's relief reads; `highlight`: where further "
     "lights should hang for that; `directions`: from where a lamp that a person carries should light the object for "
     "that, which sets nothing"},
    {"task",
     "max_watts",
     number,
     "W",
     kNone,
     {0, 1e9},
     "",
     "100",
     "most electrical power of the lights that this task sets or places, taken as rated `watts` times level; every "
     "luminaire of theirs must have `watts`"},
    {"task", "luminaire", text, "", kNone, kAny, "", R"("track spot")",
     "name of the `[[luminaire]]` to place (kind `placement` and `highlight`; required there)"},
    {"task", "lights", whole_number, "", kNone, kLights, "", "4",
     "how many (kind `placement`, `highlight` and `directions`); left out, as few as will do, or until contrast rises "
     "no more"},
    {"task", "max_lights", whole_number, "", kNone, kLights, "", "7",
     "most of them, when `lights` is left out; left out too, 20 (`placement`), 8 (`highlight`) or 4 (`directions`)"},
    {"task", "error_wanted", number, "", "0.001", kShare, "", "0.02",
     "normalised error at which the search ends: root mean square of what is missing over that of the goals (only with "
     "kind `placement`, as all keys from here to `bound`)"},
    {"task",
     "improvement",
     number,
     "",
     "0.05",
     {0, 1, false, true},
     "",
     "0.1",
     "share of the error that one more light must take away to be worth hanging, when `lights` is left out"},
    {"task", "method", text, "", R"("luxrig")", kAny, "luxrig, gpk15, gp16", R"("gp16")",
     "how places are searched. `luxrig`: one light after the other, all refined together, taken out and put back; the "
     "others are those of the thesis that luxrig began with (`gpk15` needs `lights`)"},
    {"task", "aimed", yes_no, "", "false", kAny, "", "true",
     "whether lights may look anywhere, which is searched with their places; else they hang straight down"},
    {"task", "indirect", yes_no, "", "true", kAny, "", "false",
     "whether the search counts reflected light, too, which takes longer; predicted lux always do"},
    {"task", "fixtures", text, "", R"("as-set")", kAny, "as-set, off, full", R"("off")",
     "what the rig's own fixtures do meanwhile: what the tasks before this one have set (dark, where none has), dark, "
     "or the most they may give"},
    {"task",
     "seconds",
     number,
     "s",
     kNone,
     {0, 86400, true},
     "",
     "5",
     "ends the search after this time with the best so far; left out, after a fixed amount of work, so that the result "
     "does not depend on the machine"},
    {"task",
     "energy_front",
     whole_number,
     "",
     "0",
     {0, 100},
     "",
     "3",
     "so many power limits, falling evenly from what the lights found take, are searched with, too: what each watt "
     "less "
     "costs in error"},
    {"task", "bound", yes_no, "", "false", kAny, "", "true",
     "whether to prove, too, how close as many lights could come at all (seconds to a minute); how close any number "
     "could is always worked out where the goal was not reached"},
    {"task", "object", text, "", kNone, kAny, "", R"("vase")",
     "name of the `[[scene.object]]`, a mesh, whose relief shall read (kind `aim`, `highlight` and `directions`; "
     "required there)"},
    {"task",
     "scale_mm",
     number,
     "mm",
     kNone,
     {0, 1e5, true},
     "",
     "4",
     "size of the relief that counts (kind `aim`, `highlight` and `directions`): radius of the fits that give its "
     "curvature; left "
     "out, from the mesh"},
    {"task",
     "interest",
     number,
     "",
     "0.1",
     {0, 1, true},
     "",
     "0.2",
     "share of its surface that counts, the most recessed first (kind `aim`, `highlight` and `directions`)"},
    {"task", "seen_by", text, "", kNone, kAny, "", R"("front")",
     "name of a `[[camera]]`: only what it sees of the relief counts (kind `aim`, `highlight` and `directions`); "
     "left out, all sides"},
    {"task", "max_object_lx", number, "lx", kNone, kLux, "", "900",
     "never more than this anywhere on the object (kind `aim` and `highlight`)"},
    {"task", "objective", text, "", R"("thesis")", kAny, "thesis, seen", R"("seen")",
     "what is made large (kind `aim` and `highlight`): contrast at its recessed places and their coverage (`thesis`); "
     "or what an eye or a camera at one exposure gets of its form, relief and outline, without burnt and black parts "
     "(`seen`), from the camera of `seen_by` or from three sides"},
    {"task", "role", text, "", R"("any")", kAny, "any, key, fill, rim, background", R"("key")",
     "what this task's lights are to the object, beside the light of the tasks before (kind `aim` and `highlight`, "
     "with "
     "objective `seen`). `key`: what shows its form. `fill`: lifts what the light before leaves dark. `rim`: from "
     "behind, along its outline as `seen_by` sees it. `background`: what is behind it, not the object. A light that is "
     "left out of `heads` keeps its level and counts as light that is there: so a person sets some by hand, and the "
     "rest is solved"},
    {"task",
     "ratio",
     number,
     "",
     kNone,
     {0, 1e4, true},
     "",
     "4",
     "key to this role's mean illuminance; of the key, its own to all other light; needs `role`. The key is the light "
     "that is there, where it lights the object at least as its mean. Left out: any (`key`), 3 (`fill`, with the light "
     "that is already in the dark parts), 1 (`rim`), 2 (`background`)"},
    {"task", "set_up", text, "", R"("none")", kAny, "none, rembrandt, loop, split, broad, raking, copy", R"("loop")",
     "where the key light stands, as photographers say (kind `aim`, `highlight` and `directions`; needs `seen_by` and, "
     "unless kind is `directions`, objective `seen`). Degrees aside of the camera, around the vertical, and above the "
     "level, from the object's middle: `rembrandt` 30 to 60 and 30 to 60; `loop` 30 to 45 and 10 to 35; `split` 80 to "
     "100 and -15 to 30; `broad` 30 to 60 and 10 to 50, on the side that lights more of what is seen. `raking`: 5 to "
     "15 off the surface. `copy`: two lights, 40 to 50 from straight before the surface on either side, even. One "
     "light (`copy`: two); refused if none can be there"},
    {"task", "contrast", text, "", R"("relative")", kAny, "lux, relative", R"("lux")",
     "which contrast objective `thesis` makes large (only with kind `aim`): the difference in illuminance to what is "
     "beside it, in `lux`, or `relative` to both, as an eye or a camera sees that adapts; then lights are as bright as "
     "limits let them"},
    {"task", "coverage_weight", number, "", "0.25", kWeight, "", "0.5",
     "what it is worth that every feature has a shadow's edge, beside contrast (kind `aim` and `highlight`, with "
     "objective `thesis`)"},
    {"task", "fine_weight", number, "", "1", kWeight, "", "2",
     "how much relief counts of what is seen, over its usual weight (kind `aim` and `highlight`, with objective "
     "`seen`, as all keys down to `max_clipped`)"},
    {"task", "form_weight", number, "", "1", kWeight, "", "2", "the same of broad shapes"},
    {"task", "lit_weight", number, "", "1", kWeight, "", "2", "the same of how much of the object is lit"},
    {"task", "edge_weight", number, "", "1", kWeight, "", "2", "the same of its outline against what is behind it"},
    {"task", "even_weight", number, "", "0", kWeight, "", "1",
     "the same of even light, as for documentation; 1 = as much as the lit share"},
    {"task", "shadow_weight", number, "", "0", kWeight, "", "1",
     "the same against double and crossing shadows, which a second light draws on the object; 1 = shadows as long as "
     "the object is wide cost as much as the lit share is worth"},
    {"task",
     "max_clipped",
     number,
     "",
     "0.02",
     {0, 1},
     "",
     "0.1",
     "share of what is seen of the object that may be burnt or black without cost"},
    {"task",
     "distance_m",
     number,
     "m",
     "1.5",
     {0, 1e4, true},
     "",
     "2",
     "how far from the middle of the object the lamp is held; directions in which another thing stands nearer are left "
     "out (only with kind `directions`)"},
    {"task", "heads", texts, "", kNone, kAny, "", R"(["head-*"])",
     "fixtures to aim and dim, by name (`*` and `?`); left out, all that move. One that does not move is only "
     "dimmed; one with emitters is one light, its emitters at one level (only with kind `aim`, as all keys below)"},
    {"task", "cct_k", number, "K", kNone, kKelvin, "", "3000",
     "colour temperature of its light, mixed of the emitters of its heads; left out, all emitters alike. A head "
     "without "
     "emitters keeps its own. So a key can be warm and a fill cool"},
    {"task", "key", text, "", kNone, kAny, "", R"("head-1")", "the fixture that is the key light"},
    {"task",
     "min_key_to_fill",
     number,
     "",
     "1",
     {0, 1e6},
     "",
     "2",
     "least of its mean illuminance of the relief over that of all other light; needs `key`"},
    {"task", "max_key_to_fill", number, "", kNone, {0, 1e6, true}, "", "8", "the same, most; needs `key`"},
    {"task", "eyes", texts, "", kNone, kAny, "", R"(["floor"])",
     "points that stand for the eyes of an audience, by name (`*` and `?`): light counts from wherever it comes; "
     "cameras are eyes, too"},
    {"task", "max_eye_lx", number, "lx", kNone, {0, 1e7, true}, "", "30", "most direct light at an eye or a camera"},
    {"task", "base_lx", number, "lx", "0", kLux, "", "20", "illuminance that all of the relief should have"},
    {"task", "base_weight", number, "", "1", kWeight, "", "0.1", "what that is worth"},
    {"task", "energy_weight", number, "", "0", kWeight, "", "0.3", "what saving all power would be worth; needs watts"},
    {"task", "travel_weight", number, "", "0.01", kWeight, "", "0.02", "what a second of movement less is worth"},

    {"mounting", "box_m", box, "m", kNone, kPosition, "", "[[0, 0, 2], [4, 5, 3]]",
     "two opposite corners of a box that lights stay in; left out, the scene's bounding box"},
    {"mounting", "surfaces", texts, "", kNone, kAny, "", R"(["ceiling*", "beam"])",
     "materials or scene objects that lights hang off, by name; `*` stands for any letters, `?` for one; left "
     "out, anywhere in the air"},
    {"mounting",
     "offset_m",
     span2,
     "m",
     "[0.05, 0.15]",
     {0.001, 1000},
     "",
     "[0.1, 0.2]",
     "least and largest distance of a light's middle from those surfaces, on both of their sides (only with "
     "`surfaces`)"},
    {"mounting",
     "clearance_m",
     number,
     "m",
     "0.1",
     {0, 1000},
     "",
     "0.3",
     "least distance of a light's middle from all (other) surfaces"},
    {"mounting",
     "spacing_m",
     number,
     "m",
     kNone,
     {0.001, 1000},
     "",
     "0.25",
     "of the lattice of places that are tried first; lights then move freely. Left out, about 20 000 places in the "
     "air, 5 000 off surfaces; at most 1 000 000"},
};

}  // namespace

std::span<const KeySpec> task_keys() { return kTaskKeys; }

}  // namespace luxrig::schema
