// The commands in README.md exist and take the options written there, and its path from a new rig to a picture works.

#include <regex>
#include <set>

#include "tests/tools/programs/process.h"

namespace luxrig::testing {
namespace {

/// Words of each code span in lines such as "- `check RIG`: …; `--outputs` tells …" below "## Commands".
std::vector<std::vector<std::string>> commands_of_readme() {
  std::string text = text_of(source("README.md"));
  text.erase(0, text.find("## Commands"));
  text.erase(text.find("Exit codes"));
  std::vector<std::vector<std::string>> commands;
  const std::regex line("\n- ([^\n]*)"), span("`([^`]+)`"), word("[^ \\[\\]|…]+");
  for (std::sregex_iterator one(text.begin(), text.end(), line), end; one != end; ++one) {
    const std::string item = (*one)[1];
    for (std::sregex_iterator code(item.begin(), item.end(), span); code != end; ++code) {
      const std::string written = (*code)[1];
      std::vector<std::string> words;
      for (std::sregex_iterator w(written.begin(), written.end(), word); w != end; ++w) words.push_back(w->str());
      if (words.front().starts_with("-") && !commands.empty()) {
        commands.back().insert(commands.back().end(), words.begin(), words.end());
      } else if (words.front() != "luxrig-sim" && words.front() != "luxrigd") {
        commands.push_back(std::move(words));
      }
    }
  }
  return commands;
}

/// Subcommands that `luxrig --help` lists.
std::set<std::string> subcommands() {
  const std::string help = luxrig::testing::run({program("luxrig"), "--help"}).output;
  std::set<std::string> names;
  const std::regex line("\n  ([a-z][a-z-]*)  ");
  for (std::sregex_iterator one(help.begin(), help.end(), line), end; one != end; ++one) names.insert((*one)[1]);
  return names;
}

TEST(Readme, NamesExactlyTheExistingCommands) {
  std::set<std::string> told;
  for (const auto& words : commands_of_readme()) told.insert(words.front());
  std::set<std::string> known = subcommands();
  EXPECT_GT(known.size(), 15u);
  EXPECT_EQ(told, known);
}

TEST(Readme, UsesOnlyExistingOptions) {
  int options = 0;
  for (const auto& words : commands_of_readme()) {
    const std::string help = luxrig::testing::run({program("luxrig"), words.front(), "--help"}).output;
    for (const std::string& one : words) {
      if (!one.starts_with("-")) continue;
      ++options;
      EXPECT_TRUE(std::regex_search(help, std::regex("(^|[\\s,])" + one + "([\\s,\\[]|$)"))) << one << " of:\n" << help;
    }
  }
  EXPECT_GT(options, 3);
}

TEST(Readme, ANewRigIsCheckedEvaluatedSolvedAndDrawn) {
  const Folder folder;
  const std::string luxrig = program("luxrig"), rig = (folder / "mine").string(),
                    plan = (folder / "plan.json").string(), picture = (folder / "lit.png").string();
  for (const std::vector<std::string>& words : {std::vector<std::string>{"init", rig},
                                                {"check", rig},
                                                {"evaluate", rig},
                                                {"solve", rig, "-o", plan},
                                                {"render", rig, plan, "-o", picture, "--seconds", "1"},
                                                {"check", "gallery"}}) {
    std::vector<std::string> line = words;
    line.insert(line.begin(), luxrig);
    const Ran ran = luxrig::testing::run(line);
    EXPECT_EQ(ran.code, 0) << words.front() << ": " << ran.output;
  }
  EXPECT_GT(std::filesystem::file_size(picture), 1000u);
}

}  // namespace
}  // namespace luxrig::testing
