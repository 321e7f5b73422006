// luxrig calibrate, over the wire: what it measures of a simulated rig, and what it leaves behind.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <regex>

#include "core/geometry.h"
#include "tests/tools/programs/live_rig.h"

namespace luxrig::testing {
namespace {

std::vector<std::string> calibrate(const std::string& rig, int port) {
  return {program("luxrig"), "calibrate", rig, "--port", std::to_string(port), "--max-error", "0.02"};
}

double squared(double x) { return x * x; }

TEST(CalibrateOverTheWire, TheNextRunLightsByWhatWasMeasuredAndAStopLeavesNothing) {
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
  const std::string path = (folder / "room").string();
  const auto found = folder / "room" / "calibration.json";
  LiveRig rig(path);
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  ASSERT_EQ(run({program("luxrig"), "level", "spot-1", "0.3", "--port", std::to_string(rig.port())}).code, 0);
  const auto as_before = [](const json& s) {
    return s["overrides"].size() == 1 && s["overrides"][0]["name"] == "spot-1" && s["overrides"][0]["level"] == 0.3;
  };
  ASSERT_TRUE(rig.wait_status(as_before, 10s));
  std::vector<std::string> with_sim = calibrate(path, rig.port());
  with_sim.emplace_back("--sim");
  const Ran in_the_way = run(with_sim);
  EXPECT_EQ(in_the_way.code, 1) << in_the_way.output;
  EXPECT_NE(in_the_way.output.find("a daemon runs on port"), std::string::npos) << in_the_way.output;
  {
    Process stopped(calibrate(path, rig.port()), folder / "stopped.log");
    ASSERT_TRUE(rig.wait_status([](const json& s) { return s["overrides"].size() == 3; }, 60s)) << stopped.output();
    const Ran second = run(calibrate(path, rig.port()));
    EXPECT_NE(second.code, 0);
    EXPECT_NE(second.output.find("another luxrig calibrate measures this rig"), std::string::npos) << second.output;
    stopped.signal(SIGTERM);
    EXPECT_EQ(stopped.wait(30s), 1) << stopped.output();
    EXPECT_TRUE(rig.wait_status(as_before, 10s)) << rig.last();
    EXPECT_FALSE(std::filesystem::exists(found));
  }
  const Ran measured = run(calibrate(path, rig.port()));
  ASSERT_EQ(measured.code, 0) << measured.output;
  EXPECT_TRUE(rig.wait_status(as_before, 10s)) << rig.last();
  const json calibration = json::parse(text_of(found), nullptr, false);
  ASSERT_TRUE(calibration.is_object());
  // Each lamp's own light against the truth, in standard errors: the whole rig's at least.
  const json truth = rig.truth();
  double chi_squared = 0;
  for (const json& lamp : truth["fixtures"]) {
    const json& output = calibration["fixtures"][lamp["name"].get<std::string>()]["output"];
    chi_squared += squared((output[0].get<double>() - lamp["output"].get<double>()) / output[1].get<double>());
    EXPECT_LT(output[1].get<double>(), 0.2) << lamp["name"];
  }
  EXPECT_LT(chi_squared, 3 * squared(3.5));

  const json report = json::parse(text_of(folder / "room" / "calibration-report.json"), nullptr, false);
  ASSERT_TRUE(report.is_object());
  EXPECT_EQ(report["made"], calibration["made"]);
  EXPECT_FALSE(report["goals"].empty());
  EXPECT_GE(report["readings"].size(), 3u);
  EXPECT_NE(text_of(folder / "room" / "calibration-report.html").find("</html>"), std::string::npos);

  const Ran again = run(calibrate(path, rig.port()));
  EXPECT_NE(again.code, 0) << "the daemon dims by the rig file, and the file beside it is another";
  EXPECT_NE(again.output.find("restart the daemon"), std::string::npos) << again.output;

  rig.daemon().signal(SIGTERM);
  rig.daemon().wait(30s);
  rig.start_daemon();
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  EXPECT_EQ(rig.last()["calibrated"], calibration["made"]);
  EXPECT_NE(rig.daemon().output().find("as calibrated"), std::string::npos) << rig.daemon().output();

  // It says nothing of another rig, least of all of the real one.
  EXPECT_EQ(calibration["simulated"], "mild, seed 3");
  const Ran real = run({program("luxrig"), "run", path, "--port", "0"});
  EXPECT_EQ(real.code, 2) << real.output;
  EXPECT_NE(real.output.find("was measured on a simulated rig (mild, seed 3), this is the real one"), std::string::npos)
      << real.output;
  const Ran other = run({program("luxrig"), "run", path, "--sim", "--port", "0", "--max-error", "0.1"});
  EXPECT_EQ(other.code, 2) << other.output;
  EXPECT_NE(other.output.find("this is another (mild, seed 1)"), std::string::npos) << other.output;
  const Ran evaluated = run({program("luxrig"), "evaluate", path, "--max-error", "0.1"});
  EXPECT_EQ(evaluated.code, 0) << evaluated.output;
  EXPECT_NE(evaluated.output.find("of a simulated rig (mild, seed 3), not of the real one"), std::string::npos)
      << evaluated.output;
}

TEST(CalibrateOverTheWire, OfASimulatedRigItBringsRigAndDaemonWithIt) {
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
  const std::string path = (folder / "room").string();
  // Below those that the kernel gives to others.
  const int port = 21000 + ::getpid() % 9000;
  std::vector<std::string> words = calibrate(path, port);
  for (const char* word : {"--sim", "--sim-seed", "5", "--meters", "--hand", "--sim-hand", "2"})
    words.emplace_back(word);
  const Ran measured = run(words, 180s);
  ASSERT_EQ(measured.code, 0) << measured.output;
  EXPECT_NE(measured.output.find("--sim --sim-deviations mild --sim-seed 5"), std::string::npos) << measured.output;
  const json calibration = json::parse(text_of(folder / "room" / "calibration.json"), nullptr, false);
  ASSERT_TRUE(calibration.is_object());
  EXPECT_EQ(calibration["simulated"], "mild, seed 5");
  // The simulated hand went where it was told to, and after each place the light was known better.
  const std::regex place("Hold the luxmeter at \"[^\"]*\"[^$]*?is known to ([0-9.]+) %");
  int places = 0;
  double before = 100;
  for (auto at = std::sregex_iterator(measured.output.begin(), measured.output.end(), place);
       at != std::sregex_iterator(); ++at, ++places) {
    const double known = std::stod((*at)[1].str());
    EXPECT_LE(known, before);
    before = known;
  }
  EXPECT_TRUE(places == 1 || places == 2) << measured.output;
  const auto daemon = daemon_on(port);
  EXPECT_FALSE(daemon && http_get(*daemon, "/api/status")) << "the daemon ends with it";
}

/// The room with a wide camera that sees enough of it, and two boxes more on its walls.
void give_eyes(const std::filesystem::path& rig_file) {
  std::string text = text_of(rig_file);
  const auto replace = [&](const std::string& what, const std::string& by) {
    const auto at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), by);
  };
  replace("position_m = [1.7, -1.7, 1.6]\naim = \"plinth-top\"",
          "position_m = [2.0, -2.2, 1.7]\naim_m = [-0.6, 1.2, 1.0]");
  replace("fov_deg = 60\nwidth_px = 96\nheight_px = 64", "fov_deg = 70\nwidth_px = 320\nheight_px = 200");
  replace("[[luminaire]]",
          "[[scene.object]]\nname = \"picture\"\nbox_m = [1.2, 0.05, 0.8]\nposition_m = [-1.2, 2.45, 1.2]\nreflectance "
          "= 0.3\n\n"
          "[[scene.object]]\nname = \"chest\"\nbox_m = [0.6, 0.9, 0.7]\nposition_m = [-2.2, 0.4, 0.0]\nreflectance = "
          "0.25\n\n"
          "[[luminaire]]");
  std::ofstream(rig_file) << text;
}

TEST(CalibrateOverTheWire, ByACameraThatHangsAskewItFindsTheCameraAndEachLamp) {
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
  give_eyes(folder / "room" / "rig.toml");
  const std::string path = (folder / "room").string();
  LiveRig rig(path, {},
              {"--deviations",
               "mild,camera_angle_rad=0.017,camera_position_m=0.03,camera_vignetting=0.3,camera_flare=0.02,"
               "camera_log_response=0.4"});
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  std::vector<std::string> words = calibrate(path, rig.port());
  for (const char* word : {"--camera", "dor"}) words.emplace_back(word);
  const Ran unknown = run(words);
  EXPECT_NE(unknown.code, 0);
  EXPECT_NE(unknown.output.find("did you mean \"door\"?"), std::string::npos) << unknown.output;

  words.back() = "door";
  words.emplace_back("--meters");
  words.emplace_back("--no-heads");  // the head takes four minutes of pictures: its own test below, at night
  const Ran measured = run(words, 280s);
  ASSERT_EQ(measured.code, 0) << measured.output;
  std::smatch off_px;
  ASSERT_TRUE(std::regex_search(measured.output, off_px,
                                std::regex("([0-9.]+) px off where the rig file has it; where it is now found to be, "
                                           "([0-9.]+) px")))
      << measured.output;
  EXPECT_GT(std::stod(off_px[1]), 1);
  EXPECT_LE(std::stod(off_px[2]), 0.5);
  EXPECT_NE(measured.output.find("What is left of its variance: "), std::string::npos) << measured.output;
  const json calibration = json::parse(text_of(folder / "room" / "calibration.json"), nullptr, false);
  ASSERT_TRUE(calibration.is_object());
  double chi_squared = 0;
  const json truth = rig.truth();
  for (const json& lamp : truth["fixtures"]) {
    const json& output = calibration["fixtures"][lamp["name"].get<std::string>()]["output"];
    chi_squared += squared((output[0].get<double>() - lamp["output"].get<double>()) / output[1].get<double>());
    EXPECT_LT(output[1].get<double>(), 0.1) << lamp["name"];
  }
  EXPECT_LT(chi_squared, 3 * squared(3.5)) << measured.output;

  const json& camera = calibration["cameras"]["door"];
  ASSERT_TRUE(camera.is_object()) << calibration["cameras"];
  for (const char* key : {"fov_deg", "distortion", "lens_a", "lens_b", "lens_c", "flare", "halo"})
    EXPECT_GT(camera[key][1].get<double>(), 0) << key;
  EXPECT_GT(std::abs(camera["turn_deg"][0].get<double>()) + std::abs(camera["turn_deg"][1].get<double>()) +
                std::abs(camera["turn_deg"][2].get<double>()),
            0.1);
  EXPECT_FALSE(camera["response"].empty());

  const json report = json::parse(text_of(folder / "room" / "calibration-report.json"), nullptr, false);
  ASSERT_TRUE(report.is_object());
  double shares = 0;
  for (const json& share : report["share_of_variance"]) shares += share.get<double>();
  EXPECT_NEAR(shares, 1, 1e-6);
  EXPECT_GT(report["cameras"][0]["places"], 50);
  EXPECT_EQ(report["maps"][0]["light"], "the look in force");
  ASSERT_GT(report["maps"][0]["places"].size(), 20u);
  for (const json& place : report["maps"][0]["places"]) EXPECT_GT(place["standard_error_lx"].get<double>(), 0) << place;
  EXPECT_NE(text_of(folder / "room" / "calibration-report.html").find("data:image/png;base64,"), std::string::npos);
  for (const char* picture : {"calibration-lux.png", "calibration-lux-error.png"})
    EXPECT_EQ(text_of(folder / "room" / picture).substr(1, 3), "PNG") << picture;
}

/// The same room without a limit, its head with a narrow beam.
void give_a_narrow_head(const std::filesystem::path& rig_file) {
  give_eyes(rig_file);
  std::string text = text_of(rig_file);
  const auto replace = [&](const std::string& what, const std::string& by) {
    const auto at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    text.replace(at, what.size(), by);
  };
  replace("max_lx = 200\n", "");
  replace("name = \"head-1\"\nluminaire = \"narrow\"", "name = \"head-1\"\nluminaire = \"beam\"");
  replace("[[bus]]",
          "[[luminaire]]\nname = \"beam\"\nmodel = \"spot\"\nbeam_angle_deg = 10\nfield_angle_deg = 16\nlumens = "
          "900\n\n[[bus]]");
  std::ofstream(rig_file) << text;
}

Vec3 vector_of(const json& list) { return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()}; }

/// Between where the head truly shines and where it shall [rad].
double aim_error_rad(const json& truth, const std::string& name, const Vec3& aim_m) {
  for (const json& lamp : truth["fixtures"]) {
    if (lamp["name"] != name) continue;
    const Vec3 along = vector_of(lamp["beam_along"]);
    const Vec3 wanted = (aim_m - vector_of(lamp["beam_from"])).normalized();
    return std::atan2(along.cross(wanted).norm(), along.dot(wanted));
  }
  return NAN;
}

// Four minutes, most of them pictures: tools/nightly sets LUXRIG_LONG.
TEST(CalibrateOverTheWire, ByACameraAHeadThatHangsAskewLooksWhereItShall) {
  if (std::getenv("LUXRIG_LONG") == nullptr) GTEST_SKIP() << "tools/nightly heads";
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
  give_a_narrow_head(folder / "room" / "rig.toml");
  const std::string path = (folder / "room").string();
  LiveRig rig(path, {},
              {"--deviations",
               "mild,camera_angle_rad=0.01,camera_position_m=0.02,angle_error_rad=0.04,position_error_m=0.04,"
               "backlash_rad=0.02"});
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  const Vec3 floor_m(1.5, -1.0, 0.0);
  EXPECT_GT(aim_error_rad(rig.truth(), "head-1", floor_m), 0.017);
  std::vector<std::string> words = calibrate(path, rig.port());
  for (const char* word : {"--camera", "door", "--meters"}) words.emplace_back(word);
  const Ran measured = run(words, 280s);
  ASSERT_EQ(measured.code, 0) << measured.output;
  EXPECT_NE(measured.output.find("Head \"head-1\" is found"), std::string::npos) << measured.output;
  const json calibration = json::parse(text_of(folder / "room" / "calibration.json"), nullptr, false);
  ASSERT_TRUE(calibration.is_object());
  const json& head = calibration["fixtures"]["head-1"]["head"];
  ASSERT_TRUE(head.is_object()) << measured.output;
  EXPECT_TRUE(rig.wait_status([](const json& s) { return s["overrides"].empty(); }, 10s)) << "the look is back";
  rig.daemon().signal(SIGTERM);
  rig.daemon().wait(30s);
  rig.start_daemon();
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  EXPECT_LT(aim_error_rad(rig.truth(), "head-1", floor_m), 0.0052) << "0.3°";
}

/// A person who reads the true light wherever the program asks to hold the meter.
class Person {
 public:
  explicit Person(const std::filesystem::path& pipe) {
    EXPECT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    typed_ = ::open(pipe.c_str(), O_RDWR | O_CLOEXEC);  // opens without a reader too
  }
  ~Person() { ::close(typed_); }
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;

  void type(const std::string& line) const {
    const std::string text = line + "\n";
    EXPECT_EQ(::write(typed_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// Answers every question so far that has no answer yet.
  void answer(const std::string& output, const json& truth) {
    static const std::regex asked("Hold the luxmeter at \"([^\"]+)\"|  [0-9]+ of [0-9]+, [^:\n]*: ");
    int questions = 0;
    for (std::sregex_iterator it(output.begin(), output.end(), asked), end; it != end; ++it) {
      if ((*it)[1].matched) {
        place_ = (*it)[1];
        continue;
      }
      if (++questions <= answered_) continue;
      for (const json& point : truth["points"])
        if (point["name"] == place_) type(std::to_string(point["lux"].get<double>()));
      ++answered_;
    }
  }

 private:
  int typed_ = -1, answered_ = 0;
  std::string place_;
};

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(CalibrateOverTheWire, ByHandItSaysWhereToHoldTheMeterAndHowWellItKnowsTheLightThen) {
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
  const std::string path = (folder / "room").string();
  LiveRig rig(path);
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  Person person(folder / "typed");
  std::vector<std::string> words = {"/bin/sh", "-c", "exec \"$0\" \"$@\" < " + (folder / "typed").string()};
  for (const std::string& word : calibrate(path, rig.port())) words.push_back(word);
  words.emplace_back("--hand");
  Process asking(words, folder / "asking.log");
  const auto known = [&] { return count_of(asking.output(), "Now the light at"); };
  ASSERT_TRUE(wait_for(
      [&] {
        person.answer(asking.output(), rig.truth());
        return known() >= 1 || asking.output().find("no further place") != std::string::npos;
      },
      180s))
      << asking.output();
  EXPECT_GE(known(), 1) << asking.output();
  person.type("q");
  ASSERT_EQ(asking.wait(60s), 0) << asking.output();
  const json calibration = json::parse(text_of(folder / "room" / "calibration.json"), nullptr, false);
  ASSERT_TRUE(calibration.is_object()) << asking.output();
  const json truth = rig.truth();
  double chi_squared = 0;
  int found = 0;
  for (const json& lamp : truth["fixtures"]) {
    const json& output = calibration["fixtures"][lamp["name"].get<std::string>()]["output"];
    if (!(output[1].get<double>() > 0)) continue;  // no reading told of it
    EXPECT_LT(output[1].get<double>(), 0.2) << lamp["name"];
    chi_squared += squared((output[0].get<double>() - lamp["output"].get<double>()) / output[1].get<double>());
    ++found;
  }
  EXPECT_LT(chi_squared, 3 * squared(3.5)) << asking.output();
  EXPECT_GE(found, 1) << asking.output();
}

/// A person who answers on the daemon's page: what its browser gets and sends.
class PersonAtThePage {
 public:
  explicit PersonAtThePage(LiveRig& rig) : rig_(rig) {}

  /// The question that is asked now; null if there is none, or it has its answer.
  json question() {
    const json status = rig_.status();
    if (!status.is_object() || !status.contains("question") || status["question"].contains("answer")) return {};
    return status["question"];
  }
  /// Status of the daemon's answer.
  int answer(json body) {
    const auto daemon = daemon_on(rig_.port());
    const auto said = daemon ? http_post_json(*daemon, "/api/answer", body.dump()) : std::nullopt;
    return said ? said->status : 0;
  }
  /// Answers what is asked, if something is, by the true light there.
  void read_meter() {
    const json asked = question();
    if (!asked.is_object()) return;
    const json truth = rig_.truth();
    for (const json& point : truth["points"]) {
      if (asked["text"].get<std::string>().find('"' + point["name"].get<std::string>() + '"') == std::string::npos)
        continue;
      EXPECT_EQ(answer({{"id", asked["id"]}, {"what", "reading"}, {"lux", point["lux"]}}), 200) << asked;
      told_ += asked.contains("fixture") ? 1 : 0;
    }
  }
  /// Readings under a lamp.
  [[nodiscard]] int told() const { return told_; }

 private:
  LiveRig& rig_;
  int told_ = 0;
};

TEST(CalibrateOverTheWire, ByHandThePageAsksTooAndTheFirstAnswerCounts) {
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
  const std::string path = (folder / "room").string();
  LiveRig rig(path);
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  const Person terminal(folder / "typed");
  std::vector<std::string> words = {"/bin/sh", "-c", "exec \"$0\" \"$@\" < " + (folder / "typed").string()};
  for (const std::string& word : calibrate(path, rig.port())) words.push_back(word);
  words.emplace_back("--hand");
  Process asking(words, folder / "asking.log");
  PersonAtThePage page(rig);
  json first;
  ASSERT_TRUE(wait_for([&] { return (first = page.question()).is_object(); }, 120s)) << asking.output();
  EXPECT_FALSE(first.contains("fixture")) << "the dark first";
  EXPECT_EQ(first["readings"], 0);
  EXPECT_GT(first["known_to"], 0);
  EXPECT_EQ(first["position"].size(), 3U);

  // An answer at the terminal ends the question on the page.
  const json asked_first = {{"id", first["id"]}, {"what", "reading"}, {"lux", 1}};
  terminal.type("s");
  json second;
  ASSERT_TRUE(wait_for(
      [&] {
        second = page.question();
        return second.is_object() && second["id"] != first["id"];
      },
      60s))
      << asking.output();
  EXPECT_EQ(page.answer(asked_first), 409);
  // "Another place" on the page: from there on all readings come from the page.
  EXPECT_EQ(page.answer({{"id", second["id"]}, {"what", "other_place"}}), 200);
  ASSERT_TRUE(wait_for(
      [&] {
        page.read_meter();
        return asking.output().find("Now the light at") != std::string::npos;
      },
      180s))
      << asking.output();
  EXPECT_NE(asking.output().find("another place, from the page"), std::string::npos) << asking.output();
  EXPECT_NE(asking.output().find(" lx, from the page"), std::string::npos) << asking.output();
  EXPECT_GE(page.told(), 1);
  ASSERT_TRUE(wait_for(
      [&] {
        const json asked = page.question();
        if (asked.is_object()) return page.answer({{"id", asked["id"]}, {"what", "end"}}) == 200;
        return asking.output().find("no further place") != std::string::npos;
      },
      60s))
      << asking.output();
  ASSERT_EQ(asking.wait(60s), 0) << asking.output();
  EXPECT_FALSE(rig.status().contains("question")) << "it takes its question with it";
  const json calibration = json::parse(text_of(folder / "room" / "calibration.json"), nullptr, false);
  ASSERT_TRUE(calibration.is_object()) << asking.output();
  const json truth = rig.truth();
  int found = 0;
  double chi_squared = 0;
  for (const json& lamp : truth["fixtures"]) {
    const json& output = calibration["fixtures"][lamp["name"].get<std::string>()]["output"];
    if (!(output[1].get<double>() > 0)) continue;  // no reading told of it
    chi_squared += squared((output[0].get<double>() - lamp["output"].get<double>()) / output[1].get<double>());
    ++found;
  }
  EXPECT_GE(found, 1) << asking.output();
  EXPECT_LT(chi_squared, 3 * squared(3.5)) << asking.output();
}

TEST(CalibrateOverTheWire, AQuestionOfAKilledClientIsGoneByItself) {
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
  const std::string path = (folder / "room").string();
  LiveRig rig(path);
  ASSERT_TRUE(rig.wait_phase("holding", 90s)) << rig.daemon().output();
  const Person terminal(folder / "typed");
  std::vector<std::string> words = {"/bin/sh", "-c", "exec \"$0\" \"$@\" < " + (folder / "typed").string()};
  for (const std::string& word : calibrate(path, rig.port())) words.push_back(word);
  words.emplace_back("--hand");
  Process asking(words, folder / "asking.log");
  PersonAtThePage page(rig);
  ASSERT_TRUE(wait_for([&] { return page.question().is_object(); }, 120s)) << asking.output();
  asking.signal(SIGKILL);
  EXPECT_TRUE(rig.wait_status([](const json& s) { return !s.contains("question"); }, 60s));
  EXPECT_TRUE(rig.wait_status([](const json& s) { return s["overrides"].empty(); }, 60s)) << "the look is back";
}

TEST(Calibrate, IsRefusedWithoutADaemonOrLuxmeters) {
  const Ran alone = run(calibrate(source("tests/rigs/room"), 1));
  EXPECT_EQ(alone.code, 1) << alone.output;
  EXPECT_NE(alone.output.find("luxrig"), std::string::npos) << alone.output;
  EXPECT_EQ(run(calibrate(source("no/such/rig"), 1)).code, 2);
}

TEST(Calibrate, AWrongFileBesideTheRigIsSaidWithItsPlace) {
  const Folder folder;
  std::filesystem::copy(source("tests/rigs/room"), folder / "room", std::filesystem::copy_options::recursive);
  std::ofstream(folder / "room" / "calibration.json")
      << "{\"luxrig_calibration\": 1, \"rig\": \"room\", \"made\": \"today\",\n \"fixtures\": {\"gone\": {\"output\": "
         "[1, 0]}}}\n";
  const Ran refused = run({program("luxrig"), "evaluate", (folder / "room").string()});
  EXPECT_EQ(refused.code, 2) << refused.output;
  EXPECT_NE(refused.output.find("calibration.json"), std::string::npos) << refused.output;
  EXPECT_NE(refused.output.find("the rig has no fixture \"gone\""), std::string::npos) << refused.output;
}

}  // namespace
}  // namespace luxrig::testing
