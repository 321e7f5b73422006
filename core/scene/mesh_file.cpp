#include "core/scene/mesh_file.h"

#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>
#include <limits>
#include <utility>

#include "core/rig/plain_text.h"
#include "core/scene/mesh_files_allowed.h"
#include "core/scene/ply_file.h"
#include "core/scene/ply_importer.h"
#include "core/scene/up_axis.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxTriangles = 50'000'000;
constexpr double kMaxCoordinate_m = 1e9;  // beyond it a mesh is broken, or its unit wrong

Eigen::Matrix4d to_eigen(const aiMatrix4x4& m) {
  Eigen::Matrix4d result;
  result << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
  return result;
}

class MeshReader {
 public:
  explicit MeshReader(const MeshFile& file) : file_(file) {}

  Checked<Scene> read() {
    try {
      if (const auto refusal = why_not_opened(file_.path)) return refuse(refusal->what, refusal->mend);
      Assimp::Importer importer;
      AllowedFiles* const files = restrict_to(importer, file_.path);
      if (extension_of(file_.path) == "ply") {
        auto ply = read_ply(file_.path);
        if (!ply) return tl::unexpected(std::move(ply.error()));
        give_ply(importer, std::move(*ply));
      }
      // No post-processing yet: assimp's steps follow bad indices out of their arrays.
      const aiScene* source = importer.ReadFile(file_.path.string(), 0);
      if (source != nullptr) {
        if (!drop_unusable_faces(*source)) {
          return refuse("has a face with more than " + std::to_string(kMaxCorners) + " corners",
                        "export it as triangles");
        }
        source = importer.ApplyPostProcessing(aiProcess_Triangulate);
      }
      if (source == nullptr || source->mRootNode == nullptr) {
        return refuse("is no mesh that can be read: " + first_line(importer.GetErrorString()),
                      "export it again as OBJ, PLY, STL or glTF");
      }
      if (count_triangles(*source) > kMaxTriangles) {
        return refuse("has more than 50 million triangles", "give a simplified mesh");
      }
      scene_.object_names.push_back(file_.path.filename().string());
      read_materials(*source, *files);
      read_nodes(*source);
    } catch (const std::exception& error) {  // assimp throws on some garbage, and when memory ends
      return refuse(std::string("is no mesh that can be read: ") + first_line(error.what()),
                    "export it again as OBJ, PLY, STL or glTF");
    }
    if (scene_.triangles.empty()) {
      return refuse("holds no usable triangle (" + std::to_string(scene_.cleaning.total()) + " faults)",
                    "give a mesh with faces");
    }
    drop_idle_materials();
    note_cleaning();
    return std::move(scene_);
  }

 private:
  [[nodiscard]] tl::unexpected<std::vector<Problem>> refuse(std::string what, std::string mend) const {
    return tl::unexpected(std::vector<Problem>{{file_.path.string(), 0, 0, std::move(what), std::move(mend)}});
  }

  static std::string first_line(std::string text) {
    return made_plain(text.substr(0, std::min(text.find('\n'), std::size_t{200})));
  }

  /// Each node with its transform from the root's frame; a list, since a hostile tree is deep.
  struct Placed {
    const aiNode* node;
    Eigen::Matrix4d root_from_node;
  };
  template <class F>
  static void for_each_node(const aiScene& source, const F& visit) {
    std::vector<Placed> open{{source.mRootNode, to_eigen(source.mRootNode->mTransformation)}};
    while (!open.empty()) {
      const Placed here = open.back();
      open.pop_back();
      visit(here);
      for (unsigned i = here.node->mNumChildren; i-- > 0;) {  // last first: popped in file order
        const aiNode* const child = here.node->mChildren[i];
        open.push_back({child, here.root_from_node * to_eigen(child->mTransformation)});
      }
    }
  }

  /// After triangulation, so faces are triangles; a mesh counts once for each node that shows it.
  static std::size_t count_triangles(const aiScene& source) {
    std::size_t count = 0;
    for_each_node(source, [&](const Placed& placed) {
      for (unsigned i = 0; i < placed.node->mNumMeshes; ++i) {
        const unsigned mesh = placed.node->mMeshes[i];
        if (mesh < source.mNumMeshes) count += source.mMeshes[mesh]->mNumFaces;
      }
    });
    return count;
  }

  /// Faces with an index past the vertices (counted), and points and lines, which carry no light. In place:
  /// the importer owns the meshes, and hands out as const what it made as not.
  /// returns  whether each face left has few enough corners to be split
  bool drop_unusable_faces(const aiScene& source) {
    for (unsigned i = 0; i < source.mNumMeshes; ++i) {
      aiMesh& mesh = *source.mMeshes[i];
      unsigned kept = 0;
      bool polygons = false;
      for (unsigned j = 0; j < mesh.mNumFaces; ++j) {
        aiFace& face = mesh.mFaces[j];
        const bool bad = std::any_of(face.mIndices, face.mIndices + face.mNumIndices,
                                     [&](unsigned index) { return index >= mesh.mNumVertices; });
        scene_.cleaning.bad_indices += bad ? 1 : 0;
        if (bad || face.mNumIndices < 3) continue;
        if (face.mNumIndices > kMaxCorners) return false;
        polygons = polygons || face.mNumIndices > 3;
        aiFace& to = mesh.mFaces[kept++];
        std::swap(to.mIndices, face.mIndices);
        std::swap(to.mNumIndices, face.mNumIndices);
      }
      mesh.mNumFaces = kept;
      mesh.mPrimitiveTypes = polygons ? aiPrimitiveType_POLYGON : aiPrimitiveType_TRIANGLE;
    }
    return true;
  }

  void read_materials(const aiScene& source, const AllowedFiles& files) {
    const auto stated = files.materials_with_colour();
    for (unsigned i = 0; i < source.mNumMaterials; ++i) {
      const aiMaterial& from = *source.mMaterials[i];
      Material material;
      aiString name;
      if (from.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) material.name = name.C_Str();
      aiColor4D colour;
      // glTF states a base colour (linear, white if left out); OBJ a diffuse one in its .mtl, for which assimp puts
      // a grey of its own when there is none. PLY and STL have no materials.
      const bool has_base = from.Get(AI_MATKEY_BASE_COLOR, colour) == AI_SUCCESS;
      const bool has_diffuse =
          !has_base && from.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == AI_SUCCESS && stated.count(material.name) > 0;
      const Vec3 rgb(colour.r, colour.g, colour.b);
      if ((has_base || has_diffuse) && rgb.allFinite()) {
        material.too_bright = rgb.maxCoeff() > kMaxReflectance;
        material.reflectance_rgb = rgb.cwiseMax(0.0).cwiseMin(kMaxReflectance);
        material.coloured = true;
      }
      scene_.materials.push_back(std::move(material));
    }
    if (scene_.materials.empty()) scene_.materials.emplace_back();
  }

  /// assimp adds a material of its own to some files, and a file may hold more than its mesh shows.
  void drop_idle_materials() {
    constexpr std::uint32_t kIdle = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> place(scene_.materials.size(), kIdle);
    for (const std::uint32_t material : scene_.material_of_triangle) place[material] = 0;
    std::uint32_t kept = 0;
    for (std::size_t i = 0; i < place.size(); ++i) {
      if (place[i] == kIdle) continue;
      if (kept != i) scene_.materials[kept] = std::move(scene_.materials[i]);
      place[i] = kept++;
    }
    scene_.materials.resize(kept);
    for (std::uint32_t& material : scene_.material_of_triangle) material = place[material];
  }

  void read_nodes(const aiScene& source) {
    Eigen::Matrix4d world_from_root = Eigen::Matrix4d::Identity();
    world_from_root.topLeftCorner<3, 3>() = file_.metres_per_unit * rotation_to_z_up(file_.up_axis);
    for_each_node(source, [&](const Placed& placed) {
      const Eigen::Matrix4d world_from_node = world_from_root * placed.root_from_node;
      for (unsigned i = 0; i < placed.node->mNumMeshes; ++i) {
        const unsigned mesh = placed.node->mMeshes[i];
        if (mesh < source.mNumMeshes) add_mesh(*source.mMeshes[mesh], world_from_node);
      }
    });
  }

  void add_mesh(const aiMesh& mesh, const Eigen::Matrix4d& world_from_node) {
    const auto base = static_cast<std::uint32_t>(scene_.vertices_m.size());
    std::vector<bool> usable(mesh.mNumVertices);
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
      const aiVector3D& v = mesh.mVertices[i];
      Vec3 position_m = (world_from_node * Eigen::Vector4d(v.x, v.y, v.z, 1)).head<3>();
      usable[i] = position_m.allFinite() && position_m.cwiseAbs().maxCoeff() <= kMaxCoordinate_m;
      if (!usable[i]) {
        ++scene_.cleaning.non_finite_vertices;
        position_m.setZero();
      }
      scene_.vertices_m.push_back(position_m.cast<float>());
    }
    const std::uint32_t material = mesh.mMaterialIndex < scene_.materials.size() ? mesh.mMaterialIndex : 0u;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
      const aiFace& face = mesh.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines carry no light
      const unsigned* const index = face.mIndices;
      if (index[0] >= mesh.mNumVertices || index[1] >= mesh.mNumVertices || index[2] >= mesh.mNumVertices) {
        ++scene_.cleaning.bad_indices;
        continue;
      }
      if (!usable[index[0]] || !usable[index[1]] || !usable[index[2]]) continue;  // counted with the vertex
      const std::array<std::uint32_t, 3> triangle{base + index[0], base + index[1], base + index[2]};
      if (is_degenerate(triangle)) {
        ++scene_.cleaning.degenerate_triangles;
        continue;
      }
      scene_.triangles.push_back(triangle);
      scene_.material_of_triangle.push_back(material);
      scene_.object_of_triangle.push_back(0);
    }
  }

  /// Its height over its longest side is within the rounding of its coordinates.
  [[nodiscard]] bool is_degenerate(const std::array<std::uint32_t, 3>& triangle) const {
    const Vec3 a = scene_.vertices_m[triangle[0]].cast<double>();
    const Vec3 ab = scene_.vertices_m[triangle[1]].cast<double>() - a;
    const Vec3 ac = scene_.vertices_m[triangle[2]].cast<double>() - a;
    const double longest_m = std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}));
    const double reach_m =
        std::max({a.cwiseAbs().maxCoeff(), (a + ab).cwiseAbs().maxCoeff(), (a + ac).cwiseAbs().maxCoeff()});
    return !(ab.cross(ac).norm() > 0x1p-24 * reach_m * longest_m);
  }

  void note_cleaning() {
    const Cleaning& c = scene_.cleaning;
    if (c.total() == 0) return;
    scene_.warnings.push_back("cleaned: " + std::to_string(c.non_finite_vertices) + " vertices without a place, " +
                              std::to_string(c.bad_indices) + " triangles with bad indices, " +
                              std::to_string(c.degenerate_triangles) + " triangles without area");
  }

  const MeshFile& file_;
  Scene scene_;
};

}  // namespace

Checked<Scene> load_mesh(const MeshFile& file) { return MeshReader(file).read(); }

}  // namespace luxrig
