// Every section of a rig file, a register map and a scenario, in the order of REFERENCE.md.
#include "core/rig/schema.h"

namespace luxrig {
namespace {

constexpr auto kInMap = SectionSpec::File::register_map, kInScenario = SectionSpec::File::scenario;
constexpr SectionSpec kSections[] = {
    {"rig", false, 1, false},
    {"scene", false, 1, false},
    {"scene.reflectance", true, 10000, false},
    {"scene.object", true, 10000, false},
    {"daylight", false, 1, false},
    {"luminaire", true, 10000, false},
    {"luminaire.emitters", true, 64, false},
    {"bus", true, 1000, true},
    {"fixture", true, 10000, false},
    {"luxmeter", true, 10000, false},
    {"camera", true, 100, false},
    {"point", true, 100000, false},
    {"points", false, 1, false},
    {"surface_goal", true, 1000, false},
    {"task", true, 1000, false},
    {"mounting", false, 1, false},
    {"keep_out", true, 1000, false},
    {"limits", false, 1, false},
    {"control", false, 1, false},
    {"safe", false, 1, false},
    {"startup", false, 1, false},
    {"daemon", false, 1, false},
    {"device", false, 1, false, kInMap},
    {"register", true, 2000, false, kInMap},
    {"setup", true, 100, false, kInMap},
    {"scenario", false, 1, false, kInScenario},
    {"event", true, 1000, false, kInScenario},
    {"expect", true, 1000, false, kInScenario},
};

}  // namespace

std::span<const SectionSpec> sections() { return kSections; }

}  // namespace luxrig
