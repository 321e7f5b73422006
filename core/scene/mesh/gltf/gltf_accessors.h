#pragma once
/// The numbers of a glTF: its container, buffers and accessors, with all bounds checked. Internal to core/scene.

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "core/scene/mesh/files_beside.h"

namespace luxrig {

/// The named member; null if `object` is not an object or has no such member.
[[nodiscard]] const nlohmann::json* member_of(const nlohmann::json& object, const char* name);
[[nodiscard]] std::optional<std::size_t> index_member(const nlohmann::json& object, const char* name);
[[nodiscard]] double number_member(const nlohmann::json& object, const char* name, double otherwise);
[[nodiscard]] std::string text_member(const nlohmann::json& object, const char* name);
/// `count` numbers; nullopt if it is not that.
[[nodiscard]] std::optional<std::vector<double>> numbers_member(const nlohmann::json& object, const char* name,
                                                                std::size_t count);

/// Rows of numbers, converted on access (normalised integers to 0…1 or -1…1).
class Accessor {
 public:
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t components() const { return components_; }
  [[nodiscard]] double at(std::size_t row, std::size_t component) const;
  /// For indices.
  [[nodiscard]] std::uint32_t index_at(std::size_t row) const;
  [[nodiscard]] bool is_index() const {
    return components_ == 1 && !normalised_ && (type_ == 5121 || type_ == 5123 || type_ == 5125);
  }

 private:
  friend class GltfDocument;
  [[nodiscard]] double value(const char* bytes) const;

  std::string_view bytes_;  // empty = zeros
  std::size_t count_ = 0, components_ = 1, stride_ = 0;
  int type_ = 5126;
  bool normalised_ = false;
  std::map<std::size_t, std::size_t> sparse_;  // row -> row of sparse_bytes_
  std::string_view sparse_bytes_;
};

/// Why a glTF is refused; filled in deep inside the reader.
struct GltfRefusal {
  std::string what, mend;
};

/// For an extension that changes the meaning of geometry.
[[nodiscard]] GltfRefusal unread_extension(const std::string& name);

class GltfDocument {
 public:
  /// Opens a .glb, known by its first bytes, or the JSON of a .gltf. `beside` must outlive the document.
  [[nodiscard]] static Checked<GltfDocument> open(std::string bytes, const std::string& file,
                                                  const FilesBeside& beside);

  [[nodiscard]] const nlohmann::json& root() const { return root_; }
  /// Entry `index` of an array of the root; null if there is none.
  [[nodiscard]] const nlohmann::json* entry(const char* array, std::size_t index) const;

  [[nodiscard]] tl::expected<Accessor, GltfRefusal> accessor(std::size_t index);
  /// The raw bytes of a buffer view.
  [[nodiscard]] tl::expected<std::string_view, GltfRefusal> view(std::size_t index);
  /// Data of an image or a buffer: base64 of a data: URI.
  [[nodiscard]] static std::optional<std::string> data_of_uri(const std::string& uri);
  /// A file name, with %20 and other escapes decoded.
  [[nodiscard]] static std::string name_of_uri(const std::string& uri);

 private:
  [[nodiscard]] tl::expected<std::string_view, GltfRefusal> buffer(std::size_t index);

  nlohmann::json root_;
  std::string file_bytes_;
  std::string_view binary_;  // of a .glb, inside file_bytes_
  std::map<std::size_t, std::string> buffers_;
  const FilesBeside* beside_ = nullptr;
};

}  // namespace luxrig
