#pragma once
/// Which files the mesh importer may open, and what is checked before it opens one. Internal to mesh_file.cpp.

#include <assimp/DefaultIOSystem.h>

#include <assimp/Importer.hpp>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace luxrig {

struct Refusal {
  std::string what;
  std::string mend;
};

/// In lower case, without its dot.
[[nodiscard]] std::string extension_of(const std::filesystem::path& path);

/// Why a mesh file is not even opened: absent, not a regular file, of no known kind, empty or huge.
[[nodiscard]] std::optional<Refusal> why_not_opened(const std::filesystem::path& path);

/// Reads, and only below one folder: a mesh names further files (.mtl, .bin), which must not reach elsewhere.
class AllowedFiles final : public Assimp::DefaultIOSystem {
 public:
  explicit AllowedFiles(const std::filesystem::path& mesh);

  bool Exists(const char* file) const override;
  Assimp::IOStream* Open(const char* file, const char* mode) override;

  /// Names of the materials for which an opened .mtl states a diffuse colour (Kd).
  [[nodiscard]] std::set<std::string> materials_with_colour() const;

 private:
  [[nodiscard]] bool allowed(const std::filesystem::path& file) const;

  std::filesystem::path folder_;  // canonical
  std::vector<std::filesystem::path> material_files_;
};

/// Leaves `importer` only the reader for the extension of `mesh`, and only the files beside it.
/// returns its file system, which the importer owns
AllowedFiles* restrict_to(Assimp::Importer& importer, const std::filesystem::path& mesh);

}  // namespace luxrig
