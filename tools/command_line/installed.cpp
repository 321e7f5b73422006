#include "tools/command_line/installed.h"

#include <algorithm>
#include <system_error>

#include "tools/command_line/completion.h"

namespace luxrig {

std::filesystem::path shared_folder() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return self.parent_path().parent_path() / "share/luxrig";
}

std::vector<std::string> shipped_rigs() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(shared_folder() / "rigs", error))
    if (std::filesystem::exists(entry.path() / "rig.toml", error)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

CLI::Option* add_rig_option(CLI::App& app, std::filesystem::path& rig) {
  return app.add_option("RIG", rig, "rig file, a folder with a rig.toml, or the name of a rig that came with Luxrig")
      ->required()
      ->transform(CLI::Validator(
          [](std::string& given) -> std::string {
            std::error_code error;
            if (given.empty() || given.find('/') != std::string::npos || std::filesystem::exists(given, error))
              return "";
            const auto shipped = shared_folder() / "rigs" / given;
            if (std::filesystem::exists(shipped / "rig.toml", error)) given = shipped.string();
            return "";
          },
          "", kOffersRigs));
}

}  // namespace luxrig
