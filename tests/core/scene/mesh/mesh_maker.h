#pragma once
/// Mesh files for the tests, made in memory.

#include <array>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace luxrig::test {

template <class T>
void put_bytes(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// A glTF with a buffer of its own, filled accessor by accessor.
struct GltfMaker {
  nlohmann::json root = nlohmann::json::parse(
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
          "meshes":[{"primitives":[{"attributes":{},"material":0}]}],"materials":[{"name":"wall"}],
          "accessors":[],"bufferViews":[],"buffers":[]})");
  std::string bytes;

  std::size_t view(const std::string& content) {
    while (bytes.size() % 4 != 0) bytes += '\0';
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", content.size()}});
    bytes += content;
    return root["bufferViews"].size() - 1;
  }
  template <class T>
  std::size_t accessor(const std::vector<T>& values, int component_type, const char* type, std::size_t count) {
    std::string content;
    for (const T value : values) put_bytes(content, value);
    root["accessors"].push_back(
        {{"bufferView", view(content)}, {"componentType", component_type}, {"type", type}, {"count", count}});
    return root["accessors"].size() - 1;
  }
  nlohmann::json& primitive() { return root["meshes"][0]["primitives"][0]; }
  nlohmann::json& attributes() { return primitive()["attributes"]; }

  /// A unit square in x and y (glTF's up is y), two triangles, the picture's upper left at (0, 1).
  static GltfMaker square() {
    GltfMaker out;
    out.attributes()["POSITION"] = out.accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 5126, "VEC3", 4);
    out.attributes()["TEXCOORD_0"] = out.accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, 5126, "VEC2", 4);
    out.primitive()["indices"] = out.accessor<std::uint16_t>({0, 1, 2, 0, 2, 3}, 5123, "SCALAR", 6);
    return out;
  }

  [[nodiscard]] std::string glb() const {
    nlohmann::json whole = root;
    whole["buffers"].insert(whole["buffers"].begin(), nlohmann::json{{"byteLength", bytes.size()}});
    std::string text = whole.dump(), binary = bytes;
    while (text.size() % 4 != 0) text += ' ';
    while (binary.size() % 4 != 0) binary += '\0';
    std::string out = "glTF";
    put_bytes(out, std::uint32_t{2});
    put_bytes(out, static_cast<std::uint32_t>(28 + text.size() + binary.size()));
    put_bytes(out, static_cast<std::uint32_t>(text.size()));
    out += "JSON" + text;
    put_bytes(out, static_cast<std::uint32_t>(binary.size()));
    out += std::string("BIN\0", 4) + binary;
    return out;
  }
};

/// A chunk of a .3ds: its number, its size, its content.
inline std::string tds_chunk(int id, const std::string& content) {
  std::string out;
  put_bytes(out, static_cast<std::uint16_t>(id));
  put_bytes(out, static_cast<std::uint32_t>(6 + content.size()));
  return out + content;
}

/// A right triangle of 1000 by 2000 units in x and y, of a material "oak" in sRGB 128, 128, 128.
inline std::string triangle_3ds() {
  std::string vertices, faces, group = std::string("oak\0", 4);
  put_bytes(vertices, std::uint16_t{3});
  for (const float value : {0.f, 0.f, 0.f, 1000.f, 0.f, 0.f, 0.f, 2000.f, 0.f}) put_bytes(vertices, value);
  put_bytes(faces, std::uint16_t{1});
  for (const int index : {0, 1, 2, 7}) put_bytes(faces, static_cast<std::uint16_t>(index));
  put_bytes(group, std::uint16_t{1});
  put_bytes(group, std::uint16_t{0});
  const std::string colour = tds_chunk(0x0011, "\x80\x80\x80");
  const std::string material =
      tds_chunk(0xAFFF, tds_chunk(0xA000, std::string("oak\0", 4)) + tds_chunk(0xA020, colour));
  const std::string mesh =
      tds_chunk(0x4100, tds_chunk(0x4110, vertices) + tds_chunk(0x4120, faces + tds_chunk(0x4130, group)));
  return tds_chunk(0x4D4D, tds_chunk(0x3D3D, material + tds_chunk(0x4000, std::string("floor\0", 6) + mesh)));
}

}  // namespace luxrig::test
