#include "core/scene/mesh_files_allowed.h"

#include <assimp/BaseImporter.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <sstream>

namespace luxrig {
namespace {

constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{8} << 30;
constexpr std::array<const char*, 5> kExtensions = {"obj", "ply", "stl", "gltf", "glb"};

}  // namespace

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension.empty() ? extension : extension.substr(1);
}

std::optional<Refusal> why_not_opened(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {  // a pipe would block
    return Refusal{"no such mesh file", "correct its name, relative to the rig file"};
  }
  const std::string extension = extension_of(path);
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end()) {
    return Refusal{"is of no known mesh format", "give an .obj, .ply, .stl, .gltf or .glb file"};
  }
  const auto bytes = std::filesystem::file_size(path, error);
  if (error || bytes == 0) return Refusal{"is empty", "give the whole file"};
  if (bytes > kMaxFileBytes) return Refusal{"is larger than 8 GiB", "give a simplified mesh"};
  return std::nullopt;
}

AllowedFiles::AllowedFiles(const std::filesystem::path& mesh)
    : folder_(std::filesystem::canonical(mesh).parent_path()) {}

bool AllowedFiles::allowed(const std::filesystem::path& file) const {
  std::error_code error;
  const auto real = std::filesystem::canonical(file, error);  // links followed: what counts is where it is
  if (error || !std::filesystem::is_regular_file(real, error)) return false;
  const auto [folder_end, rest] = std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end());
  return folder_end == folder_.end();
}

bool AllowedFiles::Exists(const char* file) const { return allowed(file); }

Assimp::IOStream* AllowedFiles::Open(const char* file, const char* mode) {
  if (std::strchr(mode, 'w') != nullptr || std::strchr(mode, 'a') != nullptr || !allowed(file)) return nullptr;
  if (extension_of(file) == "mtl") material_files_.emplace_back(file);
  return DefaultIOSystem::Open(file, mode);
}

std::set<std::string> AllowedFiles::materials_with_colour() const {
  std::set<std::string> names;
  for (const auto& file : material_files_) {
    std::ifstream in(file);
    std::string name;
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      std::string key;
      if (!(words >> key)) continue;
      if (key == "newmtl") {
        std::getline(words >> std::ws, name);
        name.erase(name.find_last_not_of(" \t\r") + 1);
      } else if (key == "Kd") {
        names.insert(name);
      }
    }
  }
  return names;
}

AllowedFiles* restrict_to(Assimp::Importer& importer, const std::filesystem::path& mesh) {
  const std::string extension = extension_of(mesh);
  // Backwards, since each removal shifts the rest. Without this assimp tries further formats on what one rejects.
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* const reader = importer.GetImporter(i);
    std::set<std::string> extensions;
    reader->GetExtensionList(extensions);
    if (extensions.count(extension) > 0) continue;
    importer.UnregisterLoader(reader);
    delete reader;  // unregistering hands it back
  }
  auto* const files = new AllowedFiles(mesh);
  importer.SetIOHandler(files);  // owns it from here
  return files;
}

}  // namespace luxrig
