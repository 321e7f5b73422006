/// A room as input for Radiance: surfaces, lamps and measuring points, in units that give our own answer.
///
/// Radiance counts watts per steradian and square metre by channel; its convention is 179 lm/W. Lamps are white there.
/// So 179 times a channel of `rtrace -I` is the lux by that channel's reflectances. The three, weighted as Rec. 709's
/// luminance, are lux as the evaluators here define it.

#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "tools/bench/transport/case.h"

namespace luxrig {
namespace {

constexpr double kLumensPerWatt = 179;
/// Lamps become small spheres (Radiance spots: rays from them, with a distribution over direction).
constexpr double kLampRadius_m = 0.005;

/// Intensity by angle off the axis [cd], every degree, averaged around the axis. Radiance reads it as a data file.
std::string distribution(const Emitter& lamp) {
  std::string text = "1\n0 180 181\n";
  for (int deg = 0; deg <= 180; ++deg) {
    const double gamma = rad_from_deg(deg);
    double mean_cd = 0;
    for (int k = 0; k < 16; ++k) {
      const double c = 2 * kPi * k / 16;
      mean_cd += lamp.intensity->intensity_cd(
                     Vec3(std::sin(gamma) * std::cos(c), std::sin(gamma) * std::sin(c), -std::cos(gamma))) /
                 16;
    }
    text += fmt::format("{:.9g}\n", mean_cd);
  }
  return text;
}

std::string written(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  return out ? "" : file.string() + ":0:0: cannot be written: name a folder that can be";
}

}  // namespace

std::string export_for_radiance(const LitRoom& room, const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  const Scene& scene = room.scene;
  std::string rad = fmt::format("# {}\n", room.name);
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    const Vec3& body = material.reflectance_rgb;
    rad += fmt::format("void plastic material{} 0 0 5 {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", m, body.x(), body.y(),
                       body.z(), material.specular_reflectance,
                       material.specular_reflectance > 0 ? material.roughness : 0.0);
  }
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    rad += fmt::format("material{} polygon t{} 0 0 9", scene.material_of_triangle[t], t);
    for (const std::uint32_t v : scene.triangles[t]) {
      const Vec3 at_m = scene.vertex_world_m(v);
      rad += fmt::format(" {:.9g} {:.9g} {:.9g}", at_m.x(), at_m.y(), at_m.z());
    }
    rad += '\n';
  }
  // Radiance looks up a distribution by a function of the ray's direction. This one measures from the lamp's axis.
  std::string trouble;
  for (std::size_t e = 0; e < room.emitters.size(); ++e) {
    const Emitter& lamp = room.emitters[e];
    if (lamp.sky || !lamp.intensity) continue;
    const std::string name = fmt::format("{}-lamp{}", room.name, e);
    if (trouble.empty()) trouble = written(folder / (name + ".dat"), distribution(lamp));
    const Vec3 axis = lamp.world_from_lamp.direction(-Vec3::UnitZ()), at_m = lamp.world_from_lamp.translation_m;
    if (trouble.empty())
      trouble =
          written(folder / (name + ".cal"), fmt::format("off = 180/PI*Acos(-({:.12g}*Dx+{:.12g}*Dy+{:.12g}*Dz));\n"
                                                        "as_is(v) = v;\n",
                                                        axis.x(), axis.y(), axis.z()));
    // From cd to W/sr/m² of a small sphere: divided by its cross-section and by 179.
    const double scale = 1 / (kLumensPerWatt * kPi * kLampRadius_m * kLampRadius_m);
    rad += fmt::format("void brightdata shape{0} 4 as_is {1}.dat {1}.cal off 0 0\n", e, name);
    rad += fmt::format("shape{0} light glow{0} 0 0 3 {1:.9g} {1:.9g} {1:.9g}\n", e, scale);
    rad += fmt::format("glow{} sphere lamp{} 0 0 4 {:.9g} {:.9g} {:.9g} {:.9g}\n", e, e, at_m.x(), at_m.y(), at_m.z(),
                       kLampRadius_m);
  }
  std::string points;
  for (const Receiver& r : room.receivers)
    points += fmt::format("{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\n", r.position_world_m.x(), r.position_world_m.y(),
                          r.position_world_m.z(), r.normal_world.x(), r.normal_world.y(), r.normal_world.z());
  if (trouble.empty()) trouble = written(folder / (room.name + ".rad"), rad);
  if (trouble.empty()) trouble = written(folder / (room.name + ".pts"), points);
  return trouble;
}

}  // namespace luxrig
