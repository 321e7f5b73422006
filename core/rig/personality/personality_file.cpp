#include "core/rig/personality/personality_file.h"

#include <fstream>

#include "core/rig/personality/gdtf/gdtf_file.h"
#include "core/rig/personality/ofl/ofl_file.h"
#include "core/rig/personality/zip_archive.h"

namespace luxrig {

Checked<Personality> load_personality(const std::filesystem::path& path) {
  const auto refuse = [&](std::string what, std::string mend) {
    return tl::unexpected(std::vector<Problem>{{path.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  if (error) return refuse("no such file, or it cannot be read", "put it there, or correct the path");
  if (size > kMaxZipBytes) return refuse("the file is larger than any fixture's", "do not trust it");
  std::ifstream in(path, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(size), '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in.is_open() || in.bad()) return refuse("the file cannot be read", "check who may read it");
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  const bool is_json = path.extension() == ".json";
  return is_json ? parse_ofl(bytes, path.parent_path().filename().string(), path.string())
                 : read_gdtf(std::move(bytes), path.string());
}

}  // namespace luxrig
