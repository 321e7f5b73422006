// init: a commented rig to start from, a copy of `rigs/start`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/text/plain_text.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/installed.h"
#include "tools/luxrig/commands.h"
#include "tools/process/files.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

constexpr std::string_view kNameOfStart = "name = \"start\"\n";

/// Never overwrites a rig.
int run_init(const std::filesystem::path& folder) {
  const std::filesystem::path rig_file = folder / "rig.toml";
  std::error_code error;
  const auto refused = [&rig_file](std::string what, std::string mend) {
    return report(std::vector<Problem>{{rig_file.string(), 0, 0, std::move(what), std::move(mend)}});
  };
  if (std::filesystem::exists(rig_file, error))
    return refused("there is a rig already", "name another folder, or move that file away");
  if (std::filesystem::exists(folder, error) && !std::filesystem::is_directory(folder, error))
    return refused(folder.string() + " is a file", "name another folder");
  const std::filesystem::path start = shared_folder() / "rigs/start/rig.toml";
  auto text = read_file(start);
  if (!text) {
    return report(Fault{Cause::system, "", start.string() + " is missing: install Luxrig again, or build it anew", {}});
  }
  const auto name_at = text->find(kNameOfStart);
  if (name_at == std::string::npos)
    return report(Fault{Cause::system, "", start.string() + " is not the rig that came with this Luxrig", {}});
  // "gallery", "gallery/" and "." give the same place.
  auto place = std::filesystem::weakly_canonical(folder, error);
  if (!place.has_filename()) place = place.parent_path();
  std::string name = made_plain(place.filename().string());
  if (name.empty()) name = "rig";
  std::string quoted;
  for (const char c : name) quoted += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  text->replace(name_at, kNameOfStart.size(), "name = \"" + quoted + "\"\n");
  std::filesystem::create_directories(folder, error);
  if (error) return report(Fault{Cause::system, "", folder.string() + ": " + error.message(), {}});
  if (const auto written = write_file(rig_file, *text); !written) return report(written.error());
  fmt::print(
      "{0}\nnext: luxrig run {1} --sim shows it on simulated devices; then make it yours: every line says what it is "
      "for\n",
      rig_file.string(), folder.string());
  return kExitOk;
}

Action declare_init(CLI::App& command) {
  const auto folder = std::make_shared<std::filesystem::path>();
  command.add_option("NAME", *folder, "folder to make")->required()->check(offers_folders());
  return [folder] { return run_init(*folder); };
}

}  // namespace

const Command kInitCommand{"init", command_group::kSet, "a commented rig to start from, in a folder of that name",
                           declare_init};

}  // namespace luxrig
