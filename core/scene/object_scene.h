#pragma once
/// One object of a venue, and the venue without it.

#include <string_view>

#include "core/result.h"
#include "core/scene/scene.h"

namespace luxrig {

/// The triangles of the named object, in order, with their vertices and materials; the origin is the middle of its
/// bounding box. Vertices keep their position in the venue, to half an ulp of a coordinate relative to the new origin.
/// object_names has that one name. An object without triangles (a point cloud) gives a Scene without any, about the
/// venue's origin. Refuses an unknown name, with the nearest known one.
[[nodiscard]] Result<Scene> object_scene(const Scene& scene, std::string_view name);

/// All other objects. Vertices, materials, names and origin are unchanged. Refuses an unknown name likewise.
[[nodiscard]] Result<Scene> scene_without_object(const Scene& scene, std::string_view name);

}  // namespace luxrig
