#include "core/rig/rig_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <random>
#include <string>

#include "core/rig/null_bus.h"
#include "tests/core/rig/listed_problems.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::filesystem::path kRooms = test::source_folder() / "tests/rigs/room";

using test::listed;

TEST(RigFile, ReadsARoomAsWritten) {
  const Checked<Rig> rig = load_rig(kRooms);
  ASSERT_TRUE(rig) << listed(rig.error());
  EXPECT_EQ(rig->name, "room");
  EXPECT_EQ(rig->scene.mesh->path, kRooms / "room.obj");
  EXPECT_EQ(rig->scene.mesh->up_axis, UpAxis::z);
  ASSERT_EQ(rig->scene.reflectances.size(), 1u);
  EXPECT_EQ(rig->scene.reflectances[0].material_pattern, "wall*");
  ASSERT_EQ(rig->scene.objects.size(), 1u);
  EXPECT_EQ(rig->scene.objects[0].box_m, Vec3(0.4, 0.4, 1.0));
  EXPECT_NEAR(rig->scene.objects[0].turn_rad, kPi / 6, 1e-12);
  ASSERT_EQ(rig->luminaires.size(), 2u);
  EXPECT_EQ(rig->luminaires[0].model, LuminaireModel::spot);
  EXPECT_NEAR(rig->luminaires[0].intensity->flux_lm(), 900, 0.9);
  EXPECT_NEAR(rig->luminaires[1].intensity->flux_lm(), 800, 1e-9);
  ASSERT_EQ(rig->buses.size(), 2u);
  EXPECT_EQ(std::get<std::string>(rig->buses[1].options.at("host").value), "127.0.0.1");
  EXPECT_EQ(std::get<std::int64_t>(rig->buses[1].options.at("port").value), 1502);
  ASSERT_EQ(rig->fixtures.size(), 3u);
  const Fixture& head = rig->fixtures[1];
  EXPECT_TRUE(head.moves);
  const auto& patch = std::get<DmxPatch>(head.patch);
  EXPECT_EQ(patch.address, 10);
  ASSERT_EQ(patch.slots.size(), 7u);
  EXPECT_EQ(patch.slots[1].use, SlotUse::pan_fine);
  EXPECT_EQ(patch.slots[6].constant_dmx, 255);
  EXPECT_EQ(std::get<ModbusPatch>(rig->fixtures[2].patch).unit, 10);
  EXPECT_EQ(rig->fixtures[0].dimmer_curve, DimmerCurve::square);
  EXPECT_EQ(rig->fixtures[2].safe_level, 0.2);
  ASSERT_EQ(rig->luxmeters.size(), 2u);
  EXPECT_EQ(rig->luxmeters[0].point, 0u);
  EXPECT_EQ(rig->luxmeters[0].position_world_m, Vec3(1, 0.5, 1));
  EXPECT_FALSE(rig->luxmeters[1].point);
  ASSERT_EQ(rig->points.size(), 2u);
  EXPECT_EQ(rig->points[0].max_lx, 200);
  EXPECT_EQ(rig->points[1].weight, 0.5);
  EXPECT_EQ(rig->control.fade_s, 2);
  EXPECT_EQ(rig->safe.hold_s, 2);
}

TEST(RigFile, AimsFixturesAtTheirPoints) {
  const Checked<Rig> rig = load_rig(kRooms / "rig.toml");
  ASSERT_TRUE(rig) << listed(rig.error());
  for (const std::size_t i : {0u, 1u}) {
    const Fixture& fixture = rig->fixtures[i];
    const Vec3 wanted = (*fixture.aim_world_m - fixture.world_from_mount.translation_m).normalized();
    EXPECT_LT((fixture.world_from_lamp().direction(-Vec3::UnitZ()) - wanted).norm(), 1e-9);
  }
}

/// parse_rig in a folder without files.
Checked<Rig> parse(const std::string& text) { return parse_rig(text, "rig.toml", "/nonexistent"); }

const std::string kSmall = R"([rig]
name = "small"
[[luminaire]]
name = "bulb"
model = "isotropic"
lumens = 800
[[bus]]
name = "dmx"
driver = "sacn"
)";

std::string fixture(const std::string& name, const std::string& keys) {
  return "[[fixture]]\nname = \"" + name + "\"\nluminaire = \"bulb\"\nposition_m = [0, 0, 3]\nbus = \"dmx\"\n" + keys +
         "\n";
}

TEST(RigFile, AcceptsARigWithOnlyAName) {
  const Checked<Rig> rig = parse("[rig]\nname = \"empty\"\n");
  ASSERT_TRUE(rig) << listed(rig.error());
  ASSERT_EQ(rig->tasks.size(), 1u);
  EXPECT_EQ(rig->tasks[0].name, "levels");
  EXPECT_EQ(rig->tasks[0].kind, TaskKind::emittance);
  EXPECT_FALSE(rig->scene.mesh);
}

TEST(RigFile, NamesAMissingFile) {
  for (const std::filesystem::path& path : {kRooms / "nowhere.toml", kRooms.parent_path(), std::filesystem::path()}) {
    const Checked<Rig> rig = load_rig(path);
    ASSERT_FALSE(rig);
    ASSERT_EQ(rig.error().size(), 1u);
    EXPECT_EQ(rig.error()[0].what, "no such file");
    EXPECT_FALSE(rig.error()[0].mend.empty());
  }
  const Checked<Rig> device = load_rig("/dev/zero");
  ASSERT_FALSE(device);
  EXPECT_EQ(device.error()[0].what, "not a file");
}

TEST(RigFile, RefusesAFileOver16MiBUnread) {
  const std::clock_t start = std::clock();  // processor time: a busy machine does not count
  std::string text = kSmall;
  text.resize((std::size_t{16} << 20) + 1, '\n');
  const Checked<Rig> rig = parse(text);
  ASSERT_FALSE(rig);
  EXPECT_NE(rig.error()[0].mend.find("16 MiB"), std::string::npos);
  EXPECT_LT(std::clock() - start, CLOCKS_PER_SEC);
}

TEST(RigFile, RefusesMoreEntriesThanARigCanHave) {
  std::string text = kSmall;
  for (int i = 0; i < 10001; ++i) text += "[[task]]\n";
  const Checked<Rig> rig = parse(text);
  ASSERT_FALSE(rig);
  ASSERT_EQ(rig.error().size(), 1u);
  EXPECT_EQ(rig.error()[0].what, "10001 entries of [[task]]");
}

TEST(RigFile, ShowsAThousandProblemsAndCountsTheRest) {
  std::string text = kSmall;
  for (int i = 0; i < 3000; ++i) text += "[[luminaire]]\nname = \"l" + std::to_string(i) + "\"\n";
  const Checked<Rig> rig = parse(text);
  ASSERT_FALSE(rig);
  ASSERT_EQ(rig.error().size(), 1001u);
  EXPECT_EQ(rig.error().back().what, "2000 more problems are not shown");
}

TEST(RigFile, ReportsProblemsInTheOrderOfTheFile) {
  const Checked<Rig> rig = parse(kSmall + fixture("a", "address = 0\nmax_level = 2") + "[limits]\nmax_level = -1\n");
  ASSERT_FALSE(rig);
  ASSERT_EQ(rig.error().size(), 3u) << listed(rig.error());
  EXPECT_LT(rig.error()[0].line, rig.error()[1].line);
  EXPECT_LT(rig.error()[1].line, rig.error()[2].line);
}

TEST(RigFile, NotesAGoalAboveItsLimitAndKeepsTheLimit) {
  const Checked<Rig> rig =
      parse(kSmall + "[[point]]\nname = \"p\"\nposition_m = [0, 0, 0]\ngoal_lx = 60\nmax_lx = 50\n");
  ASSERT_TRUE(rig) << listed(rig.error());
  ASSERT_EQ(rig->notes.size(), 1u);
  EXPECT_EQ(rig->notes[0].text(),
            "rig.toml:10:1: point \"p\" has a goal of 60 lx above its max_lx of 50 lx: the limit "
            "wins; lower the goal if that is not meant");
}

TEST(RigFile, SuggestsDifferentFreeAddressesForClashingFixtures) {
  const std::string two = "address = 1\nslots = [\"dimmer\", \"dimmer-fine\"]";
  const Checked<Rig> rig = parse(kSmall + fixture("a", two) + fixture("b", two) + fixture("c", two));
  ASSERT_FALSE(rig);
  ASSERT_EQ(rig.error().size(), 2u);
  EXPECT_EQ(rig.error()[0].mend, "address 3 is free for it");
  EXPECT_EQ(rig.error()[1].mend, "address 5 is free for it");
}

TEST(RigFile, NeedsNoAddressesOnANullBus) {
  const std::string null_bus = "[[bus]]\nname = \"paper\"\ndriver = \"null\"\n";
  const auto on_paper = [](const std::string& name, const std::string& patch) {
    std::string text = fixture(name, patch);
    const std::string bus = "bus = \"dmx\"";
    return text.replace(text.find(bus), bus.size(), "bus = \"paper\"");
  };
  const Checked<Rig> rig = parse(kSmall + null_bus + on_paper("a", "") + on_paper("b", "") +
                                 on_paper("c", "slots = [\"dimmer\", \"pan\", \"tilt\"]") +
                                 on_paper("d", "unit = 1\nregister = 0\nfull_scale = 1000") +
                                 on_paper("e", "unit = 1\nregister = 0\nfull_scale = 1000"));
  ASSERT_TRUE(rig) << listed(rig.error());
  ASSERT_EQ(rig->fixtures.size(), 5u);
  EXPECT_FALSE(rig->fixtures[1].moves);
  EXPECT_TRUE(rig->fixtures[2].moves);
  const auto problems = null_buses_in_use(*rig);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_NE(problems[0].what.find("\"paper\" is a null bus"), std::string::npos) << problems[0].text();
  EXPECT_TRUE(null_buses_in_use(*parse(kSmall + null_bus + fixture("a", "address = 1"))).empty())
      << "nobody hangs there";
  EXPECT_FALSE(parse(kSmall + null_bus + fixture("a", ""))) << "on a real bus one is needed";
}

TEST(RigFile, ReportsAFullUniverse) {
  std::string all = "address = 1\nslots = [\"dimmer\"";
  for (int i = 1; i < 512; ++i) all += ", \"unused\"";
  const Checked<Rig> rig = parse(kSmall + fixture("a", all + "]") + fixture("b", "address = 512"));
  ASSERT_FALSE(rig);
  ASSERT_EQ(rig.error().size(), 1u);
  EXPECT_EQ(rig.error()[0].mend, "universe 1 has no room for it: use another");
}

TEST(RigFile, LetsUniversesAndBusesShareNumbers) {
  const Checked<Rig> rig = parse(kSmall + "[[bus]]\nname = \"other\"\ndriver = \"sacn\"\n" +
                                 fixture("a", "address = 1") + fixture("b", "universe = 2\naddress = 1") +
                                 "[[fixture]]\nname = \"c\"\nluminaire = \"bulb\"\nposition_m = [0, 0, 3]\n"
                                 "bus = \"other\"\naddress = 1\n");
  EXPECT_TRUE(rig) << listed(rig.error());
}

TEST(RigFile, TurnsABaseAsTheReferenceStates) {
  // Yaw 90° turns the base's y (away) from the world's +y to -x; the beam at tilt 90° then follows it.
  const Checked<Rig> yawed = parse(kSmall + fixture("a", "address = 1\nmount_deg = [90, 0, 0]\ntilt_deg = 90"));
  ASSERT_TRUE(yawed) << listed(yawed.error());
  EXPECT_LT((yawed->fixtures[0].world_from_lamp().direction(-Vec3::UnitZ()) + Vec3::UnitX()).norm(), 1e-12);
  // Pitch 180° turns it upside down: the beam of the untilted head goes up.
  const Checked<Rig> standing = parse(kSmall + fixture("a", "address = 1\nmount_deg = [0, 180, 0]"));
  ASSERT_TRUE(standing) << listed(standing.error());
  EXPECT_LT((standing->fixtures[0].world_from_lamp().direction(-Vec3::UnitZ()) - Vec3::UnitZ()).norm(), 1e-12);
  // Roll 90° is about y alone: straight down becomes -x.
  const Checked<Rig> rolled = parse(kSmall + fixture("a", "address = 1\nmount_deg = [0, 0, 90]"));
  ASSERT_TRUE(rolled) << listed(rolled.error());
  EXPECT_LT((rolled->fixtures[0].world_from_lamp().direction(-Vec3::UnitZ()) + Vec3::UnitX()).norm(), 1e-12);
}

TEST(RigFile, AStandingHeadReachesAimsThatAHangingOneCannot) {
  const std::string mover = "address = 1\nslots = [\"pan\", \"tilt\", \"dimmer\"]\naim_m = [0.1, 0, 9]";
  EXPECT_FALSE(parse(kSmall + fixture("a", mover)));
  const Checked<Rig> rig = parse(kSmall + fixture("a", mover + "\nmount_deg = [0, 180, 0]"));
  EXPECT_TRUE(rig) << listed(rig.error());
}

TEST(RigFile, AppliesDefaultSpeedsOnlyToMovingFixtures) {
  const Checked<Rig> rig = parse(kSmall + fixture("a", "address = 1") +
                                 fixture("b", "address = 2\nslots = [\"pan\", \"tilt\", \"dimmer\"]"));
  ASSERT_TRUE(rig) << listed(rig.error());
  EXPECT_EQ(rig->fixtures[0].pan_speed_rad_s, 0);
  EXPECT_NEAR(rig->fixtures[1].pan_speed_rad_s, kPi, 1e-12);
}

/// A lamp on output `channel` of a product of rigs/register-maps.
std::string text_of_lamp_on(const std::string& map, int channel) {
  return "[rig]\nname = \"r\"\n[[luminaire]]\nname = \"bulb\"\nmodel = \"isotropic\"\nlumens = 900\n"
         "[[bus]]\nname = \"field\"\ndriver = \"modbus_tcp\"\nhost = \"192.0.2.7\"\n"
         "[[fixture]]\nname = \"lamp\"\nluminaire = \"bulb\"\nposition_m = [0, 0, 3]\nbus = \"field\"\n"
         "register_map = \"" +
         (test::source_folder() / "rigs/register-maps" / map).string() + "\"\nchannel = " + std::to_string(channel) +
         "\n";
}

TEST(RigFile, ALampOnARelayIsSwitched) {
  const Checked<Rig> relay = parse(text_of_lamp_on("waveshare-modbus-rtu-relay-d.toml", 3));
  ASSERT_TRUE(relay) << listed(relay.error());
  EXPECT_TRUE(relay->fixtures.at(0).switched);
  EXPECT_TRUE(relay->notes.empty());

  const Checked<Rig> denied = parse(text_of_lamp_on("waveshare-modbus-rtu-relay-d.toml", 3) + "switched = false\n");
  ASSERT_FALSE(denied);
  EXPECT_NE(listed(denied.error()).find("hangs on a coil"), std::string::npos) << listed(denied.error());

  const std::string dimmer_text = text_of_lamp_on("waveshare-analog-output-8ch-b.toml", 3);
  const Checked<Rig> dimmer = parse(dimmer_text);
  ASSERT_TRUE(dimmer) << listed(dimmer.error());
  EXPECT_FALSE(dimmer->fixtures.at(0).switched);
  const Checked<Rig> said = parse(dimmer_text + "switched = true\n");
  ASSERT_TRUE(said) << listed(said.error());
  EXPECT_TRUE(said->fixtures.at(0).switched);
}

TEST(RigFile, SurvivesTruncationsAndChangedBytes) {
  std::ifstream in(kRooms / "rig.toml", std::ios::binary);
  const std::string room((std::istreambuf_iterator<char>(in)), {});
  ASSERT_GT(room.size(), 1000u);
  int refused = 0;
  for (std::size_t size = 0; size < room.size(); size += 13) {
    const Checked<Rig> rig = parse_rig(room.substr(0, size), "rig.toml", kRooms);
    if (!rig) {
      ++refused;
      for (const Problem& problem : rig.error()) EXPECT_FALSE(problem.mend.empty());
    }
  }
  EXPECT_GT(refused, 100);
  std::mt19937 random(4);
  for (int i = 0; i < 300; ++i) {
    std::string changed = room;
    changed[random() % changed.size()] = static_cast<char>(random());
    (void)parse_rig(changed, "rig.toml", kRooms);
  }
}

TEST(RigFile, SurvivesDeepNestingOfEveryKind) {
  const auto repeated = [](const std::string& part, int times) {
    std::string out;
    for (int i = 0; i < times; ++i) out += part;
    return out;
  };
  constexpr int kDeep = 100000;
  for (const std::string& text :
       {"x = " + repeated("[", kDeep), "x = " + repeated("[", kDeep) + repeated("]", kDeep),
        "x = " + repeated("{a=", kDeep), "a" + repeated(".a", kDeep) + " = 1", "[a" + repeated(".a", kDeep) + "]",
        "[[a" + repeated(" . \"a\"", kDeep) + "]]", "x = " + repeated("{a.a.a.a.a.a.a.a.a.a.a.a.a.a.a.a=", kDeep),
        "s = \"\"\"\"\"\n" + ("a" + repeated(".'='", kDeep)) + "=1", repeated("[[a]]\n", kDeep)}) {
    const Checked<Rig> rig = parse(text);
    EXPECT_FALSE(rig);
  }
}

std::string text_of_large_rig(int fixtures, int points) {
  std::string text = kSmall;
  for (int i = 0; i < fixtures; ++i) {
    text += fixture("fixture-" + std::to_string(i),
                    "universe = " + std::to_string(1 + i / 64) + "\naddress = " + std::to_string(1 + i % 64 * 8) +
                        "\nslots = [\"pan\", \"pan-fine\", \"tilt\", \"tilt-fine\", \"dimmer\", \"dimmer-fine\", "
                        "\"constant:255\", \"unused\"]\naim = \"point-" +
                        std::to_string(i * (points / fixtures)) + "\"");
  }
  for (int i = 0; i < points; ++i) {
    text += "[[point]]\nname = \"point-" + std::to_string(i) + "\"\nposition_m = [" + std::to_string(i % 100 * 0.1) +
            ", " + std::to_string(i / 100 * 0.1) + ", 0.8]\nnormal = [0, 0, 1]\ngoal_lx = 300\nmax_lx = 500\n";
  }
  return text;
}

/// Processor time of the fastest of three runs, since the machine may be shared.
double seconds_to_load(const std::string& text) {
  double min_s = 1e9;
  for (int i = 0; i < 3; ++i) {
    const std::clock_t start = std::clock();
    EXPECT_TRUE(parse(text));
    min_s = std::min(min_s, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return min_s;
}

TEST(RigFile, LoadsLargeFilesInLessThanQuadraticTime) {
  const std::string large = text_of_large_rig(512, 20000);
  const Checked<Rig> rig = parse(large);
  ASSERT_TRUE(rig) << listed(rig.error());
  EXPECT_EQ(rig->points.size(), 20000u);
  EXPECT_NE(rig->fixtures[511].joints.tilt_rad, 0);
  // The file is four times as long: a factor of 16 would be quadratic.
  EXPECT_LT(seconds_to_load(large), 9 * seconds_to_load(text_of_large_rig(128, 5000)));
}

}  // namespace
}  // namespace luxrig
