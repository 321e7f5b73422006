#include "core/scene/mesh/files_beside.h"

#include <algorithm>
#include <fstream>

#include "core/text/plain_text.h"

namespace luxrig {
namespace {

constexpr std::size_t kMaxTextureBytes = std::size_t{256} << 20;
constexpr std::size_t kMaxTextures = 1000;
constexpr int kMaxEntriesLookedAt = 100'000;

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

}  // namespace

std::optional<std::string> whole_file(const std::filesystem::path& path, std::size_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;  // a pipe would block
  const auto bytes = std::filesystem::file_size(path, error);
  if (error || bytes > max_bytes) return std::nullopt;
  std::ifstream in(path, std::ios::binary);
  std::string content(bytes, '\0');
  in.read(content.data(), static_cast<std::streamsize>(bytes));
  if (in.bad() || !in.is_open()) return std::nullopt;
  content.resize(static_cast<std::size_t>(in.gcount()));
  return content;
}

FolderBeside::FolderBeside(const std::filesystem::path& mesh)
    : folder_(std::filesystem::canonical(mesh).parent_path()) {}

std::optional<std::filesystem::path> FolderBeside::find(const std::string& name) const {
  if (name.empty() || name.find('\0') != std::string::npos) return std::nullopt;
  const auto inside = [&](const std::filesystem::path& file) -> std::optional<std::filesystem::path> {
    std::error_code error;
    const auto real = std::filesystem::canonical(file, error);  // links followed, since its real location counts
    if (error || !std::filesystem::is_regular_file(real, error)) return std::nullopt;
    const auto [folder_end, rest] = std::mismatch(folder_.begin(), folder_.end(), real.begin(), real.end());
    if (folder_end != folder_.end()) return std::nullopt;
    return real;
  };
  if (auto exact = inside(folder_ / name)) return exact;
  std::string slashed = name;
  std::replace(slashed.begin(), slashed.end(), '\\', '/');
  if (slashed != name) {
    if (auto found = inside(folder_ / slashed)) return found;
  }
  const std::string last = lower_case(std::filesystem::path(slashed).filename().string());
  if (last.empty()) return std::nullopt;
  // Beside the mesh, or in the folder given in the name.
  for (const auto& folder : {folder_, folder_ / std::filesystem::path(slashed).parent_path()}) {
    std::error_code error;
    int looked_at = 0;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
      if (++looked_at > kMaxEntriesLookedAt) break;
      if (lower_case(entry->path().filename().string()) != last) continue;
      if (auto found = inside(entry->path())) return found;
    }
  }
  return std::nullopt;
}

std::optional<std::string> FolderBeside::read(const std::string& name, std::size_t max_bytes) const {
  const auto path = find(name);
  return path ? whole_file(*path, max_bytes) : std::nullopt;
}

std::shared_ptr<const Texture> TextureShelf::of_file(const std::string& name, std::vector<std::string>& warnings) {
  if (const auto known = textures_.find(name); known != textures_.end()) return known->second;
  const auto bytes = beside_.read(name, kMaxTextureBytes);
  if (bytes) return of_bytes(name, *bytes, warnings);
  if (textures_.size() < kMaxTextures) textures_.emplace(name, nullptr);
  warnings.push_back("texture " + in_quotes(name) +
                     " is not beside the mesh: what it covers gets the rig's reflectance");
  return nullptr;
}

std::shared_ptr<const Texture> TextureShelf::of_bytes(const std::string& name, std::string_view bytes,
                                                      std::vector<std::string>& warnings) {
  if (const auto known = textures_.find(name); known != textures_.end()) return known->second;
  DecodedTexture decoded = textures_.size() < kMaxTextures ? decode_texture(bytes)
                                                           : DecodedTexture{nullptr, "is one of more than a thousand"};
  if (!decoded.texture)
    warnings.push_back("texture " + in_quotes(name) + " " + decoded.trouble +
                       ": what it covers gets the rig's reflectance");
  if (textures_.size() < kMaxTextures) textures_.emplace(name, decoded.texture);
  return decoded.texture;
}

}  // namespace luxrig
