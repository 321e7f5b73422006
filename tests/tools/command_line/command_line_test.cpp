// Parsing, help, man pages and completion of a small program.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tools/command_line/choice.h"
#include "tools/command_line/completion.h"
#include "tools/command_line/help.h"
#include "tools/command_line/manual.h"
#include "tools/command_line/parse_command_line.h"

namespace luxrig {
namespace {

enum class Shape { round, square };

/// Width in UTF-8 characters.
std::size_t widest_line(const std::string& text) {
  std::size_t widest = 0, width = 0;
  for (const char c : text) {
    if (c == '\n')
      width = 0;
    else if ((static_cast<unsigned char>(c) & 0xC0) != 0x80)
      widest = std::max(widest, ++width);
  }
  return widest;
}

class CommandLine : public ::testing::Test {
 protected:
  CommandLine() {
    begin_command_line(app);
    app.require_subcommand(1);
    auto* draw = app.add_subcommand("draw", "draws -- a shape");
    draw->group("Work");
    draw->add_option("FILE", file, "where to")->required()->check(offers_files());
    add_choice<Shape, Shape>(*draw, "--shape", shape, "what it looks like",
                             {{"round", Shape::round}, {"square", Shape::square}},
                             {{"oval", "is refused, as it was neither: use round"}});
    draw->add_option("-s,--size", size, "how large")->check(CLI::Range(0.5, 8.0));
    draw->add_flag("--fill", fill, "inside, too");
    auto* copy = app.add_subcommand("copy", "to folders");
    copy->group("Work");
    copy->add_option("FILE", file, "what")->required()->check(offers_files());
    copy->add_option("FOLDERS", folders, "to where")->check(offers_folders());
    auto* list = app.add_subcommand("list", "what there is");
    list->group("Work");
    list->require_subcommand(1);
    list->add_subcommand("shapes", "all shapes");
    list->add_subcommand("files", "all files");
  }
  /// Exit code; -1 if the program goes on.
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
  Offer offer(const std::vector<std::string>& words) { return offer_for(app, words); }
  /// Completions of the last word, separated by blanks.
  std::string texts(const std::vector<std::string>& words) {
    std::string all;
    for (const Offer::Word& word : offer(words).words) all += (all.empty() ? "" : " ") + word.text;
    return all;
  }
  CLI::App app{"a tool", "tool"};
  std::string file, output;
  std::vector<std::string> folders;
  Shape shape = Shape::square;
  double size = 2;
  bool fill = false;
};

TEST_F(CommandLine, AcceptsValidArguments) {
  EXPECT_EQ(parse({"draw", "x", "--shape", "round", "-s", "3", "--fill"}), -1) << output;
  EXPECT_EQ(shape, Shape::round);
  EXPECT_EQ(size, 3);
  EXPECT_TRUE(fill);
}

TEST_F(CommandLine, RefusesTyposAndSuggestsTheNearestWord) {
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

TEST_F(CommandLine, RefusesARetiredWordWithTheReason) {
  EXPECT_EQ(parse({"draw", "x", "--shape", "oval"}), 2);
  EXPECT_EQ(output,
            "tool draw: --shape: \"oval\" is refused, as it was neither: use round: `tool draw --help` tells all\n");
  EXPECT_EQ(parse({"draw", "--help"}), 0);
  EXPECT_EQ(output.find("oval"), std::string::npos) << output;
  EXPECT_EQ(texts({"draw", "--shape", ""}), "round square");
}

TEST_F(CommandLine, HelpListsWordsAndDefaults) {
  EXPECT_EQ(parse({"draw", "--help"}), 0);
  for (const char* text : {"what it looks like; round or square; default square", "-s, --size N",
                           "how large; 0.5 to 8; default 2", "--fill                    inside, too\n"})
    EXPECT_NE(output.find(text), std::string::npos) << text << "\n" << output;
  EXPECT_EQ(parse({"--help"}), 0);
  EXPECT_NE(output.find("Work:\n  draw "), std::string::npos) << output;
}

TEST_F(CommandLine, NoLineOfHelpIsWiderThanATerminal) {
  app.get_subcommand("draw")->add_flag("--slowly", fill,
                                       "so that all who stand around can see how it is done, and may do the same "
                                       "some day when nobody stands around who could show them how it is done");
  EXPECT_EQ(parse({"draw", "--help"}), 0);
  EXPECT_EQ(widest_line(output), 80u) << output;
}

TEST_F(CommandLine, EveryCommandHasAManPageWithItsOptions) {
  const std::vector<ManPage> pages = man_pages(app);
  ASSERT_EQ(pages.size(), 4u);
  const std::pair<const char*, std::vector<const char*>> told[] = {
      {"tool", {".TH TOOL 1", ".SH WORK\n", ".BR tool\\-draw (1)\ndraws \\-\\- a shape\n"}},
      {"tool-draw",
       {".TH TOOL\\-DRAW 1", ".B tool draw FILE [options]\n", "tool\\-draw \\- draws \\-\\- a shape\n",
        ".B \\-s, \\-\\-size N\nhow large; 0.5 to 8; default 2\n"}},
      {"tool-copy", {".B tool copy FILE [FOLDERS...] [options]\n"}},
      {"tool-list", {".SS tool list shapes [options]\nall shapes\n", ".SH SEE ALSO\n.BR tool (1)\n"}}};
  for (std::size_t i = 0; i < pages.size(); ++i) {
    EXPECT_EQ(pages[i].name, told[i].first);
    for (const char* text : told[i].second)
      EXPECT_NE(pages[i].text.find(text), std::string::npos) << text << "\n" << pages[i].text;
  }
}

TEST_F(CommandLine, CommandsOptionsAndWordsAreOffered) {
  EXPECT_EQ(texts({""}), "draw copy list");
  EXPECT_EQ(offer({"dr"}).words.front().told, "draws -- a shape");
  EXPECT_EQ(texts({"-"}), "--help");
  EXPECT_EQ(texts({"draw", "--s"}), "--help --shape --size --fill");
  EXPECT_EQ(texts({"draw", "x", "--shape", ""}), "round square");
  EXPECT_EQ(texts({"draw", "--shape=r"}), "round square");
  EXPECT_EQ(texts({"draw", "--shape", "=", "r"}), "round square") << "as bash takes it apart";
  EXPECT_EQ(texts({"list", ""}), "shapes files");
  EXPECT_EQ(texts({"list", "shapes", ""}), "");
  EXPECT_EQ(texts({"lits", ""}), "draw copy list") << "as long as the command is not known";
}

TEST_F(CommandLine, FilesAreOfferedOnlyWhereTheyAreAllowed) {
  using Places = Offer::Places;
  EXPECT_EQ(offer({"draw", ""}).places, Places::files);
  EXPECT_EQ(offer({"draw", "--fill", "-s", "3", "--shape=round", ""}).places, Places::files);
  EXPECT_EQ(offer({"draw", "-s", ""}).places, Places::none);
  EXPECT_EQ(offer({"draw", "--shape", ""}).places, Places::none);
  EXPECT_EQ(offer({"copy", "x", ""}).places, Places::folders);
  EXPECT_EQ(offer({"copy", "x", "y", "z", ""}).places, Places::folders) << "as many as one likes";
  EXPECT_EQ(offer({"copy", "--", "-x", ""}).places, Places::folders);
  EXPECT_EQ(offer({""}).places, Places::none);
}

/// Output of a shell command.
std::string told_by(const std::string& command) {
  std::string told;
  std::FILE* const shell = ::popen(command.c_str(), "r");
  std::array<char, 256> part{};
  while (std::fgets(part.data(), part.size(), shell) != nullptr) told += part.data();
  const int status = ::pclose(shell);
  return status == 0 ? told : told + "failed\n";
}

TEST_F(CommandLine, BashFiltersTheOfferedWords) {
  const auto offered = [this](const std::vector<std::string>& words) {
    const std::string script_file = ::testing::TempDir() + "luxrig-completion-" + std::to_string(::getpid());
    std::ofstream script(script_file);
    script << completion_script("tool", Shell::bash)
           << "tool() { [[ $1 == --complete ]] && shift && printf '%s|' \"$@\" >" << script_file
           << ".asked; cat <<'END'\n"
           << offer_text(offer(words)) << "END\n}\nCOMP_WORDS=(tool";
    std::string asked;
    for (const std::string& word : words) {
      script << " '" << word << "'";
      asked += word + "|";
    }
    script << ")\nCOMP_CWORD=" << words.size() << "\n_tool\necho \"${COMPREPLY[*]}\"\n";
    script.close();
    std::string told = told_by("bash " + script_file);
    EXPECT_EQ(told_by("cat " + script_file + ".asked"), asked);
    for (const char* ending : {"", ".asked"}) std::filesystem::remove(script_file + ending);
    return told;
  };
  EXPECT_EQ(offered({"d"}), "draw\n");
  EXPECT_EQ(offered({"draw", "--s"}), "--shape --size\n");
  EXPECT_EQ(offered({"draw", "x", "--shape", ""}), "round square\n");
  EXPECT_EQ(offered({"draw", "x", "--shape", "s"}), "square\n");
  EXPECT_EQ(offered({"draw", ""}), "\n") << "bash offers files by itself";
}

TEST_F(CommandLine, EveryShellAcceptsItsScript) {
  for (const auto& [name, shell] : shells()) {
    const std::string script_file =
        ::testing::TempDir() + "luxrig-completion-" + std::to_string(::getpid()) + "." + name;
    std::ofstream(script_file) << completion_script("tool", shell);
    const std::string check = "command -v " + name + " >/dev/null || exit 0; " + name + " -n " + script_file + " 2>&1";
    EXPECT_EQ(told_by(check), "") << name;
    std::ofstream(script_file) << completion_script("tool", shell) << "\n'";
    if (told_by("command -v " + name) != "failed\n") {
      EXPECT_NE(told_by(check), "") << name << " sees what is wrong";
    }
    std::filesystem::remove(script_file);
  }
}

}  // namespace
}  // namespace luxrig
