// import: a rig folder from an MVR file.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "core/rig/mvr/mvr_rig.h"
#include "core/rig/rig_file.h"
#include "core/scene/mesh/mesh_reading.h"
#include "core/text/plain_text.h"
#include "tools/command_line/completion.h"
#include "tools/luxrig/commands.h"
#include "tools/process/files.h"
#include "tools/terminal/command.h"

namespace luxrig {
namespace {

struct ImportArguments {
  std::filesystem::path file;
  std::filesystem::path rig_folder;
};

std::vector<Problem> one_problem(const std::filesystem::path& file, std::string what, std::string mend) {
  return {{file.string(), 0, 0, std::move(what), std::move(mend)}};
}

/// Never overwrites a rig.
int run_import(const ImportArguments& arguments) {
  if (extension_of(arguments.file) != "mvr") {
    return report(one_problem(arguments.file, "not an MVR file by its name",
                              "name an .mvr file; a single fixture's file goes into the rig file as personality"));
  }
  const std::filesystem::path rig_file = arguments.rig_folder / "rig.toml";
  std::error_code error;
  if (std::filesystem::exists(rig_file, error))
    return report(one_problem(rig_file, "there is a rig already", "name another folder, or move that file away"));
  Checked<std::string> bytes = read_file(arguments.file);
  if (!bytes) return report(bytes.error());
  const Checked<MvrFile> mvr = read_mvr(std::move(*bytes), arguments.file.string());
  if (!mvr) return report(mvr.error());
  const ImportedRig rig = rig_of_mvr(*mvr, made_plain(arguments.file.stem().string()));
  std::filesystem::create_directories(arguments.rig_folder, error);
  if (error) return report(Fault{Cause::system, "", arguments.rig_folder.string() + ": " + error.message(), {}});
  for (const ImportedRig::File& file : rig.files) {
    if (const auto written = write_file(arguments.rig_folder / file.name, file.bytes); !written)
      return report(written.error());
  }
  if (const auto written = write_file(rig_file, rig.rig_toml); !written) return report(written.error());
  for (const std::string& remark : rig.remarks) fmt::print("{}\n", remark);
  const std::size_t personalities = rig.files.size() - (rig.models > 0 ? 2 : 0);  // not counting the scene's two files
  fmt::print("{}: {} fixtures of {} kinds, {} personalities beside it{}\n", rig_file.string(), rig.fixtures,
             rig.luminaires, personalities,
             rig.models > 0 ? fmt::format("; scene.obj: {} models of scenery", rig.models) : "");
  if (const Checked<Rig> read = load_rig(rig_file); !read) return report(read.error());
  fmt::print("next: fill in what says FILL IN, then luxrig check {}\n", arguments.rig_folder.string());
  return kExitOk;
}

Action declare_import(CLI::App& command) {
  const auto import_mvr = std::make_shared<ImportArguments>();
  command.add_option("FILE", import_mvr->file, "MVR file")->required()->check(offers_files());
  command.add_option("-o,--output", import_mvr->rig_folder, "folder to write rig.toml and the GDTF files to")
      ->required()
      ->check(offers_folders());
  command.footer("What hangs in the file, with positions, orientation, patch and personalities.");
  return [import_mvr] { return run_import(*import_mvr); };
}

}  // namespace

const Command kImportCommand{"import", command_group::kSet, "make a rig folder of an MVR file", declare_import};

}  // namespace luxrig
