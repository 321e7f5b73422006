// Command-line input: mistyped words are refused with a suggestion, help is in words, and `init` makes a rig that runs.
#include "sim/faults/faults.h"
#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

void refuses(const std::vector<std::string>& words, const std::string& with) {
  std::vector<std::string> all = words;
  all[0] = program(words[0]);
  const Ran ran = luxrig::testing::run(all);
  EXPECT_EQ(ran.code, 2) << ran.output;
  EXPECT_NE(ran.output.find(with), std::string::npos) << ran.output;
}

TEST(Words, AMistypedNameIsRefusedWithTheNearestOne) {
  refuses({"luxrig", "rnu"}, "luxrig: there is no command \"rnu\": did you mean \"run\"?");
  refuses({"luxrig", "render", "x", "-o", "y.png", "--false-color", "lux"},
          "luxrig render: there is no option \"--false-color\": did you mean \"--false-colour\"?");
  refuses({"luxrig", "evaluate", "x", "--model", "pth"}, "--model: there is no \"pth\": did you mean \"path\"?");
  for (const char* command : {"evaluate", "solve"})
    refuses({"luxrig", command, "x", "--model", "cache"},
            "--model: \"cache\" is refused, as its error bars were too short to be believed: use gather or path");
  refuses({"luxrig", "rdm", "lst"}, "luxrig rdm: there is no command \"lst\": did you mean \"list\"?");
  refuses({"luxrig", "blackout", "offf"}, "there is no \"offf\": did you mean \"off\"?");
  refuses({"luxrig", "bench", "transprot"}, "did you mean \"transport\"?");
  refuses({"luxrig", "check", "one", "two"}, "luxrig check: \"two\" is too much");
  refuses({"luxrig", "check"}, "luxrig check: RIG is required");
  refuses({"luxrig"}, "say which command");
  refuses({"luxrigd", "rig", "--sed", "3"}, "did you mean \"--seed\"?");
  refuses({"luxrig-sim", "rig", "--sed", "3"}, "did you mean \"--seed\"?");
}

TEST(Words, BlackoutAcceptsOnAndOff) {
  for (const char* state : {"on", "off"}) {
    const Ran ran = luxrig::testing::run({program("luxrig"), "blackout", state, "--port", "1"});
    EXPECT_EQ(ran.code, 1) << "understood, and nobody answers: " << ran.output;
    EXPECT_NE(ran.output.find("no daemon answers"), std::string::npos) << ran.output;
  }
}

TEST(Words, HelpListsWordsAndDefaults) {
  const Ran ran = luxrig::testing::run({program("luxrig"), "evaluate", "--help"});
  EXPECT_EQ(ran.code, 0) << ran.output;
  std::string flat;
  for (const char c : ran.output)
    if (c != '\n' && (c != ' ' || flat.empty() || flat.back() != ' ')) flat += c == '\n' ? ' ' : c;
  EXPECT_NE(flat.find("auto, direct, gather or path; default auto"), std::string::npos) << ran.output;
  EXPECT_NE(flat.find("0 to 1024; default 0"), std::string::npos) << ran.output;
  EXPECT_EQ(ran.output.find("->"), std::string::npos) << ran.output;
}

TEST(Words, HelpGroupsEveryCommand) {
  const Ran ran = luxrig::testing::run({program("luxrig"), "--help"});
  for (const char* text : {"Set a rig:", "Run a show:", "Devices:", "Measure:", "  init ", "  blackout "})
    EXPECT_NE(ran.output.find(text), std::string::npos) << text << ran.output;
  EXPECT_EQ(ran.output.find("Subcommands:"), std::string::npos) << "a command without a group: " << ran.output;
}

TEST(Words, TheSimulatorsHelpAndReadmeListEveryFault) {
  const Ran ran = luxrig::testing::run({program("luxrig-sim"), "--help"});
  const std::string readme = text_of(source("tools/luxrig-sim/README.md"));
  EXPECT_EQ(sim::all_faults().size(), 22u);
  for (const sim::FaultKind kind : sim::all_faults()) {
    const std::string name(sim::name_of(kind));
    EXPECT_NE(ran.output.find("  " + name + " "), std::string::npos) << name;
    EXPECT_NE(readme.find("| `" + name + "` |"), std::string::npos) << name;
  }
}

TEST(Words, InitMakesARigThatPassesCheckSolveAndRun) {
  const Folder folder;
  const std::string rig = (folder / "my \"gallery\"").string();
  const Ran init = luxrig::testing::run({program("luxrig"), "init", rig});
  ASSERT_EQ(init.code, 0) << init.output;
  EXPECT_EQ(luxrig::testing::run({program("luxrig"), "init", rig}).code, 2) << "there is one already";
  const Ran check = luxrig::testing::run({program("luxrig"), "check", rig});
  EXPECT_EQ(check.code, 0) << check.output;
  EXPECT_NE(check.output.find("my \"gallery\": no problems found"), std::string::npos) << check.output;
  const Ran solve = luxrig::testing::run({program("luxrig"), "solve", rig});
  EXPECT_EQ(solve.code, 0) << solve.output;
  EXPECT_NE(solve.output.find("all 2 goals met"), std::string::npos) << solve.output;
  const Ran run = luxrig::testing::run({program("luxrig"), "run", rig, "--sim", "--once", "--port", "0"}, 120s);
  EXPECT_EQ(run.code, 0) << run.output;
  EXPECT_NE(run.output.find("faults and truth: http://127.0.0.1:"), std::string::npos) << run.output;
}

TEST(Words, AShippedRigIsFoundByItsName) {
  const Ran ran = luxrig::testing::run({program("luxrig"), "check", "start"});
  EXPECT_EQ(ran.code, 0) << ran.output;
}

TEST(Words, TheSimulatorsControlPortStatesRemediesAndNeedsNoBody) {
  LiveRig rig(source("tests/rigs/room"));
  const int port = json::parse(text_of(rig.file("ports.json")))["control"]["port"].get<int>();
  // As `curl -X POST` sends it: no body and no content length.
  const auto ask = [&](const std::string& request, const std::string& body) {
    const std::string length = body.empty() ? "" : "Content-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
    const std::string whole = request + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + length + "\r\n" + body;
    return luxrig::testing::run({"/bin/bash", "-c",
                                 "exec 3<>/dev/tcp/127.0.0.1/$1; printf %s \"$2\" >&3; timeout 3 cat <&3", "ask",
                                 std::to_string(port), whole});
  };
  const auto says = [](const Ran& ran, const std::string& text) {
    EXPECT_NE(ran.output.find(text), std::string::npos) << ran.output;
  };
  const Ran none = ask("POST /clear_faults", "");
  EXPECT_EQ(none.code, 0) << "answered within 3 s: " << none.output;
  says(none, R"({"ok":true})");
  says(ask("POST /fault", ""), "send {");
  says(ask("POST /clear_fault", ""), R"(did you mean \"/clear_faults\"?)");
  says(ask("GET /truht", ""), R"(did you mean \"/truth\"?)");
  says(ask("POST /fault", R"({"devise":"field","fault":"silent","on":true})"),
       R"(unknown key \"devise\": did you mean \"device\"?)");
  says(ask("POST /fault", R"({"device":"field","fault":"silnt","on":true})"), "did you mean 'silent'?");
  says(ask("POST /fault", R"({"device":"field","fault":"slow","on":true,"value":10})"), R"({"ok":true})");
}

}  // namespace
}  // namespace luxrig::testing
