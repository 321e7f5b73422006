// Any bytes as a painting: never a throw, an accepted one is written and read back the same, and painting it is safe.
#include <cstdint>
#include <string>

#include "core/check.h"
#include "core/goals/painting.h"
#include "core/goals/painting_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto strokes = luxrig::painting_from_json(std::string(reinterpret_cast<const char*>(data), size), "fuzz.json");
  if (!strokes) {
    LUXRIG_CHECK(!strokes.error().empty(), "refused without a problem");
    for (const luxrig::Problem& problem : strokes.error())
      LUXRIG_CHECK(!problem.what.empty() && !problem.mend.empty(), "a problem without text");
    return 0;
  }
  const std::string written = luxrig::painting_to_json(*strokes);
  const auto again = luxrig::painting_from_json(written, "again.json");
  LUXRIG_CHECK(again.has_value(), "own output refused: {}", again.error()[0].text());
  LUXRIG_CHECK(luxrig::painting_to_json(*again) == written, "not the same when written again");

  luxrig::Scene scene;
  scene.vertices_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  scene.triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.material_of_triangle = scene.object_of_triangle = {0, 0};
  scene.materials.resize(1);
  const luxrig::RayScene rays(scene);
  const auto surface = luxrig::make_surface_patches(scene, rays, {0.25, 1});
  luxrig::Painting painting(*surface, rays);
  for (const luxrig::Stroke& stroke : *strokes) painting.add(stroke);
  for (const float lux : painting.lux()) LUXRIG_CHECK(!(lux < 0) && !(lux > 1.001e6F), "lux {}", lux);
  while (painting.undo()) continue;
  return 0;
}
