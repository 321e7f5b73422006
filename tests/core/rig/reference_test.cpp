// The examples of rigs/REFERENCE.md against the parser.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "core/rig/rig_file.h"
#include "core/rig/schema.h"
#include "tests/core/rig/listed_problems.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::filesystem::path kSource = test::source_folder();

/// Lines of the page up to the drivers' part, whose examples do not belong to that rig.
std::vector<std::string> lines_of_reference() {
  std::vector<std::string> lines;
  std::ifstream in(kSource / "rigs/REFERENCE.md");
  for (std::string line; std::getline(in, line) && line != "## Bus options";) lines.push_back(line);
  return lines;
}

/// Fenced blocks of one language, joined.
std::string blocks(const std::string& language) {
  std::string out;
  bool inside = false;
  for (const std::string& line : lines_of_reference()) {
    if (line.starts_with("```")) {
      inside = line == "```" + language;
    } else if (inside) {
      out += line + "\n";
    }
  }
  return out;
}

TEST(Reference, ExamplesTogetherMakeAValidRig) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "luxrig_reference_example";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "room.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(folder / "vase.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(folder / "points.csv") << blocks("csv");
  std::ofstream(folder / "track-spot.ies") << "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 10\n"
                                              "0 45 90\n0\n100 50 0\n";
  const Checked<Rig> rig = parse_rig(blocks("toml"), "REFERENCE.md", folder, PaintedPoints::left_out);
  ASSERT_TRUE(rig) << test::listed(rig.error()) << blocks("toml");
  EXPECT_EQ(rig->fixtures.size(), 8u) << "four, and one with four emitters";
  EXPECT_EQ(rig->points.size(), 4u);
  EXPECT_EQ(rig->surface_goals.size(), 1u);
  EXPECT_EQ(rig->points[3].name, "shelf 2, top");
  EXPECT_NEAR(rig->luminaires[0].intensity->flux_lm(), 1000, 1e-6);
  EXPECT_TRUE(rig->notes.empty()) << rig->notes[0].text();
  std::filesystem::remove_all(folder);
}

TEST(Schema, NamesEachKeyOnceAndKeepsSectionsTogether) {
  std::set<std::pair<std::string_view, std::string_view>> seen;
  std::size_t counted = 0;
  for (const KeySpec& key : keys()) EXPECT_TRUE(seen.emplace(key.section, key.key).second) << key.section << key.key;
  for (const SectionSpec& section : sections()) counted += keys_of(section.name).size();
  EXPECT_EQ(counted, keys().size());
}

}  // namespace
}  // namespace luxrig
