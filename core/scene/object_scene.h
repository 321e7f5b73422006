#pragma once
/// One object out of a venue, and the venue without it.

#include <string_view>

#include "core/result.h"
#include "core/scene/scene.h"

namespace luxrig {

/// The triangles of the object of this name, in their order, with the vertices and materials they use, about the middle
/// of its bounding box. Vertices lie where they lay in the venue, to half an ulp of a coordinate relative to the new
/// origin. object_names has the one name. Also of an object without triangles (a cloud of points): then none, about the
/// venue's origin. Refuses a name that no object has, with the nearest one.
[[nodiscard]] Result<Scene> object_scene(const Scene& scene, std::string_view name);

/// All the others: what stands around it. Vertices, materials, names and origin stay as they are. Refuses likewise.
[[nodiscard]] Result<Scene> scene_without_object(const Scene& scene, std::string_view name);

}  // namespace luxrig
