// The output of --version, and how the build finds the commit.
#include <regex>

#include "tests/tools/programs/process.h"

namespace luxrig::testing {
namespace {

/// Output of a shell for these lines, without the final newline.
std::string shell(const std::string& lines) {
  Ran ran = luxrig::testing::run({"/bin/bash", "-c", "set -e; exec 2>&1; unset GIT_DIR; " + lines});
  EXPECT_EQ(ran.code, 0) << lines << ran.output;
  while (ran.output.ends_with('\n')) ran.output.pop_back();
  return ran.output;
}

/// The commit of the source; empty if it is not a repository of its own.
std::string commit_of_source() {
  const std::string git = "git -C '" + source("") + "' rev-parse ";
  return shell("[[ -z $(" + git + "--show-prefix 2>/dev/null || echo none) ]] && " + git + "--short HEAD || true");
}

TEST(Version, OfEveryProgramNamesItsCommit) {
  const std::string commit = commit_of_source();
  for (const char* name : {"luxrig", "luxrigd", "luxrig-sim", "luxrig-guardian"}) {
    const Ran ran = luxrig::testing::run({program(name), "--version"});
    EXPECT_EQ(ran.code, 0) << name << ran.output;
    const std::regex wanted(std::string(name) + " [0-9]+\\.[0-9]+\\.[0-9]+" +
                            (commit.empty() ? "" : " \\(" + commit + "(-dirty)?\\)") + "\n");
    EXPECT_TRUE(std::regex_match(ran.output, wanted)) << ran.output << "of " << commit << ": build anew";
  }
}

/// A source folder, and the version file that the build makes of it.
class Source {
 public:
  /// "0.1.0 (8022d83)".
  std::string version() {
    shell("cmake -D SOURCE='" + folder() + "' -D VERSION=0.1.0 -D OUTPUT='" + file() + "' -P '" +
          source("tools/command_line/commit.cmake") + "'");
    const std::string text = text_of(file());
    const auto from = text.find('"', text.find("kVersion")) + 1;
    return text.substr(from, text.find('"', from) - from);
  }
  std::string git(const std::string& words) {
    return shell("git -C '" + folder() + "' -c user.name=a -c user.email=a@b -c commit.gpgsign=false " + words);
  }
  std::string folder() { return (all_ / "source").string(); }
  std::string file() { return (all_ / "commit.cpp").string(); }
  void write(const std::string& text) { std::ofstream(all_ / "source/one.cpp") << text; }
  Source() { std::filesystem::create_directory(all_ / "source"); }

 private:
  Folder all_;
};

TEST(Version, OfATarballIsOnlyTheNumber) {
  Source tree;
  tree.write("1");
  EXPECT_EQ(tree.version(), "0.1.0");
}

TEST(Version, NamesTheCommitAndMarksADirtyTree) {
  Source tree;
  tree.write("1");
  tree.git("init -q");
  EXPECT_EQ(tree.version(), "0.1.0") << "no commit yet";
  tree.git("add one.cpp");
  tree.git("commit -q -m one");
  const std::string one = tree.git("rev-parse --short HEAD");
  EXPECT_EQ(tree.version(), "0.1.0 (" + one + ")");
  tree.write("two");
  EXPECT_EQ(tree.version(), "0.1.0 (" + one + "-dirty)");
  tree.git("commit -q -a -m two");
  const std::string two = tree.git("rev-parse --short HEAD");
  EXPECT_NE(two, one);
  EXPECT_EQ(tree.version(), "0.1.0 (" + two + ")");
}

TEST(Version, IgnoresAnEnclosingRepository) {
  Source tree;
  tree.write("1");
  shell("cd '" + tree.folder() +
        "/..' && git init -q && git add . && git -c user.name=a -c user.email=a@b commit -q -m a");
  EXPECT_EQ(tree.version(), "0.1.0");
}

TEST(Version, IsWrittenOnlyWhenItChanges) {
  Source tree;
  tree.git("init -q");
  tree.git("commit -q --allow-empty -m one");
  tree.version();
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(1);
  std::filesystem::last_write_time(tree.file(), long_ago);
  tree.version();
  EXPECT_EQ(std::filesystem::last_write_time(tree.file()), long_ago) << "nothing is compiled anew";
  tree.git("commit -q --allow-empty -m two");
  tree.version();
  EXPECT_NE(std::filesystem::last_write_time(tree.file()), long_ago);
}

}  // namespace
}  // namespace luxrig::testing
