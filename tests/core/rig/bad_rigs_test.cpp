// Every file in tests/rigs/bad states its errors and their places in its first lines:
//   # expect: <line>:<column>: <part of the message>
//   # also:   <line>:<column>: <part of the message>     (any number)
// A place in another file has that file's name before it. Nothing else may be reported, or an error would hide among
// its consequences. Problems of a photometric file belong to its own parser and are not counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <fstream>

#include "core/rig/rig_file.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

const std::filesystem::path kFolder = test::source_folder() / "tests/rigs/bad";

std::vector<std::string> bad_rigs() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Expected form of a problem, "file:line:column: text", with file relative to the folder.
std::vector<std::string> expectations(const std::filesystem::path& path) {
  std::vector<std::string> out;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    for (const std::string mark : {"# expect: ", "# also: "}) {
      if (!line.starts_with(mark)) continue;
      const std::string rest = line.substr(mark.size());
      out.push_back(std::isdigit(static_cast<unsigned char>(rest[0])) ? path.filename().string() + ":" + rest : rest);
    }
    if (!line.starts_with('#')) break;
  }
  return out;
}

bool meets(const Problem& problem, const std::string& expected) {
  const std::string in_file = std::filesystem::path(problem.file).filename().string() + ":" +
                              std::to_string(problem.line) + ":" + std::to_string(problem.column) + ": ";
  return expected.starts_with(in_file) && problem.what.find(expected.substr(in_file.size())) != std::string::npos;
}

class BadRig : public testing::TestWithParam<std::string> {};

TEST_P(BadRig, IsRefusedOnlyWithItsPlacesAndRemedies) {
  const std::filesystem::path path = kFolder / (GetParam() + ".toml");
  const auto expected = expectations(path);
  ASSERT_FALSE(expected.empty()) << "its first line must be # expect: line:column: text";

  const std::clock_t start = std::clock();  // processor time: a busy machine does not count
  const Checked<Rig> rig = load_rig(path);
  EXPECT_LT(std::clock() - start, CLOCKS_PER_SEC);

  ASSERT_FALSE(rig.has_value()) << "accepted";
  for (const std::string& wanted : expected) {
    EXPECT_TRUE(std::any_of(rig.error().begin(), rig.error().end(), [&](const Problem& p) { return meets(p, wanted); }))
        << "not reported: " << wanted;
  }
  for (const Problem& problem : rig.error()) {
    EXPECT_FALSE(problem.mend.empty()) << problem.text();
    const bool of_ies = problem.file.ends_with(".ies") || problem.file.ends_with(".ldt");
    EXPECT_TRUE(of_ies || std::any_of(expected.begin(), expected.end(),
                                      [&](const std::string& wanted) { return meets(problem, wanted); }))
        << "not expected: " << problem.text();
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadRig, testing::ValuesIn(bad_rigs()), [](const auto& rig) { return rig.param; });

TEST(BadRigs, AreAtLeastThirty) { EXPECT_GE(bad_rigs().size(), 30u); }

TEST(BadRigs, WithABadPhotometricFileListThatFilesProblems) {
  const Checked<Rig> rig = load_rig(kFolder / "broken_ies.toml");
  ASSERT_FALSE(rig);
  EXPECT_TRUE(std::any_of(rig.error().begin(), rig.error().end(),
                          [](const Problem& p) { return p.file.ends_with("broken.ies") && p.line > 0; }));
}

}  // namespace
}  // namespace luxrig
