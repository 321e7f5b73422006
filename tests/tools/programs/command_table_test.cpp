// The table of subcommands, and its products: help, man pages, completion.
#include "tools/luxrig/command_table.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "tests/tools/programs/process.h"

namespace luxrig::testing {
namespace {

constexpr std::size_t kTerminal = 80;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Width in UTF-8 characters.
std::size_t width_of(const std::string& line) {
  return static_cast<std::size_t>(
      std::count_if(line.begin(), line.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string help_of(std::vector<std::string> words) {
  words.insert(words.begin(), program("luxrig"));
  words.emplace_back("--help");
  const Ran ran = luxrig::testing::run(words);
  EXPECT_EQ(ran.code, 0) << ran.output;
  return ran.output;
}

/// Completions that the program offers for the last word, without their descriptions.
std::vector<std::string> offered(std::vector<std::string> words) {
  words.insert(words.begin(), {program("luxrig"), "--complete"});
  std::vector<std::string> lines = lines_of(luxrig::testing::run(words).output);
  if (!lines.empty()) lines.erase(lines.begin());
  for (std::string& line : lines) line = line.substr(0, line.find('\t'));
  return lines;
}

TEST(CommandTable, EveryCommandHasAUniqueNameAGroupAndAOneLineSummary) {
  std::set<std::string> names;
  std::vector<std::string> groups;
  for (const Command& command : command_table()) {
    EXPECT_TRUE(names.insert(command.name).second) << command.name;
    EXPECT_LE(width_of(command.summary), 66u) << command.name;
    EXPECT_GE(width_of(command.summary), 10u) << command.name;
    EXPECT_NE(command.declare != nullptr, command.program != nullptr) << command.name;
    ASSERT_NE(std::string(command.group), "") << command.name;
    if (groups.empty() || groups.back() != command.group) groups.emplace_back(command.group);
  }
  EXPECT_EQ(std::set<std::string>(groups.begin(), groups.end()).size(), groups.size())
      << "commands of a group stand together";
}

TEST(CommandTable, HelpListsEachCommandOnOneLineAndEndsWithAHint) {
  const std::vector<std::string> help = lines_of(help_of({}));
  std::string group;
  auto at = help.begin();
  for (const Command& command : command_table()) {
    if (group != command.group) at = std::find(at, help.end(), std::string(command.group) + ":");
    group = command.group;
    ASSERT_NE(at, help.end()) << command.group;
    ++at;
    EXPECT_TRUE(at->starts_with(std::string("  ") + command.name + " ")) << *at;
    EXPECT_TRUE(at->ends_with(std::string(" ") + command.summary)) << *at;
  }
  EXPECT_NE(help_of({}).find("luxrig COMMAND --help"), std::string::npos);
}

TEST(CommandTable, HelpOfEveryCommandFitsATerminal) {
  std::vector<std::vector<std::string>> all = {{}};
  for (const Command& command : command_table()) all.push_back({command.name});
  for (const char* command : {"rdm", "camera"})
    for (const std::string& inner : offered({command, ""})) all.push_back({command, inner});
  EXPECT_GE(all.size(), command_table().size() + 6) << "rdm and camera have commands of their own";
  for (const auto& words : all)
    for (const std::string& line : lines_of(help_of(words))) EXPECT_LE(width_of(line), kTerminal) << line;
}

TEST(CommandTable, EveryCommandHasAManPage) {
  for (const char* name : {"luxrig", "luxrig-bench", "luxrig-test", "luxrigd", "luxrig-sim"}) {
    const Folder folder;
    std::filesystem::create_directory(folder / "man1");
    const Ran ran = luxrig::testing::run({program(name), "--man-pages", (folder / "man1").string()});
    EXPECT_EQ(ran.code, 0) << ran.output;
    std::set<std::string> pages, wanted = {std::string(name) + ".1"};
    if (std::string(name) == "luxrig")
      for (const Command& command : command_table())
        if (command.program == nullptr) wanted.insert(std::string("luxrig-") + command.name + ".1");
    for (const auto& page : std::filesystem::directory_iterator(folder / "man1")) {
      pages.insert(page.path().filename().string());
      EXPECT_TRUE(text_of(page.path()).starts_with(".TH LUXRIG")) << page.path();
      EXPECT_NE(text_of(page.path()).find(".SH EXIT STATUS"), std::string::npos) << page.path();
    }
    EXPECT_EQ(pages, wanted);
  }
  EXPECT_EQ(luxrig::testing::run({program("luxrig"), "--man-pages", "/nowhere"}).code, 1);
}

TEST(CommandTable, ShellCompletionOffersEveryCommandAndItsOptions) {
  std::vector<std::string> names;
  for (const Command& command : command_table()) names.emplace_back(command.name);
  EXPECT_EQ(offered({""}), names);
  // Help and completion list the same.
  for (const Command& command : command_table()) {
    const std::string help = help_of({command.name});
    const std::vector<std::string> options = offered({command.name, "--"});
    EXPECT_EQ(std::count(options.begin(), options.end(), "--help"), 1) << command.name;
    for (const std::string& option : options) EXPECT_NE(help.find(option), std::string::npos) << command.name << option;
  }
}

/// Completions of the last word by bash with the program's script, separated by blanks.
std::string completed(const std::vector<std::string>& words, const std::string& folder = "/") {
  const std::string luxrig = "'" + program("luxrig") + "'";
  std::string line = "cd '" + folder + "'; source <(" + luxrig + " completion bash)\nCOMP_WORDS=(" + luxrig;
  for (const std::string& word : words) line += " '" + word + "'";
  line += ")\nCOMP_CWORD=" + std::to_string(words.size()) + "\n_luxrig\necho \"${COMPREPLY[*]}\"";
  return luxrig::testing::run({"/bin/bash", "-c", line}).output;
}

TEST(CommandTable, BashCompletesCommandsOptionsWordsAndRigs) {
  EXPECT_EQ(completed({"rel"}), "release reload\n");
  EXPECT_EQ(completed({"completion", ""}), "bash zsh fish\n");
  EXPECT_EQ(completed({"render", "gallery", "--false"}), "--false-colour\n");
  EXPECT_EQ(completed({"evaluate", "gallery", "--model", "g"}), "gather\n");
  EXPECT_EQ(completed({"evaluate", "--model", "=", "p"}), "path\n") << "as bash takes it apart";
  EXPECT_EQ(completed({"blackout", ""}), "on off\n");
  EXPECT_EQ(completed({"rdm", "set", "7ff0:00000001", "per"}), "personality\n");
  EXPECT_EQ(completed({"check", "gal"}), "gallery\n");
  const Folder folder;
  std::ofstream(folder / "gallows.toml") << "";
  EXPECT_EQ(completed({"check", "gal"}, (folder / "").string()), "gallery gallows.toml\n") << "files, too";
  EXPECT_EQ(completed({"apply", ""}), "\n") << "bash offers files by itself";
}

TEST(CommandTable, EveryProgramPrintsItsShellCompletions) {
  for (const char* name : {"luxrig", "luxrig-bench", "luxrig-test", "luxrigd", "luxrig-sim"}) {
    for (const char* shell : {"bash", "zsh", "fish"}) {
      const Ran ran = luxrig::testing::run({program(name), "--completion", shell});
      EXPECT_EQ(ran.code, 0) << name << shell;
      EXPECT_NE(ran.output.find("--complete"), std::string::npos) << ran.output;
      if (std::string(name) == "luxrig") {
        EXPECT_EQ(luxrig::testing::run({program(name), "completion", shell}).output, ran.output);
      }
    }
  }
  EXPECT_EQ(luxrig::testing::run({program("luxrig"), "completion", "fihs"}).code, 2);
}

}  // namespace
}  // namespace luxrig::testing
