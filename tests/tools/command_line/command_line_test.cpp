// Parsing, help, man page and completion of a small program.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>

#include "tools/command_line/choice.h"
#include "tools/command_line/help.h"
#include "tools/command_line/manual.h"
#include "tools/command_line/parse_command_line.h"

namespace luxrig {
namespace {

enum class Shape { round, square };

class CommandLine : public ::testing::Test {
 protected:
  CommandLine() {
    begin_command_line(app);
    app.require_subcommand(1);
    auto* draw = app.add_subcommand("draw", "draws -- a shape");
    draw->group("Work");
    draw->add_option("FILE", file, "where to")->required();
    add_choice<Shape, Shape>(*draw, "--shape", shape, "what it looks like",
                             {{"round", Shape::round}, {"square", Shape::square}},
                             {{"oval", "is refused, as it was neither: use round"}});
    draw->add_option("-s,--size", size, "how large")->check(CLI::Range(0.5, 8.0));
    draw->add_flag("--fill", fill, "inside, too");
    auto* list = app.add_subcommand("list", "what there is");
    list->group("Work");
    list->require_subcommand(1);
    list->add_subcommand("shapes", "all shapes");
    list->add_subcommand("files", "all files");
  }
  /// Exit code; -1 when the program goes on.
  int parse(std::vector<std::string> words) {
    words.insert(words.begin(), "tool");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    ::testing::internal::CaptureStderr();
    ::testing::internal::CaptureStdout();
    const auto end = parse_command_line(app, static_cast<int>(argv.size()), argv.data());
    output = ::testing::internal::GetCapturedStdout() + ::testing::internal::GetCapturedStderr();
    return end.value_or(-1);
  }
  CLI::App app{"a tool", "tool"};
  std::string file, output;
  Shape shape = Shape::square;
  double size = 2;
  bool fill = false;
};

TEST_F(CommandLine, TakesWhatIsRight) {
  EXPECT_EQ(parse({"draw", "x", "--shape", "round", "-s", "3", "--fill"}), -1) << output;
  EXPECT_EQ(shape, Shape::round);
  EXPECT_EQ(size, 3);
  EXPECT_TRUE(fill);
}

TEST_F(CommandLine, RefusesWhatIsMistypedWithTheNearest) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"darw", "x"}, "tool: there is no command \"darw\": did you mean \"draw\"?\n"},
      {{"draw", "x", "--shpae", "round"}, "tool draw: there is no option \"--shpae\": did you mean \"--shape\"?\n"},
      {{"draw", "--size=3", "x", "--fil"}, "tool draw: there is no option \"--fil\": did you mean \"--fill\"?\n"},
      {{"draw", "-s", "-1", "x", "y"}, "tool draw: \"y\" is too much: `tool draw --help` tells what it takes\n"},
      {{"list", "shape"}, "tool list: there is no command \"shape\": did you mean \"shapes\"?\n"},
      {{"list"}, "tool list: say which command: `tool list --help` tells all\n"},
  };
  for (const auto& [words, told] : cases) {
    EXPECT_EQ(parse(words), 2);
    EXPECT_EQ(output, told);
  }
  EXPECT_EQ(parse({"draw", "x", "--shape", "sqare"}), 2);
  EXPECT_NE(output.find("there is no \"sqare\": did you mean \"square\"?"), std::string::npos) << output;
}

TEST_F(CommandLine, RefusesAWordThatItNoLongerTakesWithTheReason) {
  EXPECT_EQ(parse({"draw", "x", "--shape", "oval"}), 2);
  EXPECT_EQ(output,
            "tool draw: --shape: \"oval\" is refused, as it was neither: use round: `tool draw --help` tells all\n");
  EXPECT_EQ(parse({"draw", "--help"}), 0);
  EXPECT_EQ(output.find("oval"), std::string::npos) << output;
  EXPECT_EQ(bash_completion(app).find("oval"), std::string::npos);
}

TEST_F(CommandLine, HelpIsInWords) {
  EXPECT_EQ(parse({"draw", "--help"}), 0);
  for (const char* text : {"what it looks like; round or square; default square", "-s, --size N",
                           "how large; 0.5 to 8; default 2", "--fill                    inside, too\n"})
    EXPECT_NE(output.find(text), std::string::npos) << text << "\n" << output;
  EXPECT_EQ(parse({"--help"}), 0);
  EXPECT_NE(output.find("Work:\n  draw "), std::string::npos) << output;
}

TEST_F(CommandLine, TheManPageHasEveryCommandAndOption) {
  const std::string page = man_page(app);
  for (const char* text : {".TH TOOL 1", ".SH WORK\n", ".SS tool draw FILE [options]\ndraws \\-\\- a shape\n",
                           ".B \\-s, \\-\\-size N\nhow large; 0.5 to 8; default 2\n", ".SS tool list shapes [options]"})
    EXPECT_NE(page.find(text), std::string::npos) << text << "\n" << page;
}

/// What bash offers for these words, the last of which is being typed.
std::string offered(const std::string& script, const std::string& words, int last) {
  const std::string file = ::testing::TempDir() + "luxrig-completion";
  std::ofstream(file) << script << "COMP_WORDS=(" << words << ")\nCOMP_CWORD=" << last
                      << "\n_tool\necho \"${COMPREPLY[*]}\"\n";
  std::string told;
  std::FILE* const bash = ::popen(("bash " + file).c_str(), "r");
  std::array<char, 256> part{};
  while (std::fgets(part.data(), part.size(), bash) != nullptr) told += part.data();
  ::pclose(bash);
  return told;
}

TEST_F(CommandLine, BashCompletesCommandsOptionsAndWords) {
  const std::string script = bash_completion(app);
  EXPECT_EQ(offered(script, "tool d", 1), "draw\n");
  EXPECT_EQ(offered(script, "tool draw --s", 2), "--shape --size\n");
  EXPECT_EQ(offered(script, "tool draw x --shape ''", 4), "round square\n");
  EXPECT_EQ(offered(script, "tool list ''", 2), "shapes files\n");
  EXPECT_EQ(offered(script, "tool draw ''", 2), "\n") << "files";
}

}  // namespace
}  // namespace luxrig
