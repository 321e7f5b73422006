#include "core/scene/mesh/surface_colours.h"

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

constexpr double kShades = 32;  // per primary, spaced perceptually

std::uint32_t rounded_colour(const Vec3& colour) {
  std::uint32_t code = 1;  // 0 = the material has only one
  for (const double part : colour)
    code = code * 64 + static_cast<std::uint32_t>(std::lround(kShades * std::sqrt(std::clamp(part, 0.0, 1.0))));
  return code;
}

}  // namespace

SurfaceColours::SurfaceColours(const PolygonMesh& mesh) : mesh_(mesh), materials_(mesh.materials) {
  if (materials_.empty()) materials_.emplace_back();
}

std::uint32_t SurfaceColours::material_of(std::uint32_t file_material, const std::array<std::size_t, 3>& corners,
                                          double area_m2) {
  const std::uint32_t index = file_material < materials_.size() ? file_material : 0u;
  const FileMaterial& from = materials_[index];
  Vec3 colour = from.colour.value_or(Vec3::Ones());
  std::uint32_t code = 0;
  if (!from.unknown) {
    if (from.texture) {
      std::array<std::array<float, 2>, 3> uvs;
      bool has_place = !mesh_.corner_uvs.empty();
      for (std::size_t i = 0; i < 3 && has_place; ++i) {
        const std::uint32_t uv = mesh_.corner_uvs[corners[i]];
        has_place = uv < mesh_.uvs.size();
        if (has_place) uvs[i] = mesh_.uvs[uv];
      }
      colour = colour.cwiseProduct(has_place ? from.texture->mean_over(uvs) : from.texture->mean());
      code = rounded_colour(colour);
    }
    if (!mesh_.colours.empty()) {
      Vec3 mean = Vec3::Zero();
      for (const std::size_t corner : corners) mean += mesh_.colours[mesh_.corners[corner]].cast<double>() / 3;
      colour = colour.cwiseProduct(mean);
      code = rounded_colour(colour);
    }
  }
  const auto [at, is_new] = shade_of_.try_emplace({index, code}, static_cast<std::uint32_t>(shades_.size()));
  if (is_new) shades_.push_back({index, Vec3::Zero(), 0});
  Shade& shade = shades_[at->second];
  shade.sum += area_m2 * colour;
  shade.area_m2 += area_m2;
  return at->second;
}

std::vector<Material> SurfaceColours::take() {
  std::vector<Material> out;
  for (const Shade& shade : shades_) {
    const FileMaterial& from = materials_[shade.file_material];
    Material material;
    material.name = from.name;
    if (!from.unknown && (from.colour || from.texture || !mesh_.colours.empty())) {
      const Vec3 rgb = from.texture || !mesh_.colours.empty() ? Vec3(shade.sum / shade.area_m2) : *from.colour;
      if (rgb.allFinite()) {
        material.too_bright = rgb.maxCoeff() > kMaxReflectance;
        material.reflectance_rgb = rgb.cwiseMax(0.0).cwiseMin(kMaxReflectance);
        material.coloured = true;
      }
    }
    out.push_back(std::move(material));
  }
  return out;
}

}  // namespace luxrig
