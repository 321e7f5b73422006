#include "core/scene/mesh/stl_file.h"

#include <cstring>

#include "core/scene/mesh/mesh_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kStlHeaderBytes = 84, kStlTriangleBytes = 50;

Checked<PolygonMesh> binary_stl(std::string_view bytes, const std::string& file) {
  const auto refuse = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{file, 0, 0, std::move(what), std::move(mend)}});
  };
  if (bytes.size() < kStlHeaderBytes) return refuse("is no STL: it is shorter than its header", "give the whole file");
  std::uint32_t count = 0;
  std::memcpy(&count, &bytes[80], sizeof count);
  const std::size_t there = (bytes.size() - kStlHeaderBytes) / kStlTriangleBytes;
  if (count > kMaxTriangles) return refuse("has more than 50 million triangles", "give a simplified mesh");
  if (count > there)
    return refuse(
        "is cut short: it promises " + std::to_string(count) + " triangles and holds " + std::to_string(there),
        "give the whole file");
  PolygonMesh mesh;
  mesh.vertices.reserve(3 * std::size_t{count});
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 9> at;
    std::memcpy(at.data(), &bytes[kStlHeaderBytes + i * kStlTriangleBytes + 12], sizeof at);  // after the normal
    for (std::size_t corner = 0; corner < 9; corner += 3) {
      mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      mesh.vertices.push_back(Vec3f(at[corner], at[corner + 1], at[corner + 2]).cast<double>());
    }
    mesh.corner_counts.push_back(3);
  }
  return mesh;
}

Checked<PolygonMesh> ascii_stl(const std::string& text, const std::string& file) {
  TextProblems problems(file);
  PolygonMesh mesh;
  TextLines lines(text);
  std::uint32_t corners = 0;  // of this loop
  for (auto line = lines.next(); line && !problems.full(); line = lines.next()) {
    for (std::string_view word = line->next(); !word.empty(); word = line->next()) {
      if (word == "vertex") {
        Vec3 vertex = Vec3::Zero();
        for (double& coordinate : vertex) {
          word = line->next();
          const auto value = number_of_word(word);
          if (!value) {
            problems.add_no_number(*line, word, "a coordinate");
            break;
          }
          coordinate = *value;
        }
        if (++corners > kMaxCorners) {
          problems.add(*line, "has a face with more than " + std::to_string(kMaxCorners) + " corners",
                       "export it as triangles");
          return tl::unexpected(problems.take());
        }
        mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
        mesh.vertices.push_back(vertex);
      } else if (word == "endloop" || word == "endfacet") {
        if (corners > 0) mesh.corner_counts.push_back(corners);
        corners = 0;
      } else if (word == "solid" || word == "endsolid" || word == "facet") {
        break;  // a name or a normal follows
      }
    }
    if (mesh.vertices.size() > 3 * kMaxTriangles) {
      problems.add(*line, "has more than 50 million triangles", "give a simplified mesh");
      break;
    }
  }
  if (!problems.empty()) return tl::unexpected(problems.take());
  if (corners > 0) {
    return tl::unexpected(std::vector<Problem>{{file, 0, 0, "is cut short within a facet", "give the whole file"}});
  }
  return mesh;
}

}  // namespace

Checked<PolygonMesh> read_stl(std::string bytes, const std::string& file) {
  // A binary header may also begin with "solid". Then the size that it promises decides.
  std::uint32_t count = 0;
  if (bytes.size() >= kStlHeaderBytes) std::memcpy(&count, &bytes[80], sizeof count);
  const bool size_fits =
      bytes.size() >= kStlHeaderBytes && bytes.size() == kStlHeaderBytes + kStlTriangleBytes * std::size_t{count};
  if (!size_fits) {
    const bool wide = bytes.size() > 1 && (bytes[1] == '\0' || static_cast<unsigned char>(bytes[0]) >= 0xef);
    const std::string text = wide ? utf8_of(bytes) : std::string();
    const std::string& seen = wide ? text : bytes;
    const auto begin = seen.find_first_not_of(" \t\r\n");
    if (begin != std::string::npos && seen.compare(begin, 5, "solid") == 0) return ascii_stl(seen, file);
  }
  return binary_stl(bytes, file);
}

}  // namespace luxrig
