#include "tools/bench/heads/head_rig.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <random>

#include "core/photometry/intensity.h"

namespace luxrig {
namespace {

constexpr int kHeads = 8, kMeters = 6;
constexpr double kSpeed_rad_s = rad_from_deg(180);
enum Paint : std::uint32_t { kFloor, kWalls, kCeiling, kPlinth, kPoster, kMirror };

void add_quad(Scene& scene, const std::array<Vec3, 4>& corners_m, Paint paint, std::uint32_t object) {
  const auto first = static_cast<std::uint32_t>(scene.vertices_m.size());
  for (const Vec3& corner : corners_m) scene.vertices_m.push_back(corner.cast<float>());
  scene.triangles.push_back({first, first + 1, first + 2});
  scene.triangles.push_back({first, first + 2, first + 3});
  for (int k = 0; k < 2; ++k) {
    scene.material_of_triangle.push_back(paint);
    scene.object_of_triangle.push_back(object);
  }
}

/// sides: paint of bottom, top, and the four upright ones.
void add_box(Scene& scene, const Vec3& min_m, const Vec3& max_m, const std::array<Paint, 3>& sides,
             std::uint32_t object) {
  const auto at = [&](int x, int y, int z) {
    return Vec3((x ? max_m : min_m).x(), (y ? max_m : min_m).y(), (z ? max_m : min_m).z());
  };
  for (const int z : {0, 1}) add_quad(scene, {at(0, 0, z), at(1, 0, z), at(1, 1, z), at(0, 1, z)}, sides[z], object);
  for (const int k : {0, 1}) {
    add_quad(scene, {at(k, 0, 0), at(k, 1, 0), at(k, 1, 1), at(k, 0, 1)}, sides[2], object);
    add_quad(scene, {at(0, k, 0), at(1, k, 0), at(1, k, 1), at(0, k, 1)}, sides[2], object);
  }
}

Scene hall_with_plinths(const Vec3& size_m, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit;
  Scene scene;
  for (const auto& [name, reflectance] :
       {std::pair("floor", 0.3), std::pair("walls", 0.6), std::pair("ceiling", 0.75), std::pair("plinth", 0.5),
        std::pair("poster", 0.85), std::pair("mirror", 0.05)}) {
    Material material;
    material.name = name;
    material.reflectance_rgb.setConstant(reflectance);
    scene.materials.push_back(material);
  }
  scene.materials[kMirror].specular_reflectance = 0.85;
  scene.materials[kMirror].roughness = 0.05;
  scene.object_names = {"scene"};
  add_box(scene, Vec3::Zero(), size_m, {kFloor, kCeiling, kWalls}, 0);
  for (std::uint32_t k = 1; k <= 4; ++k) {
    const double side_m = 0.4 + 0.5 * unit(random), height_m = 0.5 + 0.8 * unit(random);
    const Vec3 corner_m(0.5 + (size_m.x() - 2) * unit(random), 0.5 + (size_m.y() - 2) * unit(random), 0.001);
    add_box(scene, corner_m, corner_m + Vec3(side_m, side_m, height_m), {kPlinth, kPlinth, kPlinth}, k);
    scene.object_names.push_back(fmt::format("plinth {}", k));
  }
  // On the wall across from the camera, and on the one to its right.
  const double left_m = 1 + (size_m.x() - 4) * unit(random), away_m = 1 + (size_m.y() - 4) * unit(random);
  const double y_m = size_m.y() - 0.01, x_m = size_m.x() - 0.01;
  add_quad(scene,
           {Vec3(left_m, y_m, 0.8), Vec3(left_m + 1.2, y_m, 0.8), Vec3(left_m + 1.2, y_m, 2), Vec3(left_m, y_m, 2)},
           kPoster, 0);
  add_quad(scene,
           {Vec3(x_m, away_m, 0.5), Vec3(x_m, away_m + 1.5, 0.5), Vec3(x_m, away_m + 1.5, 2.2), Vec3(x_m, away_m, 2.2)},
           kMirror, 0);
  return scene;
}

/// At the height of a table, all over the hall.
void add_meters(const Vec3& size_m, std::uint64_t seed, Rig& rig) {
  std::mt19937_64 random(seed ^ 0x10e7e55);
  std::uniform_real_distribution<double> unit;
  for (int m = 0; m < kMeters; ++m) {
    Luxmeter meter;
    meter.name = fmt::format("meter {}", m + 1);
    meter.position_world_m = Vec3((m % 3 + 0.2 + 0.6 * unit(random)) / 3 * size_m.x(),
                                  (m / 3 + 0.2 + 0.6 * unit(random)) / 2 * size_m.y(), 0.9);
    rig.luxmeters.push_back(meter);
  }
}

}  // namespace

HeadRig head_rig(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit;
  HeadRig made;
  const Vec3 size_m(8 + 4 * unit(random), 7 + 4 * unit(random), 3.5 + 1.5 * unit(random));
  made.scene = hall_with_plinths(size_m, random);
  made.rig.name = fmt::format("heads {}", seed);
  for (int h = 0; h < kHeads; ++h) {
    Luminaire luminaire;
    const double beam_deg = 8 + 10 * unit(random);
    luminaire.name = fmt::format("spot {}", h + 1);
    luminaire.model = LuminaireModel::spot;
    luminaire.beam_angle_rad = rad_from_deg(beam_deg);
    luminaire.field_angle_rad = rad_from_deg(beam_deg * (1.3 + 0.6 * unit(random)));
    luminaire.lumens = 3000;
    luminaire.intensity = make_spot(luminaire.lumens, luminaire.beam_angle_rad, luminaire.field_angle_rad);
    Fixture fixture;
    fixture.name = fmt::format("head {}", h + 1);
    fixture.luminaire = made.rig.luminaires.size();
    fixture.world_from_mount.translation_m =
        Vec3((0.15 + 0.7 * unit(random)) * size_m.x(), (0.15 + 0.7 * unit(random)) * size_m.y(), size_m.z() - 0.3);
    fixture.world_from_mount.rotation = Eigen::AngleAxisd(2 * kPi * unit(random), Vec3::UnitZ()).toRotationMatrix();
    fixture.moves = true;
    fixture.pan_speed_rad_s = fixture.tilt_speed_rad_s = kSpeed_rad_s;
    made.rig.luminaires.push_back(luminaire);
    made.rig.fixtures.push_back(fixture);
  }
  add_meters(size_m, seed, made.rig);
  made.camera.eye_world_m = Vec3(0.3, 0.3, size_m.z() - 0.6 - 0.4 * unit(random));
  made.camera.target_world_m = Vec3(0.6 * size_m.x(), 0.6 * size_m.y(), 0.6);
  made.camera.vertical_fov_rad = rad_from_deg(60);
  made.camera.width_px = 640;
  made.camera.height_px = 400;
  return made;
}

}  // namespace luxrig
