#include "core/scene/mesh/tds_file.h"

#include <algorithm>
#include <cstring>
#include <map>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr int kDeepestChunk = 16;

/// A range of the file. Reads past its end give zero and are recorded.
class ChunkBytes {
 public:
  explicit ChunkBytes(std::string_view bytes) : bytes_(bytes) {}

  template <class T>
  T take() {
    T value{};
    if (bytes_.size() - at_ < sizeof value) {
      at_ = bytes_.size();
      short_ = true;
      return value;
    }
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::string take_name() {
    const auto end = bytes_.find('\0', at_);
    const std::string_view name = bytes_.substr(at_, end == std::string_view::npos ? end : end - at_);
    at_ = std::min(bytes_.size(), at_ + name.size() + 1);
    return std::string(name);
  }
  std::string_view take_bytes(std::size_t count) {
    const std::string_view part = bytes_.substr(at_, count);
    short_ = short_ || part.size() < count;
    at_ += part.size();
    return part;
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] bool ran_short() const { return short_; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool short_ = false;
};

class TdsReader {
 public:
  TdsReader(const std::string& file, const FilesBeside& beside) : file_(file), textures_(beside) {}

  Checked<PolygonMesh> read(std::string_view bytes) {
    std::uint16_t first = 0;
    if (bytes.size() >= 6) std::memcpy(&first, bytes.data(), sizeof first);
    if (first != 0x4D4D) return refuse("is no .3ds: it begins otherwise", "export it again");
    read_chunks(ChunkBytes(bytes), 0);
    if (short_) return refuse("is cut short", "give the whole file");
    if (mesh_.corner_counts.size() > kMaxTriangles)
      return refuse("has more than 50 million triangles", "give a simplified mesh");
    if (!mesh_.corner_uvs.empty()) mesh_.corner_uvs.resize(mesh_.corners.size(), kNoIndex);
    for (FileMaterial& material : mesh_.materials) {
      const auto texture = texture_names_.find(material.name);
      if (texture == texture_names_.end()) continue;
      material.texture = textures_.of_file(texture->second, mesh_.warnings);
      material.unknown = material.texture == nullptr;
      material.colour.reset();  // 3D Studio shows the picture instead of it
    }
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] tl::unexpected<std::vector<Problem>> refuse(std::string what, std::string mend) const {
    return tl::unexpected(std::vector<Problem>{{file_, 0, 0, std::move(what), std::move(mend)}});
  }

  void read_chunks(ChunkBytes bytes, int depth) {
    while (bytes.left() >= 6 && !short_) {
      const auto id = bytes.take<std::uint16_t>();
      const auto size = bytes.take<std::uint32_t>();
      if (size < 6) {
        short_ = true;
        return;
      }
      ChunkBytes content(bytes.take_bytes(size - 6));
      short_ = short_ || bytes.ran_short();
      read_chunk(id, content, depth);
    }
  }

  void read_chunk(std::uint16_t id, ChunkBytes& content, int depth) {
    if (depth >= kDeepestChunk) return;
    switch (id) {
      case 0x4D4D:  // the file
      case 0x3D3D:  // its meshes and materials
        return read_chunks(content, depth + 1);
      case 0x4000:  // an object
        (void)content.take_name();
        return read_chunks(content, depth + 1);
      case 0x4100:  // a mesh
        vertex_base_ = mesh_.vertices.size();
        uv_base_ = mesh_.uvs.size();
        face_base_ = mesh_.corner_counts.size();
        read_chunks(content, depth + 1);
        return add_uvs();
      case 0x4110:
        return read_vertices(content);
      case 0x4120:
        read_faces(content);
        return read_chunks(content, depth + 1);
      case 0x4130:
        return read_face_material(content);
      case 0x4140:
        return read_uvs(content);
      case 0xAFFF:  // a material
        material_ = nullptr;
        return read_chunks(content, depth + 1);
      case 0xA000:
        material_ = &mesh_.materials[material_of(made_plain(content.take_name()))];
        return;
      case 0xA020:
        return read_colour(content);
      case 0xA200:
        return read_chunks(content, depth + 1);
      case 0xA300:
        if (material_ != nullptr) texture_names_[material_->name] = content.take_name();
        return;
      default:
        return;
    }
  }

  void read_vertices(ChunkBytes& content) {
    const std::size_t count = content.take<std::uint16_t>();
    for (std::size_t i = 0; i < count && !content.ran_short(); ++i) {
      const auto x = content.take<float>(), y = content.take<float>(), z = content.take<float>();
      mesh_.vertices.push_back(Vec3f(x, y, z).cast<double>());
    }
    short_ = short_ || content.ran_short();
  }

  void read_uvs(ChunkBytes& content) {
    const std::size_t count = content.take<std::uint16_t>();
    for (std::size_t i = 0; i < count && !content.ran_short(); ++i) {
      const auto u = content.take<float>(), v = content.take<float>();
      mesh_.uvs.push_back({u, 1 - v});  // counted from below
    }
    short_ = short_ || content.ran_short();
  }

  void read_faces(ChunkBytes& content) {
    const std::size_t count = content.take<std::uint16_t>();
    const std::uint32_t unnamed = material_of(kUnnamedMaterial);
    const std::size_t vertices = mesh_.vertices.size() - vertex_base_;
    for (std::size_t i = 0; i < count && !content.ran_short(); ++i) {
      for (int corner = 0; corner < 3; ++corner) {
        const std::size_t index = content.take<std::uint16_t>();
        mesh_.corners.push_back(index < vertices ? static_cast<std::uint32_t>(vertex_base_ + index) : kNoIndex);
      }
      (void)content.take<std::uint16_t>();  // which edges show
      mesh_.corner_counts.push_back(3);
      mesh_.face_materials.push_back(unnamed);
    }
    short_ = short_ || content.ran_short();
  }

  void read_face_material(ChunkBytes& content) {
    const std::uint32_t material = material_of(made_plain(content.take_name()));
    const std::size_t count = content.take<std::uint16_t>();
    for (std::size_t i = 0; i < count && !content.ran_short(); ++i) {
      const std::size_t face = face_base_ + content.take<std::uint16_t>();
      if (face < mesh_.face_materials.size()) mesh_.face_materials[face] = material;
    }
    short_ = short_ || content.ran_short();
  }

  /// Either every vertex of a mesh has a point of the picture, or none has.
  void add_uvs() {
    const std::size_t uvs = mesh_.uvs.size() - uv_base_;
    if (uvs == 0) return;
    const std::size_t before = mesh_.corner_uvs.size();
    mesh_.corner_uvs.resize(mesh_.corners.size(), kNoIndex);
    for (std::size_t i = std::max(before, 3 * face_base_); i < mesh_.corners.size(); ++i) {
      const std::size_t vertex = mesh_.corners[i] - vertex_base_;
      if (mesh_.corners[i] != kNoIndex && vertex < uvs)
        mesh_.corner_uvs[i] = static_cast<std::uint32_t>(uv_base_ + vertex);
    }
  }

  void read_colour(ChunkBytes& content) {
    if (material_ == nullptr) return;
    while (content.left() >= 6) {
      const auto id = content.take<std::uint16_t>();
      const auto size = content.take<std::uint32_t>();
      ChunkBytes rgb(content.take_bytes(std::max(size, std::uint32_t{6}) - 6));
      Vec3 colour;
      if (id == 0x0011 || id == 0x0012) {
        for (double& part : colour) part = rgb.take<std::uint8_t>() / 255.0;
      } else if (id == 0x0010 || id == 0x0013) {
        for (double& part : colour) part = std::clamp(static_cast<double>(rgb.take<float>()), 0.0, 1.0);
      } else {
        continue;
      }
      if (rgb.ran_short() || !colour.allFinite()) continue;
      material_->colour = colour.unaryExpr(&linear_of_srgb);
      return;  // a second one, if any, repeats it
    }
  }

  std::uint32_t material_of(const std::string& name) {
    const auto [at, is_new] = materials_.try_emplace(name, static_cast<std::uint32_t>(mesh_.materials.size()));
    if (is_new) {
      const std::ptrdiff_t open = material_ != nullptr ? material_ - mesh_.materials.data() : -1;
      mesh_.materials.emplace_back();
      mesh_.materials.back().name = name;
      material_ = open >= 0 ? &mesh_.materials[static_cast<std::size_t>(open)] : nullptr;
    }
    return at->second;
  }

  const std::string& file_;
  TextureShelf textures_;
  PolygonMesh mesh_;
  std::map<std::string, std::uint32_t> materials_;
  std::map<std::string, std::string> texture_names_;  // by material
  FileMaterial* material_ = nullptr;
  std::size_t vertex_base_ = 0, uv_base_ = 0, face_base_ = 0;
  bool short_ = false;
};

}  // namespace

Checked<PolygonMesh> read_3ds(std::string_view bytes, const std::string& file, const FilesBeside& beside) {
  return TdsReader(file, beside).read(bytes);
}

}  // namespace luxrig
