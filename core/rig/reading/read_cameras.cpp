#include <fmt/format.h>

#include "core/rig/reading/rig_reader.h"

namespace luxrig {

void RigReader::read_picture_taking(Section& s, PictureTaking& taking) {
  s.read_choice("source", taking.source);
  const bool v4l2 = taking.source == PictureSource::v4l2, files = taking.source == PictureSource::files;
  const auto keep_out = [&](const char* key, bool belongs, const char* source) {
    if (s.has(key) && !belongs)
      s.refuse(key, fmt::format("{} has no effect: only with source = \"{}\"", key, source),
               fmt::format("remove it, or write source = \"{}\"", source));
  };
  for (const char* key : {"device", "format", "exposure_ms", "gain"}) keep_out(key, v4l2, "v4l2");
  keep_out("files", files, "files");
  for (const char* key : {"dark_level", "response", "response_file", "full_scale_cd_m2"}) {
    if (s.has(key) && !v4l2 && !files)
      s.refuse(key, fmt::format("{} has no effect without a source of pictures", key), "remove it, or write a source");
  }
  s.read("device", taking.device);
  if (std::string text; s.read("files", text)) taking.files = folder / text;
  if (files && !s.has("files")) s.require("files", "which source = \"files\" needs");
  s.read_choice("format", taking.format);
  if (double ms = 0; s.read("exposure_ms", ms)) taking.exposure_s = ms / 1000;
  s.read("gain", taking.gain);
  s.read("dark_level", taking.dark_share);
  s.read_choice("response", taking.curve);
  s.read("full_scale_cd_m2", taking.full_scale_cd_m2);
  if (!s.has("response_file")) return;
  for (const char* key : {"dark_level", "response"}) {
    if (s.has(key)) s.refuse(key, fmt::format("{} has no effect beside response_file", key), "leave out one of them");
  }
  if (const auto file = read_file(s, "response_file")) taking.curve_file = *file;
}

void RigReader::read_cameras() {
  each(root, "camera", [&](Section& s) {
    PictureCamera camera;
    camera.in_file = s.in_file();
    if (s.read("name", camera.name)) {
      cameras.add(camera.name, rig.cameras.size(), s.place_of("name"), problems);
      // Its pictures are saved in files of that name.
      if (camera.name.find('/') != std::string::npos || camera.name.starts_with('.'))
        problems.add(s.place_of("name"), fmt::format("{} cannot be the name of a file", in_quotes(camera.name)),
                     "leave out / and a leading dot");
    }
    s.read("position_m", camera.position_world_m);
    if (s.has("aim") == s.has("aim_m")) {
      problems.add(s.in_file(),
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
    read_picture_taking(s, camera.taking);
    rig.cameras.push_back(std::move(camera));
  });
}

}  // namespace luxrig
