#pragma once
/// The other files that a mesh names (.mtl, .bin, pictures), restricted to its own folder or archive.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/texture.h"

namespace luxrig {

class FilesBeside {
 public:
  virtual ~FilesBeside() = default;
  /// The content of the named file; nullopt if there is none, or it is larger than `max_bytes`.
  [[nodiscard]] virtual std::optional<std::string> read(const std::string& name, std::size_t max_bytes) const = 0;
};

/// Files below the folder of a mesh, links followed. A Windows path is also found by its last part, ignoring case.
class FolderBeside final : public FilesBeside {
 public:
  explicit FolderBeside(const std::filesystem::path& mesh);
  [[nodiscard]] std::optional<std::string> read(const std::string& name, std::size_t max_bytes) const override;

 private:
  [[nodiscard]] std::optional<std::filesystem::path> find(const std::string& name) const;
  std::filesystem::path folder_;  // canonical
};

/// The whole of a regular file; nullopt if it cannot be read, or is larger than `max_bytes`.
[[nodiscard]] std::optional<std::string> whole_file(const std::filesystem::path& path, std::size_t max_bytes);

/// The textures of one mesh, each read once.
class TextureShelf {
 public:
  explicit TextureShelf(const FilesBeside& beside) : beside_(beside) {}  ///< `beside` must outlive it

  /// Null and one warning if it cannot be read.
  std::shared_ptr<const Texture> of_file(const std::string& name, std::vector<std::string>& warnings);
  std::shared_ptr<const Texture> of_bytes(const std::string& name, std::string_view bytes,
                                          std::vector<std::string>& warnings);

 private:
  const FilesBeside& beside_;
  std::map<std::string, std::shared_ptr<const Texture>> textures_;
};

}  // namespace luxrig
