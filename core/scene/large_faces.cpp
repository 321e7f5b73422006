#include "core/scene/large_faces.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/scene/mesh/polygon_mesh.h"

namespace luxrig {
namespace {

using FaceCorners = std::array<std::uint32_t, 3>;

/// The result is the same to the last bit for either order of the ends: both triangles at an edge must agree.
bool is_long(const Vec3& origin_world_m, const Vec3& a_world_m, const Vec3& b_world_m) {
  if ((b_world_m - a_world_m).squaredNorm() <= kLongEdge_m * kLongEdge_m) return false;
  const bool in_order =
      std::lexicographical_compare(a_world_m.begin(), a_world_m.end(), b_world_m.begin(), b_world_m.end());
  const Vec3 a = (in_order ? a_world_m : b_world_m) - origin_world_m,
             b = (in_order ? b_world_m : a_world_m) - origin_world_m, way = b - a;
  const double at = std::clamp(-a.dot(way) / way.squaredNorm(), 0.0, 1.0);
  return way.squaredNorm() > kEdgePerDistance * kEdgePerDistance * (a + at * way).squaredNorm();
}

class Cutter {
 public:
  Cutter(const Vec3& origin_world_m, PlacedMesh& mesh) : origin_world_m_(origin_world_m), mesh_(mesh) {}

  bool cut() {
    const auto first = std::find_if(mesh_.triangles.begin(), mesh_.triangles.end(),
                                    [&](const FaceCorners& triangle) { return long_edges(triangle) != 0; });
    if (first == mesh_.triangles.end()) return true;
    const std::vector<FaceCorners> whole = std::exchange(mesh_.triangles, {});
    const std::vector<std::uint32_t> materials = std::exchange(mesh_.material_of_triangle, {});
    std::vector<FaceCorners> open;
    for (std::size_t t = 0; t < whole.size(); ++t) {
      open.push_back(whole[t]);
      while (!open.empty()) {
        const FaceCorners triangle = open.back();
        open.pop_back();
        if (cut_once(triangle, open)) continue;
        if (mesh_.triangles.size() == kMaxTriangles) return false;
        mesh_.triangles.push_back(triangle);
        mesh_.material_of_triangle.push_back(materials[t]);
      }
    }
    return true;
  }

 private:
  /// Bit i: the edge from corner i to the next.
  [[nodiscard]] int long_edges(const FaceCorners& triangle) const {
    int edges = 0;
    for (std::size_t i = 0; i < 3; ++i)
      if (is_long(origin_world_m_, mesh_.vertices_world_m[triangle[i]], mesh_.vertices_world_m[triangle[(i + 1) % 3]]))
        edges |= 1 << i;
    return edges;
  }

  std::uint32_t middle_of(std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] =
        middles_.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh_.vertices_world_m.size()));
    if (is_new) mesh_.vertices_world_m.push_back(Vec3((mesh_.vertices_world_m[a] + mesh_.vertices_world_m[b]) / 2));
    return at->second;
  }

  /// False if there is nothing to cut.
  bool cut_once(FaceCorners triangle, std::vector<FaceCorners>& open) {
    int edges = long_edges(triangle);
    if (edges == 0) return false;
    // Turned so that a long edge comes first; if there are two, they come first and second.
    const auto turn = [&] {
      std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
      edges = edges >> 1 | (edges & 1) << 2;
    };
    while (edges != 1 && edges != 3 && edges != 7) turn();
    const auto& [a, b, c] = triangle;
    const std::uint32_t ab = middle_of(a, b);
    if (edges == 1) {
      open.insert(open.end(), {{a, ab, c}, {ab, b, c}});
      return true;
    }
    const std::uint32_t bc = middle_of(b, c);
    if (edges == 3) {
      open.insert(open.end(), {{ab, b, bc}, {a, ab, bc}, {a, bc, c}});
      return true;
    }
    const std::uint32_t ca = middle_of(c, a);
    open.insert(open.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    return true;
  }

  const Vec3& origin_world_m_;
  PlacedMesh& mesh_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles_;
};

}  // namespace

bool cut_large_faces(const Vec3& origin_world_m, PlacedMesh& mesh) { return Cutter(origin_world_m, mesh).cut(); }

}  // namespace luxrig
