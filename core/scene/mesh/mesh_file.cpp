#include "core/scene/mesh/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "core/scene/mesh/files_beside.h"
#include "core/scene/mesh/gltf/gltf_file.h"
#include "core/scene/mesh/mesh_reading.h"
#include "core/scene/mesh/obj_file.h"
#include "core/scene/mesh/ply_file.h"
#include "core/scene/mesh/polygon_split.h"
#include "core/scene/mesh/stl_file.h"
#include "core/scene/mesh/surface_colours.h"
#include "core/scene/mesh/tds_file.h"
#include "core/scene/mesh/up_axis.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{8} << 30;
constexpr double kMaxCoordinate_m = 1e9;  // beyond this, a mesh is broken or its unit wrong
constexpr double kFarOut_m = 1000;        // beyond this, float is coarser than 0.06 mm

tl::unexpected<std::vector<Problem>> refuse_mesh(const std::string& file, std::string what, std::string mend) {
  return tl::unexpected(std::vector<Problem>{{file, 0, 0, std::move(what), std::move(mend)}});
}

/// Places, splits and cleans the content of a file.
class MeshPlacing {
 public:
  MeshPlacing(PolygonMesh mesh, const Eigen::Affine3d& world_from_mesh)
      : mesh_(std::move(mesh)), world_from_mesh_(world_from_mesh), colours_(mesh_) {}

  PlacedMesh make() {
    placed_.warnings = std::move(mesh_.warnings);
    place_vertices();
    std::vector<Vec3> points;
    std::vector<std::array<std::uint32_t, 3>> split;
    std::size_t first = 0;
    for (std::size_t face = 0; face < mesh_.corner_counts.size(); ++face) {
      const std::size_t count = mesh_.corner_counts[face];
      const auto begin = mesh_.corners.begin() + static_cast<std::ptrdiff_t>(first);
      const auto end = begin + static_cast<std::ptrdiff_t>(count);
      const bool bad = std::any_of(begin, end, [&](std::uint32_t index) { return index >= mesh_.vertices.size(); });
      placed_.cleaning.bad_indices += bad ? 1 : 0;
      if (!bad && count >= 3) {  // points and lines reflect no light
        points.clear();
        for (auto corner = begin; corner != end; ++corner) points.push_back(mesh_.vertices[*corner]);
        split.clear();
        split_polygon(points, split);
        for (const auto& triangle : split)
          add_triangle({first + triangle[0], first + triangle[1], first + triangle[2]}, face);
      }
      first += count;
    }
    placed_.materials = colours_.take();
    note_cleaning();
    placed_.vertices_world_m = std::move(mesh_.vertices);
    return std::move(placed_);
  }

 private:
  void place_vertices() {
    usable_.resize(mesh_.vertices.size());
    for (std::size_t i = 0; i < mesh_.vertices.size(); ++i) {
      Vec3& vertex = mesh_.vertices[i];
      vertex = world_from_mesh_ * vertex;
      usable_[i] = vertex.allFinite() && vertex.cwiseAbs().maxCoeff() <= kMaxCoordinate_m;
      if (usable_[i]) continue;
      ++placed_.cleaning.non_finite_vertices;
      vertex.setZero();
    }
  }

  void add_triangle(const std::array<std::size_t, 3>& corners, std::size_t face) {
    std::array<std::uint32_t, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      triangle[i] = mesh_.corners[corners[i]];
      if (!usable_[triangle[i]]) return;  // counted with the vertex
    }
    const double area_m2 = area_unless_degenerate(triangle);
    if (!(area_m2 > 0)) {
      ++placed_.cleaning.degenerate_triangles;
      return;
    }
    placed_.triangles.push_back(triangle);
    placed_.material_of_triangle.push_back(
        colours_.material_of(mesh_.face_materials.empty() ? 0 : mesh_.face_materials[face], corners, area_m2));
  }

  /// 0 if its height over its longest side is within float rounding, taken about the origin.
  [[nodiscard]] double area_unless_degenerate(const std::array<std::uint32_t, 3>& triangle) const {
    const Vec3& a = mesh_.vertices[triangle[0]];
    const Vec3 ab = mesh_.vertices[triangle[1]] - a, ac = mesh_.vertices[triangle[2]] - a;
    const double longest_m2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    const double twice_area_m2 = ab.cross(ac).norm();
    return twice_area_m2 > 0x1p-24 * longest_m2 ? twice_area_m2 / 2 : 0;
  }

  void note_cleaning() {
    const Cleaning& c = placed_.cleaning;
    if (c.total() == 0) return;
    placed_.warnings.push_back("cleaned: " + std::to_string(c.non_finite_vertices) + " vertices without a place, " +
                               std::to_string(c.bad_indices) + " triangles with bad indices, " +
                               std::to_string(c.degenerate_triangles) + " triangles without area");
  }

  PolygonMesh mesh_;
  Eigen::Affine3d world_from_mesh_;
  SurfaceColours colours_;
  std::vector<bool> usable_;
  PlacedMesh placed_;
};

}  // namespace

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension.empty() ? extension : extension.substr(1);
}

Checked<PolygonMesh> read_mesh(std::string bytes, const std::string& extension, const std::string& file,
                               const FilesBeside& beside) {
  if (bytes.empty()) return refuse_mesh(file, "is empty", "give the whole file");
  try {
    if (extension == "obj") return read_obj(std::move(bytes), file, beside);
    if (extension == "stl") return read_stl(std::move(bytes), file);
    if (extension == "3ds") return read_3ds(bytes, file, beside);
    if (extension == "gltf" || extension == "glb") return read_gltf(std::move(bytes), file, beside);
  } catch (const std::bad_alloc&) {
    return refuse_mesh(file, "takes more memory than there is", "give a simplified mesh");
  }
  return refuse_mesh(file, "is of no known mesh format", "give an .obj, .ply, .stl, .gltf, .glb or .3ds file");
}

PlacedMesh place_mesh(PolygonMesh mesh, const Eigen::Affine3d& world_from_mesh) {
  return MeshPlacing(std::move(mesh), world_from_mesh).make();
}

Checked<PlacedMesh> load_placed_mesh(const MeshFile& file) {
  const std::string name = file.path.string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file.path, error))  // a pipe would block
    return refuse_mesh(name, "no such mesh file", "correct its name, relative to the rig file");
  const auto bytes = std::filesystem::file_size(file.path, error);
  if (error || bytes == 0) return refuse_mesh(name, "is empty", "give the whole file");
  if (bytes > kMaxFileBytes) return refuse_mesh(name, "is larger than 8 GiB", "give a simplified mesh");
  const std::string extension = extension_of(file.path);
  Checked<PolygonMesh> mesh;
  if (extension == "ply") {
    mesh = read_ply(file.path);
  } else {
    auto content = whole_file(file.path, kMaxFileBytes);
    if (!content) return refuse_mesh(name, "cannot be read", "correct its rights");
    mesh = read_mesh(std::move(*content), extension, name, FolderBeside(file.path));
  }
  if (!mesh) return tl::unexpected(std::move(mesh.error()));
  Eigen::Affine3d world_from_mesh = Eigen::Affine3d::Identity();
  world_from_mesh.linear() = file.metres_per_unit * rotation_to_z_up(file.up_axis);
  PlacedMesh placed = place_mesh(std::move(*mesh), world_from_mesh);
  if (placed.triangles.empty()) {
    return refuse_mesh(name, "holds no usable triangle (" + std::to_string(placed.cleaning.total()) + " faults)",
                       "give a mesh with faces");
  }
  return placed;
}

Checked<Scene> load_mesh(const MeshFile& file) {
  auto placed = load_placed_mesh(file);
  if (!placed) return tl::unexpected(std::move(placed.error()));
  Scene scene;
  scene.object_names.push_back(file.path.filename().string());
  scene.warnings = std::move(placed->warnings);
  const Eigen::AlignedBox3d bounds = bounds_of(*placed);
  if (std::max(bounds.min().cwiseAbs().maxCoeff(), bounds.max().cwiseAbs().maxCoeff()) > kFarOut_m)
    scene.origin_world_m = bounds.center();
  append_rounded(*placed, 0, scene);
  return scene;
}

}  // namespace luxrig
