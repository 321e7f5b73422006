#include "core/scene/mesh/obj_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include "core/scene/mesh/mesh_text.h"
#include "core/scene/mesh/mtl_file.h"
#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxMtlBytes = std::size_t{64} << 20;

/// A corner of a face: a vertex, and perhaps a point of the picture; from 1, or from -1 backwards.
struct ObjCorner {
  long long vertex = 0, uv = 0;
};

std::optional<ObjCorner> corner_of_word(std::string_view word) {
  ObjCorner corner;
  const char* at = word.data();
  const char* const end = at + word.size();
  const auto number = [&](long long& out) {
    const auto [stop, error] = std::from_chars(at, end, out);
    if (error == std::errc::result_out_of_range) out = 0;
    if (stop == at) return false;
    at = stop;
    return true;
  };
  if (!number(corner.vertex)) return std::nullopt;
  for (int part = 1; part <= 2 && at != end; ++part) {
    if (*at++ != '/') return std::nullopt;
    long long normal = 0;
    const bool given = number(part == 1 ? corner.uv : normal);
    if (!given && at != end && *at != '/') return std::nullopt;
  }
  return at == end ? std::optional(corner) : std::nullopt;
}

/// As an index from 0; kNoIndex if invalid.
std::uint32_t index_of(long long stated, std::size_t count) {
  const long long index = stated < 0 ? static_cast<long long>(count) + stated : stated - 1;
  return stated == 0 || index < 0 || index >= kNoIndex ? kNoIndex : static_cast<std::uint32_t>(index);
}

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file, const FilesBeside& beside)
      : lines_(text), problems_(file), beside_(beside), textures_(beside) {}

  Checked<PolygonMesh> read() {
    while (auto line = lines_.next()) {
      read_line(*line);
      if (problems_.full() || stop_) break;
    }
    if (!problems_.empty()) return tl::unexpected(problems_.take());
    if (left_out_ > 0)
      warn("line " + std::to_string(first_left_out_) + ": " + in_quotes(left_out_key_) +
           " is not known to OBJ: " + std::to_string(left_out_) + " such lines are left out");
    if (curves_ > 0) warn("curves and surfaces without polygons are left out: export the mesh as polygons");
    if (!mesh_.colours.empty()) mesh_.colours.resize(mesh_.vertices.size(), Vec3f::Ones());
    if (!mesh_.corner_uvs.empty()) mesh_.corner_uvs.resize(mesh_.corners.size(), kNoIndex);
    return std::move(mesh_);
  }

 private:
  void warn(std::string text) {
    if (mesh_.warnings.size() < 100) mesh_.warnings.push_back(std::move(text));
  }

  void read_line(TextLine& line) {
    const std::string_view key = line.next();
    if (key.empty()) return;
    if (key == "v") return read_vertex(line);
    if (key == "f" || key == "fo") return read_face(line);
    if (key == "vt") return read_uv(line);
    if (key == "usemtl") {
      material_ = material_of(made_plain(line.rest()));
    } else if (key == "mtllib") {
      read_libraries(std::string(line.rest()));
    } else if (key == "curv" || key == "curv2" || key == "surf") {
      ++curves_;
    } else if (!is_ignored(key) && left_out_++ == 0) {
      left_out_key_ = key;
      first_left_out_ = line.number();
    }
  }

  static bool is_ignored(std::string_view key) {
    static constexpr std::array kKeys = {
        "vn",     "vp",    "g",     "o",      "s",      "l",          "p",         "mg",       "lod",     "bevel",
        "cstype", "deg",   "bmat",  "step",   "parm",   "trim",       "hole",      "scrv",     "sp",      "end",
        "con",    "ctech", "stech", "maplib", "usemap", "shadow_obj", "trace_obj", "c_interp", "d_interp"};
    return std::any_of(kKeys.begin(), kKeys.end(), [&](std::string_view known) { return known == key; });
  }

  /// Reads numbers to the end of the line, at most `most`. Returns how many; nullopt after a problem.
  std::optional<std::size_t> numbers(TextLine& line, std::array<double, 7>& values, std::size_t least,
                                     std::size_t most) {
    std::size_t count = 0;
    for (; count < most; ++count) {
      const std::string_view word = line.next();
      if (word.empty() && count >= least) break;
      const auto value = number_of_word(word);
      if (!value) {
        problems_.add_no_number(line, word, "a coordinate");
        return std::nullopt;
      }
      values[count] = *value;
    }
    return count;
  }

  void read_vertex(TextLine& line) {
    std::array<double, 7> values;
    const auto count = numbers(line, values, 3, values.size());
    if (!count) return;
    if (mesh_.vertices.size() == 3 * kMaxTriangles) return too_large(line);
    mesh_.vertices.emplace_back(values[0], values[1], values[2]);
    if (*count < 6) return;
    mesh_.colours.resize(mesh_.vertices.size(), Vec3f::Ones());
    const std::size_t first = *count - 3;  // after x, y, z, and perhaps a weight
    for (std::size_t i = 0; i < 3; ++i) {
      const double value = std::isfinite(values[first + i]) ? values[first + i] : 1;
      mesh_.colours.back()[static_cast<Eigen::Index>(i)] =
          static_cast<float>(linear_of_srgb(std::clamp(value, 0.0, 1.0)));
    }
  }

  void read_uv(TextLine& line) {
    std::array<double, 7> values;
    const auto count = numbers(line, values, 1, 3);
    if (!count) return;
    const auto as_float = [](double value) { return std::abs(value) < 1e6 ? static_cast<float>(value) : 0.f; };
    mesh_.uvs.push_back({as_float(values[0]), *count > 1 ? 1 - as_float(values[1]) : 0});  // OBJ counts from below
  }

  void read_face(TextLine& line) {
    std::size_t count = 0;
    for (std::string_view word = line.next(); !word.empty(); word = line.next()) {
      if (word == "\\") {  // continues on the next line
        if (auto next = lines_.next()) {
          line = *next;
          continue;
        }
        break;
      }
      const auto corner = corner_of_word(word);
      if (!corner) {
        problems_.add(line, in_quotes(word) + " is no corner of a face", "export it again");
        mesh_.corners.resize(mesh_.corners.size() - count);
        return;
      }
      if (++count > kMaxCorners) {
        problems_.add(line, "has a face with more than " + std::to_string(kMaxCorners) + " corners",
                      "export it as triangles");
        stop_ = true;
        return;
      }
      mesh_.corners.push_back(index_of(corner->vertex, mesh_.vertices.size()));
      if (corner->uv == 0) continue;
      mesh_.corner_uvs.resize(mesh_.corners.size() - 1, kNoIndex);
      mesh_.corner_uvs.push_back(index_of(corner->uv, mesh_.uvs.size()));
    }
    if (!mesh_.corner_uvs.empty()) mesh_.corner_uvs.resize(mesh_.corners.size(), kNoIndex);
    corners_past_three_ += count > 3 ? count - 3 : 0;
    if (mesh_.corner_counts.size() + corners_past_three_ >= kMaxTriangles) return too_large(line);
    if (!material_) material_ = material_of(kUnnamedMaterial);
    mesh_.corner_counts.push_back(static_cast<std::uint32_t>(count));
    mesh_.face_materials.push_back(*material_);
  }

  void too_large(const TextLine& line) {
    problems_.add(line, "has more than 50 million triangles", "give a simplified mesh");
    stop_ = true;
  }

  std::uint32_t material_of(const std::string& name) {
    const auto [at, is_new] = materials_.try_emplace(name, static_cast<std::uint32_t>(mesh_.materials.size()));
    if (is_new) {
      mesh_.materials.emplace_back();
      mesh_.materials.back().name = name;
    }
    return at->second;
  }

  /// One file, whose name may contain blanks, or several.
  void read_libraries(const std::string& names) {
    if (read_library(names)) return;
    TextLine words(names, 0);
    std::size_t found = 0;
    std::string missing;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      if (read_library(std::string(word))) {
        ++found;
      } else {
        missing = word;
      }
    }
    if (!missing.empty())
      warn("material file " + in_quotes(found == 0 ? names : missing) +
           " is not beside the mesh: its materials get the rig's reflectances");
  }

  bool read_library(const std::string& name) {
    auto bytes = beside_.read(name, kMaxMtlBytes);
    if (!bytes) return false;
    auto file = parse_mtl(std::move(*bytes), made_plain(name));
    if (!file) {
      for (Problem& one : file.error()) problems_.add(std::move(one));
      return true;
    }
    for (std::string& warning : file->warnings) warn(std::move(warning));
    for (const MtlMaterial& from : file->materials) {
      FileMaterial& material = mesh_.materials[material_of(from.name)];
      material.colour = from.colour;
      if (from.texture.empty()) continue;
      material.texture = textures_.of_file(from.texture, mesh_.warnings);
      material.unknown = material.texture == nullptr;
    }
    return true;
  }

  TextLines lines_;
  TextProblems problems_;
  const FilesBeside& beside_;
  TextureShelf textures_;
  PolygonMesh mesh_;
  std::map<std::string, std::uint32_t> materials_;
  std::optional<std::uint32_t> material_;
  std::size_t corners_past_three_ = 0, left_out_ = 0, curves_ = 0;
  int first_left_out_ = 0;
  std::string left_out_key_;
  bool stop_ = false;
};

}  // namespace

Checked<PolygonMesh> read_obj(std::string bytes, const std::string& file, const FilesBeside& beside) {
  const std::string text = utf8_of(std::move(bytes));
  return ObjReader(text, file, beside).read();
}

}  // namespace luxrig
