/// Shows that the suite of all drivers can fail: the test for each fault catches the driver that is broken on purpose.

#include "tests/conformance/broken_driver.h"

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <string>

#include "tests/folders.h"

namespace luxrig {
namespace {

struct Ran {
  int exit_code = 0;
  std::string said;
};

/// Runs one test of EveryDriver in its own process, with every driver broken in this way. That process ignores the
/// shard of this one.
Ran run_suite(const Breakage& breakage) {
  const std::string program = (test::program_folder() / "conformance_tests").string();
  const std::string command = std::string("exec env -u GTEST_TOTAL_SHARDS -u GTEST_SHARD_INDEX ") + kBreakVariable +
                              "='" + breakage.name + "' '" + program + "' --gtest_filter='Registry/EveryDriver." +
                              breakage.failing_test + "/" + breakage.driver + "' 2>&1";
  Ran ran;
  std::FILE* const out = ::popen(command.c_str(), "r");
  if (out == nullptr) return ran;
  char buffer[4096];
  for (std::size_t got = 0; (got = std::fread(buffer, 1, sizeof(buffer), out)) > 0;) ran.said.append(buffer, got);
  const int status = ::pclose(out);
  ran.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return ran;
}

class ABrokenDriver : public ::testing::TestWithParam<std::size_t> {
 protected:
  const Breakage& breakage() const { return breakages()[GetParam()]; }
};

TEST_P(ABrokenDriver, FailsTheTestMeantForIt) {
  const Ran ran = run_suite(breakage());
  EXPECT_EQ(ran.exit_code, 1) << ran.said;
  EXPECT_NE(ran.said.find("1 FAILED TEST"), std::string::npos)
      << "a driver that " << breakage().name << " passed " << breakage().failing_test << "\n"
      << ran.said;
}

std::string name_of_breakage(const ::testing::TestParamInfo<std::size_t>& which) {
  std::string name = breakages()[which.param].name;
  for (char& c : name) c = c == ' ' ? '_' : c;
  return name + "_" + std::to_string(which.param);
}

INSTANTIATE_TEST_SUITE_P(That, ABrokenDriver, ::testing::Range(std::size_t{0}, breakages().size()), name_of_breakage);

}  // namespace
}  // namespace luxrig
