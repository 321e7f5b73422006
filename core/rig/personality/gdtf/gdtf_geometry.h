#pragma once
/// The geometry tree of a GDTF mode, with references expanded. Private to core/rig/personality.
///
/// Frames, by DIN SPEC 15800 ("Matrix", "Axis", "Beam"): a Position is a 4 × 4 matrix, written row by row. It maps the
/// geometry's frame to its parent's; its fourth column is the translation in metres. Seen from the front, X points
/// right, Y away from the viewer, Z up. The fixture hangs with the origin in the middle of its base plate. An Axis
/// turns about its own origin: pan about z, tilt about x. A Beam shines along -z, with y up. So the pivot of a head
/// (position_m of a rig file) is the origin of its tilt geometry in the base.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/rig/personality/personality.h"
#include "core/rig/personality/xml_file.h"

namespace luxrig {

/// A geometry in the fixture. One inside a referenced geometry occurs once per reference.
struct GdtfInstance {
  GeometryInstance geometry;
  std::string defined_as;                        ///< name of the geometry that channels in the file refer to
  Pose parent_from_self;                         ///< at physical 0
  std::map<int, int> added_by_break;             ///< slots that its references add to an offset, by break
  std::optional<std::pair<int, int>> overwrite;  ///< break and added slots for channels whose break is "Overwrite"
};

/// Depth first, a parent before its children; the first is the mode's own geometry. Problems: a missing geometry, a
/// reference that leads nowhere or to itself, more than 4096 geometries.
[[nodiscard]] std::vector<GdtfInstance> gdtf_instances(const XmlFile& xml, const pugi::xml_node& geometries,
                                                       const std::string& root_name, const FilePosition& in_file,
                                                       ProblemList& problems);

/// Sets the mode's pan and tilt offsets and where its light leaves, from the geometries that pan and tilt turn; or what
/// is wrong with its axes. In GDTF, pan turns about its geometry's z, tilt about x, and light leaves along -z.
void set_gdtf_axes(const std::vector<GdtfInstance>& instances, std::optional<std::size_t> pan,
                   std::optional<std::size_t> tilt, PersonalityMode& mode);

}  // namespace luxrig
