#pragma once
/// For fuzz targets: loads any bytes as a mesh file in a folder without others; the result keeps its promises.

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/check.h"
#include "core/scene/mesh/mesh_file.h"
#include "core/text/plain_text.h"

namespace luxrig {

/// One file per process, rewritten for each input; its folder is removed with the process.
class MeshFromBytes {
 public:
  explicit MeshFromBytes(const std::string& extension)
      : folder_(std::filesystem::temp_directory_path() / ("luxrig_" + extension + "_fuzz." + std::to_string(getpid()))),
        file_(folder_ / ("mesh." + extension)) {
    std::filesystem::create_directories(folder_);
  }
  ~MeshFromBytes() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  MeshFromBytes(const MeshFromBytes&) = delete;
  MeshFromBytes& operator=(const MeshFromBytes&) = delete;

  void check(const std::uint8_t* data, std::size_t size) const {
    std::ofstream(file_, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    const auto scene = load_mesh({file_, 1, UpAxis::y});
    if (!scene) {
      LUXRIG_CHECK(!scene.error().empty(), "refused without a problem");
      for (const Problem& problem : scene.error()) {
        LUXRIG_CHECK(!problem.what.empty() && !problem.mend.empty(), "{}", problem.text());
        LUXRIG_CHECK(is_plain_text(problem.text()) && problem.line >= 0, "{}", problem.text());
      }
      return;
    }
    LUXRIG_CHECK(!scene->triangles.empty() && scene->triangles.size() == scene->material_of_triangle.size(),
                 "{} triangles", scene->triangles.size());
    for (const auto& triangle : scene->triangles) {
      for (const std::uint32_t index : triangle) LUXRIG_CHECK(index < scene->vertices_m.size(), "{}", index);
    }
    for (const Vec3f& vertex : scene->vertices_m) LUXRIG_CHECK(vertex.allFinite(), "a vertex without a place");
    for (const std::uint32_t material : scene->material_of_triangle) {
      LUXRIG_CHECK(material < scene->materials.size(), "{}", material);
    }
    for (const Material& material : scene->materials) {
      LUXRIG_CHECK(material.reflectance_rgb.minCoeff() >= 0 && material.reflectance_rgb.maxCoeff() <= 0.95,
                   "reflectance {}", material.reflectance_rgb.maxCoeff());
    }
  }

 private:
  std::filesystem::path folder_, file_;
};

}  // namespace luxrig
