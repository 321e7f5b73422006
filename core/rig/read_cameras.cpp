#include <fmt/format.h>

#include "core/rig/rig_reader.h"

namespace luxrig {

void RigReader::read_cameras() {
  each(root, "camera", [&](Section& s) {
    PictureCamera camera;
    camera.place = s.place();
    if (s.read("name", camera.name)) {
      cameras.add(camera.name, rig.cameras.size(), s.place_of("name"), problems);
      // Its pictures are files of that name.
      if (camera.name.find('/') != std::string::npos || camera.name.starts_with('.'))
        problems.add(s.place_of("name"), fmt::format("{} cannot be the name of a file", in_quotes(camera.name)),
                     "leave out / and a leading dot");
    }
    s.read("position_m", camera.position_world_m);
    if (s.has("aim") == s.has("aim_m")) {
      problems.add(s.place(),
                   fmt::format("[[camera]] has {}", s.has("aim") ? "both aim and aim_m" : "neither aim nor aim_m"),
                   "say what it looks at by one of the two");
    } else if (s.has("aim")) {
      if (const auto point = points.read_reference(s, "aim")) camera.aim_world_m = rig.points[*point].position_world_m;
    } else {
      s.read("aim_m", camera.aim_world_m);
    }
    if (camera.aim_world_m == camera.position_world_m && s.has("position_m"))
      problems.add(s.place_of(s.has("aim") ? "aim" : "aim_m"), "the camera looks at itself", "give a place elsewhere");
    s.read_deg("fov_deg", camera.vertical_fov_rad);
    s.read("width_px", camera.width_px);
    s.read("height_px", camera.height_px);
    rig.cameras.push_back(std::move(camera));
  });
}

}  // namespace luxrig
