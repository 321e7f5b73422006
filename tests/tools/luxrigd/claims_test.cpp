#include "tools/luxrigd/claims.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "core/rig/rig_file.h"
#include "tests/folders.h"

namespace luxrig {
namespace {

using namespace std::chrono_literals;

std::string of_this_test(const std::string& what) { return what + " of test " + std::to_string(::getpid()); }

TEST(Claims, HaveASingleHolderAndNameIt) {
  const std::string what = of_this_test("folder");
  auto first = std::make_unique<Claims>();
  ASSERT_TRUE(first->take(what));
  Claims second;
  const auto refused = second.take(what);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().cause, Cause::refused);
  EXPECT_NE(refused.error().detail.find("process " + std::to_string(::getpid())), std::string::npos)
      << refused.error().detail;
  EXPECT_TRUE(second.take(of_this_test("other")));
  first.reset();
  EXPECT_TRUE(second.take(what));
}

TEST(Claims, OfOverlongNamesStayDistinct) {
  const std::string longest(300, 'x');
  Claims one, two;
  ASSERT_TRUE(one.take(of_this_test(longest)));
  EXPECT_FALSE(two.take(of_this_test(longest)));
  EXPECT_TRUE(two.take(of_this_test(longest + "y")));
}

TEST(Claims, EndWithTheirLastHoldingProcess) {
  const std::string what = of_this_test("lamp");
  int go[2];
  ASSERT_EQ(::pipe(go), 0);
  auto claims = std::make_unique<Claims>();
  ASSERT_TRUE(claims->take(what));
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {  // it has a copy of the descriptor
    char byte = 0;
    ::close(go[1]);
    (void)!::read(go[0], &byte, 1);
    ::_exit(0);
  }
  claims.reset();
  Claims next;
  EXPECT_FALSE(next.take(what, 50ms));
  ::close(go[1]);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_TRUE(next.take(what, 1s));
  ::close(go[0]);
}

TEST(Claims, OfARigAreItsOutputs) {
  const auto rig = load_rig(test::source_folder() / "tests/rigs/without-data");
  ASSERT_TRUE(rig);
  EXPECT_EQ(outputs_of(*rig, {}),
            (std::vector<std::string>{"artnet 127.0.0.1 universe 0", "modbus_tcp 127.0.0.1 unit 1",
                                      "modbus_tcp 127.0.0.1 unit 2", "modbus_tcp 127.0.0.1 unit 3",
                                      "sacn 127.0.0.1 universe 1"}));
  const auto moved = outputs_of(*rig, {{"stream", {"127.0.0.1", 4711, {}}}});
  EXPECT_EQ(moved.back(), "sacn 127.0.0.1:4711 universe 1");
}

}  // namespace
}  // namespace luxrig
